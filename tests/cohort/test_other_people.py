"""Each kind of person has the hallmark that the clinic knows it by."""

from __future__ import annotations

import numpy as np
import pytest

from gaitdisc.cohort.cohort import the_twelve
from gaitdisc.cohort.leg_path import habit_angles
from gaitdisc.cohort.other_people import PEOPLE, somebody, walking_with
from gaitdisc.cohort.person import drawn
from gaitdisc.cohort.walk import walked
from gaitdisc.errors import SchemaError

HIP, KNEE, ANKLE = 0, 3, 4
WALK_S = 12.0


@pytest.fixture(scope="module")
def walks():
    """A usual person and each of the others, of one seed."""
    people = {"usual": drawn("usual", 1, "f")} | {kind: somebody(kind) for kind in PEOPLE}
    return {kind: walked(person, None, WALK_S, 3) for kind, person in people.items()}


def angles(walk, side=0):
    return walk.mean_stride(walk.angles, side)[:, side]


def test_a_stiff_knee_swings_with_less_than_45_degrees(walks):
    """Stiff-knee gait is a low peak of knee flexion in swing, below 45 deg (Goldberg et al. 2003)."""
    assert angles(walks["usual"])[60:90, KNEE].max() > 53.0
    assert angles(walks["stiff knee"])[60:90, KNEE].max() < 45.0


def test_a_drop_foot_hangs_in_swing_and_the_hip_lifts_it(walks):
    usual, drop = angles(walks["usual"]), angles(walks["drop foot"])
    assert drop[75:95, ANKLE].mean() < -8.0 < usual[75:95, ANKLE].mean()
    assert drop[75:95, HIP].max() > usual[75:95, HIP].max() + 3.0


def test_crouch_keeps_the_knee_bent_by_more_than_20_degrees(walks):
    assert angles(walks["crouch"])[5:50, KNEE].min() > 20.0
    peaks = [-w.mean_stride(w.moments)[:50, 0, 1].min() / w.person.mass_kg for w in (walks["usual"], walks["crouch"])]
    assert peaks[1] > peaks[0] + 0.2  # quadriceps have to hold it


def test_weak_plantarflexors_give_less_moment_and_let_the_shank_fall_forward(walks):
    peaks = {kind: -walks[kind].mean_stride(walks[kind].moments)[:, 0, 2].min() for kind in walks}
    assert peaks["weak plantarflexor"] < 0.95 * peaks["usual"]
    assert angles(walks["weak plantarflexor"])[:60, ANKLE].max() > angles(walks["usual"])[:60, ANKLE].max() + 1.0


def test_a_child_steps_faster_and_shorter(walks):
    child, usual = walks["child"].person, walks["usual"].person
    assert child.mass_kg < 0.6 * usual.mass_kg
    assert 120 / child.stride_s > 1.1 * 120 / usual.stride_s
    assert child.speed_m_per_s * child.stride_s < 0.85 * usual.speed_m_per_s * usual.stride_s
    assert child.dimensionless_speed == pytest.approx(usual.dimensionless_speed)


def test_cadence_follows_the_root_of_speed(walks):
    """Dimensionless cadence grows with the root of speed (Schwartz et al. 2008)."""
    rates = [2 / w.person.stride_s / np.sqrt(w.person.speed_m_per_s) for w in (walks["slow"], walks["fast"])]
    assert rates[0] == pytest.approx(rates[1], rel=1e-6)
    ground = [w.mean_stride(w.force)[:, 0, 1] / w.person.mass_kg / 9.81 for w in (walks["slow"], walks["fast"])]
    assert ground[0][20:40].min() > ground[1][20:40].min() + 0.05  # a slow walker's force has the shallower valley


def test_asymmetric_legs_differ_where_usual_ones_do_not(walks):
    def ratio(walk):
        ranges = [np.ptp(angles(walk, side)[:, KNEE]) for side in (0, 1)]
        return max(ranges) / min(ranges)

    assert ratio(walks["usual"]) < 1.10
    assert ratio(walks["asymmetric"]) > 1.15


def test_nobody_of_them_falls(walks):
    for kind, walk in walks.items():
        assert np.abs(walk.angles).max() < 100.0, kind
        assert walk.strides(walk.angles).std(axis=0).mean(axis=0)[0, KNEE] < 5.0, kind


def test_a_pattern_changes_the_legs_that_it_names():
    person = the_twelve(calibration=True)[0]
    phase = np.linspace(0, 1, 50, endpoint=False)
    other = walking_with(person, "asymmetric")
    assert np.array_equal(habit_angles(person, 0, phase), habit_angles(other, 0, phase))
    assert np.abs(habit_angles(person, 1, phase) - habit_angles(other, 1, phase)).max() > 10.0


def test_an_unknown_kind_is_refused():
    with pytest.raises(SchemaError, match="child, slow, fast"):
        somebody("gremlin")
