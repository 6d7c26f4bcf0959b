"""Belts that stand still: feet rest on the floor, two plates see one step each, and moments are those of the belts."""

from __future__ import annotations

import numpy as np
import pytest

from gaitdisc.cohort.marker_trial import STANDS_N, marker_trial, overground, standing
from gaitdisc.cohort.walk import walked
from gaitdisc.kinematics.motion import moved_body
from gaitdisc.kinetics.body_inertia import Person
from gaitdisc.kinetics.joint_moments import KineticsSettings
from gaitdisc.kinetics.trial_kinetics import trial_kinetics
from gaitdisc.processing.markers_to_moments import foot_paths_of
from gaitdisc.recording.arrays import runs

START_S = 2.0


@pytest.fixture(scope="module")
def belts(person):
    return marker_trial(walked(person, None, 8.0, seed=5), "walk", "nominal")


@pytest.fixture(scope="module")
def floor(belts, person):
    return overground(belts, START_S, person.stride_s, person.speed_m_per_s, "walk_1")


def test_a_foot_that_stands_rests_on_the_floor(floor, belts, person):
    heel = floor.stream("markers")["RMT5.x"]
    speed = np.gradient(heel, 0.01)
    a, b = max(runs(floor.stream("forces")["plate_1_fz"] > STANDS_N), key=lambda run: run[1] - run[0])
    middle = speed[int(0.1 * a + 0.04 * (b - a)) : int(0.1 * a + 0.05 * (b - a))]  # 40 to 50 % of stance, at 100 Hz
    assert np.abs(middle).max() < 0.25 * person.speed_m_per_s
    came = floor.stream("markers")["RASI.x"][-1] - floor.stream("markers")["RASI.x"][0]
    assert came == pytest.approx(person.speed_m_per_s * (floor.stream("markers").time[-1]), abs=0.1)


def test_each_plate_sees_one_step_inside_its_corners(floor):
    forces = floor.stream("forces")
    begun = []
    for plate in floor.surfaces:
        force = forces[f"{plate.name}_fz"]
        steps = [(a, b) for a, b in runs(force > STANDS_N) if b - a > 100]
        assert len(steps) == 1
        a, b = steps[0]
        begun.append(a)
        loaded = slice(a + (b - a) // 10, b - (b - a) // 10)
        point = -forces[f"{plate.name}_my"][loaded] / force[loaded] + plate.corners.mean(axis=0)[0]
        assert plate.corners[:, 0].min() < point.min() and point.max() < plate.corners[:, 0].max()
        foot = floor.stream("markers")["RMT5.x" if plate.name == "plate_1" else "LMT5.x"]
        assert np.abs(point - np.interp(forces.time[loaded], floor.stream("markers").time, foot)).max() < 0.25
    first, second = floor.surfaces
    assert begun[0] < begun[1] and first.corners[:, 0].max() <= second.corners[:, 0].min() + 1e-9


def test_moments_of_the_step_are_those_of_the_belts(floor, belts, person):
    static = standing(person).stream("markers")

    def ankle(trial):
        body, moved = moved_body(trial.stream("markers"), static)
        who = Person(person.mass_kg, person.sex, person.height_m)
        found = trial_kinetics(trial, moved.poses, foot_paths_of(moved, body), who, KineticsSettings()).moments
        return found.time, found["ankle_angle_r_moment"]

    (time, own), (belt_time, belt) = ankle(floor), ankle(belts)
    there = np.isfinite(own)
    other = np.interp(time[there] + START_S, belt_time, belt)
    assert there.sum() > 30
    assert np.nanmin(own) == pytest.approx(np.nanmin(other), rel=0.05)
    assert np.nanmedian(np.abs(own[there] - other)) < 0.05
