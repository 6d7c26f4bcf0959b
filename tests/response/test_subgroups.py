from types import SimpleNamespace

import numpy as np
import pytest
from texts import says

from gaitdisc.errors import ComparisonError
from gaitdisc.response.over_participants import discrepancy_curves, responder_table
from gaitdisc.statistics.groups import find_groups

PHASE = np.linspace(0, 2 * np.pi, 101)


def response(i, kind, outputs=("ankle_angle_r", "emg_sol_r")):
    """Discrepancy of a sine or a cosine, in deg/s2 and in V/s2, with a size of its own."""
    rng = np.random.default_rng(i)
    shape = np.sin(PHASE) if kind else np.cos(PHASE)
    curve = (1 + 0.1 * rng.standard_normal()) * shape[None, :, None] * np.array([1000.0, 0.1])[: len(outputs)]
    noise = 0.5 * rng.standard_normal((20, 101, len(outputs))) * np.array([1000.0, 0.1])[: len(outputs)]
    return SimpleNamespace(participant=f"P{i + 1:02d}", outputs=outputs, residuals={"nominal": curve + noise})


def test_two_kinds_of_responders_are_told_apart():
    found = find_groups(discrepancy_curves([response(i, i % 2) for i in range(12)]))
    assert found.count == 2
    assert len(set(found.labels[::2])) == len(set(found.labels[1::2])) == 1


def test_one_kind_has_no_sub_groups():
    assert find_groups(discrepancy_curves([response(i, 0) for i in range(12)])).count == 0


def test_all_outputs_weigh_alike():
    curves = discrepancy_curves([response(i, i % 2) for i in range(6)])
    assert curves.shape == (6, 202)
    angle, emg = (np.mean(curves[:, part] ** 2) for part in (slice(101), slice(101, None)))
    assert angle == pytest.approx(1.0) == emg


def test_missing_samples_are_left_out_of_the_mean():
    holed = [response(i, 0) for i in range(6)]
    holed[0].residuals["nominal"][3, 50, 0] = np.nan
    assert np.isfinite(discrepancy_curves(holed)).all()


def test_participants_of_different_outputs_are_refused():
    with pytest.raises(ComparisonError, match=r"2 sets.*6 participants"):
        discrepancy_curves([*(response(i, 0) for i in range(5)), response(5, 0, ("ankle_angle_r",))])


def test_each_responder_has_a_group_and_the_sentence_its_n():
    table, said = responder_table([response(i, i % 2) for i in range(12)])
    assert table["group"].nunique() == 2
    assert says(said, "2 groups")
    assert said.endswith("(n = 12 participants)")


def test_who_lacks_points_of_the_stride_is_left_out_by_name():
    people = [response(i, 0) for i in range(7)]
    people[2].residuals["nominal"][:, 50, 0] = np.nan
    table, said = responder_table(people)
    assert "P03" not in set(table["participant"])
    assert says(said, "n = 6 participants;", "missing points: P03")


def test_five_are_too_few_and_it_is_said():
    table, said = responder_table([response(i, 0) for i in range(5)])
    assert not len(table)
    assert says(said, "not", "6 participants (n = 5", "participants)")
