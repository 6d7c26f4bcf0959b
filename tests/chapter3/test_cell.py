"""Cells of the tables: a method, an approach, a system, a noise and a seed."""

import numpy as np
import pytest
from chapter3.cell import (
    FORECAST,
    ORACLE,
    PARTS,
    RECONSTRUCTION,
    DiscrepancyCell,
    PartAccuracy,
    cell_of,
    cells_table,
    grid,
)
from chapter3.methods import MethodSettings
from chapter3.record import Conditions, recorded


def cell(system, method, approach, conditions, settings=None):
    return cell_of(recorded(system, conditions), method, approach, settings)


@pytest.mark.parametrize("method", ["sindy", "gp"])
def test_the_hidden_term_is_recovered_without_noise(quiet, method):
    forecast = cell_of(quiet, method, "dynamics").parts[FORECAST]
    assert forecast.accuracy().min() > 99
    assert forecast.diverged_s is None


def test_the_published_residual_of_sindy_changes_next_to_nothing_and_the_right_one_does(van_der_pol, quiet):
    published = cell(van_der_pol, "sindy", "state", Conditions(duration_s=20.0, published=True))
    assert published.variant == "as published"
    right = cell_of(quiet, "sindy", "state").parts[RECONSTRUCTION].accuracy().max()
    assert right > 20 + published.parts[RECONSTRUCTION].accuracy().max()


def test_what_cannot_be_fitted_is_said_and_has_no_number(quiet):
    found = cell_of(quiet, "dmd", "state", MethodSettings(delays=5000))
    assert not found.parts
    assert "3829 too few" in found.refused


def test_a_model_that_diverges_has_no_number(lorenz):
    found = cell(lorenz, "sindy", "dynamics", Conditions(noise=0.1, duration_s=4.0), MethodSettings(degree=5))
    for part in found.parts.values():
        assert (part.diverged_s is None) == bool((part.accuracy() == part.accuracy()).all())


def test_both_starts_stand_beside_each_other_and_only_the_oracle_begins_at_the_truth(van_der_pol):
    found = cell(van_der_pol, "sindy", "dynamics", Conditions(noise=0.1, duration_s=20.0))
    assert tuple(found.parts) == PARTS
    oracle, forecast = found.parts[ORACLE], found.parts[FORECAST]
    for model in ("known", "augmented"):
        assert (getattr(oracle, model)[0] == oracle.truth[0]).all()
        assert not (getattr(forecast, model)[0] == forecast.truth[0]).any()
    assert (oracle.truth == forecast.truth).all()


def test_parts_say_when_in_the_record_they_begin_and_channels_their_unit(van_der_pol):
    found = cell(van_der_pol, "sindy", "dynamics", Conditions(duration_s=10.0))
    assert [part.begins_s for part in found.parts.values()] == pytest.approx([0.0, 6.0, 6.0])
    assert found.units == ("1", "1/s")


def test_more_starts_make_a_residual_that_carries_over_to_a_new_one(van_der_pol):
    one, four = (
        cell(van_der_pol, "gp", "state", Conditions(duration_s=25.0, trajectories=count)).parts["oracle forecast"]
        for count in (1, 4)
    )
    assert np.median(four.accuracy()) > np.median(one.accuracy())


def test_methods_of_time_refuse_several_records(van_der_pol):
    found = cell(van_der_pol, "dmd", "dynamics", Conditions(duration_s=10.0, trajectories=2))
    assert "dmd was given 2" in found.refused
    assert "learns rates" in cell(van_der_pol, "wsindy", "state", Conditions(duration_s=10.0)).refused


TIME = np.arange(101) / 10
TRUTH = np.column_stack([np.sin(TIME), np.cos(TIME)])


def part(augmented, diverged=None):
    return PartAccuracy(TIME, TRUTH, TRUTH + 0.2, augmented, diverged)


def test_accuracy_is_the_share_of_the_error_that_went():
    assert part(TRUTH + 0.05).accuracy() == pytest.approx([75.0, 75.0])
    assert part(TRUTH - 0.8).accuracy() == pytest.approx([-300.0, -300.0])
    assert part(TRUTH - 0.8).accuracy(clipped=True) == pytest.approx([-100.0, -100.0])


def test_the_horizon_and_the_valid_time():
    late = TRUTH + np.where(TIME > 5, 1.0, 0.0)[:, None]
    found = part(late)
    assert found.change([4.0]) == pytest.approx([100.0])
    assert found.change([10.0])[0] < 0
    assert found.valid_s("augmented") == pytest.approx(5.1)
    assert found.first_jump_s(channel=1) == pytest.approx(1.6)


def test_what_diverged_has_no_number():
    values = np.where(TIME[:, None] > 3, np.nan, TRUTH)
    cell = DiscrepancyCell("s", "gp", "state", "right", 0.0, 0, ("x", "y"), {"forecast": part(values, 3.0)}, 1.0, 1.0)
    table = cells_table([cell])
    assert table["accuracy"].isna().all()
    assert table["diverged_s"].tolist() == [3.0, 3.0]


def test_what_was_refused_keeps_its_row():
    cell = DiscrepancyCell("s", "gp", "state", "right", 0.0, 0, ("x",), {}, 1.0, 0.0, refused="too short")
    assert cells_table([cell])["refused"].tolist() == ["too short"]


def test_the_step_between_samples_is_said():
    cell = DiscrepancyCell("s", "gp", "state", "right", 0.0, 0, ("x", "y"), {"reconstruction": part(TRUTH)}, 1.0, 1.0)
    assert cell.dt_s == pytest.approx(TIME[1])
    assert np.isnan(DiscrepancyCell("s", "gp", "state", "right", 0.0, 0, ("x",), {}, 1.0, 0.0).dt_s)


def test_cells_come_in_order_and_one_seed_is_enough_without_noise(van_der_pol):
    computed = []
    chosen = (("sindy",), ("dynamics", "state"))
    found = grid(van_der_pol, Conditions(duration_s=10.0), (0.0, 0.01), (0, 1), chosen, computed=computed.append)
    assert [(c.noise, c.seed, c.approach) for c in found] == [
        (0.0, 0, "dynamics"), (0.0, 0, "state"), (0.01, 0, "dynamics"), (0.01, 0, "state"), (0.01, 1, "dynamics"),
        (0.01, 1, "state"),
    ]  # fmt: skip
    assert computed == list(found)
