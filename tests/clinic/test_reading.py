"""What is read of a person's cycles: values beside the reference, profile scores, an index, consistency, contrasts."""

from dataclasses import replace

import numpy as np
import pytest
from made_clinic import made_controls, made_person
from texts import says

from gaitdisc.clinic.clinical_reference import ReferenceLeg
from gaitdisc.clinic.reading import (
    contrast,
    deviation_index,
    find_profile,
    multiple_correlation,
    profile_score,
    read_beside,
    variable_score,
)
from gaitdisc.processing.leg_curves import PELVIS, PROFILE, LegCurves, make_legs
from gaitdisc.recording import PERCENT, Finding
from gaitdisc.saved.provenance import Refusal


def test_a_person_beside_a_reference_has_all_of_a_page():
    found = read_beside(made_person(), made_controls(6))
    assert found.light == "green" and found.reasons == ()
    assert found.profile is not None and set(found.legs) == {"l", "r"}
    assert found.consistency["knee_flexion", "l"] == pytest.approx(1.0, abs=0.01)
    assert "30 controls" in found.no_index
    assert set(found.bands) >= {"pelvis_tilt", "ankle_power"}


def test_without_a_reference_and_for_another_condition_the_reason_is_said():
    assert "there is no reference" in read_beside(made_person(), None).silent
    other = read_beside(made_person(condition="turn"), made_controls(6))
    assert other.silent == other.no_profile and says(other.silent, "'turn'", "'walk'")
    assert other.bands == {}


def test_the_light_says_why():
    dead = tuple(Finding("refused", "dead", file, "flat", "the channel", "emg_ta_l") for file in "ab")
    found = (
        dead[0],
        Finding("refused", "frozen", "a", "still", "the angle", "knee_angle_l"),
        Finding("warning", "gap", "a", "0.2 s", "angles"),
        Finding("warning", "body weight", "a", "12 %", "moments, by 12 %; weigh again"),
    )
    gone = (Refusal("P01", "walk 3", "unread"),)
    few = read_beside(made_person(each=2, findings=found, refusals=gone), None)
    assert few.light == "amber" and len(few.reasons) == 5
    assert says(few.reasons[0], "few cycles", "left leg 2, right leg 2", "1 trial is left out", "3")
    assert says(few.reasons[1], "EMG", "tibialis anterior, left", "electrodes")
    assert says(few.reasons[2], "knee angle, left", "left out")
    assert few.reasons[3:] == ("gap: look at the curves before you use angles", "body weight: weigh again")
    enough = read_beside(made_person(each=3, findings=dead, refusals=gone), None)  # never plugged in, one trial bad
    assert (enough.light, enough.reasons) == ("green", ())
    nothing = made_person(refusals=(Refusal("P01", "walk", "no cycle of P01"),))
    nothing = made_person(
        cycles=nothing.cycles.assign(kept=False), curves=np.zeros((0, *nothing.curves.shape[1:])),
        refusals=nothing.refusals,
    )  # fmt: skip
    assert (read_beside(nothing, made_controls(6)).light, read_beside(nothing, None).reasons) == (
        "red",
        ("no cycle of P01",),
    )


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
    profile, why = find_profile({"l": _leg("l", left), "r": _leg("r", right)}, _controls())
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
    profile, _ = find_profile({"l": _leg("l", dict.fromkeys(PROFILE, 1.0))}, legs)
    score = profile.legs["l"]
    assert score.reference_mean == pytest.approx(2.0)
    assert score.people == 3
    assert profile.both is None


def test_why_there_is_no_profile():
    controls = _controls()
    bare = {name: 1.0 for name in PROFILE if name != "foot_progression"}
    assert "the recording has no foot progression" in find_profile({"l": _leg("l", bare)}, controls)[1]
    assert says(find_profile({"l": _leg("l", bare, 43.0)}, controls)[1], "the pelvis turns", "43 deg")
    without = [replace(leg, curves={"knee_flexion": np.zeros(101)}) for leg in controls]
    assert (
        "fewer than two people of the reference have curves of pelvis tilt"
        in find_profile({"l": _leg("l", dict.fromkeys(PROFILE, 1.0))}, without)[1]
    )


def test_a_made_person_of_the_controls_lies_within_their_spread():
    profile, _ = find_profile(make_legs(made_person("P07", seed=5)), made_controls().of("walk"))
    assert abs(profile.both.value - profile.both.reference_mean) < 4 * profile.both.reference_sd
    stiff = make_legs(made_person("P07", seed=5, changed={"knee_angle_l": -30.0}))
    assert find_profile(stiff, made_controls().of("walk"))[0].variables["knee_flexion", "l"].value > 25


def test_controls_are_100_with_a_standard_deviation_of_10():
    reference = made_controls(32).of("walk")
    found = []
    for leg in reference:
        cycles = {name: curve[None] for name, curve in leg.curves.items()}
        found.append(deviation_index({leg.side: LegCurves(leg.side, 1, 60.0, cycles, {})}, reference)[0][leg.side])
    assert np.mean(found) == pytest.approx(100.0)
    assert np.std(found, ddof=1) == pytest.approx(10.0)


def test_whoever_walks_otherwise_is_far_below_and_few_controls_give_none():
    stiff = make_legs(made_person("P01", changed={"knee_angle_l": -30.0, "hip_flexion_l": 20.0}))
    assert deviation_index(stiff, made_controls(32).of("walk"))[0]["l"] < 80
    index, why = deviation_index(stiff, made_controls(6).of("walk"))
    assert index == {} and says(why, "30 controls", "6")


def test_equal_cycles_are_one_and_what_is_not_defined_is_not_a_number():
    curve = np.sin(np.linspace(0, 6, 101))
    assert multiple_correlation(np.tile(curve, (3, 1))) == pytest.approx(1.0)
    assert np.isnan(multiple_correlation(curve[None]))
    assert np.isnan(multiple_correlation(np.array([[0.0, 0.0, 0.1], [9.0, 9.0, 9.1]])))
    assert np.isnan(multiple_correlation(np.ones((3, 5))))


def _reading(session, each=8, **changed):
    return read_beside(made_person("P01", session=session, each=each, changed=changed), None)


def test_where_the_knee_bends_more_after_is_found_and_nothing_on_the_other_side():
    bump = 15.0 * ((PERCENT >= 65) & (PERCENT <= 80))
    before = made_person("P01", session="before", each=8, spread=0.0)
    after = made_person("P01", session="after", each=8, spread=0.0, seed=1, changed={"knee_angle_l": bump})
    found = contrast(read_beside(before, None), read_beside(after, None))
    large = [one for one in found.spans if one.matters]
    assert [(one.variable, one.side) for one in large] == [("knee_flexion", "l")]
    assert (large[0].first, large[0].last) == (65, 80)
    assert large[0].difference == pytest.approx(15.0, abs=1.0)
    assert large[0].p < 0.025
    assert found.untested == {} and found.tested == {"l": 9, "r": 9}


def test_few_cycles_are_not_tested_and_the_reason_is_said():
    found = contrast(_reading("before", each=2), _reading("after", each=2))
    assert found.spans == () and found.tested == {}
    assert says(found.untested["l"], "6 cycles", "2 and 2")
