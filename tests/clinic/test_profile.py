from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from made_clinic import made_controls, made_person
from texts import says

from gaitdisc.clinic.reading import profile_of, profile_score, variable_score
from gaitdisc.results.clinical_reference import ReferenceLeg
from gaitdisc.results.leg_curves import PELVIS, PROFILE, LegCurves, legs_of


def _leg(side, offsets, turned=0.0):
    cycles = {name: np.full((2, 101), offset) for name, offset in offsets.items()}
    return LegCurves(side, 2, 60.0, cycles, {}, turned)


def _controls(count=2):
    zero = {name: np.zeros(101) for name in PROFILE}
    return [ReferenceLeg(k, side, 1, 60.0, zero, {}) for k in range(count) for side in "lr"]


def test_a_profile_computed_by_hand():
    """Left: 3 deg in every curve. Right: 4 deg in six, and 99 in the pelvis', which counts once, on the left."""
    left = dict.fromkeys(PROFILE, 3.0)
    right = {name: 99.0 if name in PELVIS else -4.0 for name in PROFILE}
    profile, why = profile_of({"l": _leg("l", left), "r": _leg("r", right)}, _controls())
    assert why == ""
    assert profile.legs["l"].value == pytest.approx(3.0)
    assert profile.legs["r"].value == pytest.approx(np.sqrt((3 * 99**2 + 6 * 16) / 9))
    assert profile.both.value == pytest.approx(np.sqrt((9 * 9 + 6 * 16) / 15))
    assert profile.variables["knee_flexion", "r"].value == pytest.approx(4.0)
    assert (profile.legs["l"].low, profile.legs["l"].high, profile.legs["l"].cycles) == (3.0, 3.0, 2)


def test_a_curve_that_is_half_three_and_half_four_degrees_off():
    curve = np.concatenate([np.full(50, 3.0), np.full(50, -4.0)])
    assert variable_score(curve, np.zeros(100)) == pytest.approx(np.sqrt(12.5))
    assert profile_score([1.0, 7.0]) == pytest.approx(5.0)


def test_the_reference_has_a_spread_of_its_own_each_control_against_the_others():
    """Three controls at 0, 0 and 3 deg: their scores are 1.5, 1.5 and 3."""
    legs = [
        ReferenceLeg(k, side, 1, 60.0, {name: np.full(101, at) for name in PROFILE}, {})
        for k, at in enumerate((0.0, 0.0, 3.0))
        for side in "lr"
    ]
    profile, _ = profile_of({"l": _leg("l", dict.fromkeys(PROFILE, 1.0))}, legs)
    score = profile.legs["l"]
    assert score.reference_mean == pytest.approx(2.0)
    assert score.people == 3
    assert profile.both is None


def test_why_there_is_no_profile():
    controls = _controls()
    bare = {name: 1.0 for name in PROFILE if name != "foot_progression"}
    assert "the recording lacks foot progression" in profile_of({"l": _leg("l", bare)}, controls)[1]
    assert says(profile_of({"l": _leg("l", bare, 43.0)}, controls)[1], "the pelvis turns", "43 deg")
    without = [replace(leg, curves={"knee_flexion": np.zeros(101)}) for leg in controls]
    assert "the reference lacks pelvis tilt" in profile_of({"l": _leg("l", dict.fromkeys(PROFILE, 1.0))}, without)[1]


def test_a_made_person_of_the_controls_lies_within_their_spread():
    profile, _ = profile_of(legs_of(made_person("P07", seed=5)), made_controls().of("walk"))
    assert abs(profile.both.value - profile.both.reference_mean) < 4 * profile.both.reference_sd
    stiff = legs_of(made_person("P07", seed=5, changed={"knee_angle_l": -30.0}))
    assert profile_of(stiff, made_controls().of("walk"))[0].variables["knee_flexion", "l"].value > 25
