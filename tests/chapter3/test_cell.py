import numpy as np
import pytest
from chapter3.cell import FORECAST, ORACLE, PARTS, RECONSTRUCTION, cell_of
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
