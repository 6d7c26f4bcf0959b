"""Degrees and radians: every planted mistake is found, no clean trial is accused."""

from __future__ import annotations

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from texts import says

from gaitdisc.errors import UnitError
from gaitdisc.ingest.stated_units import copied_coordinate_unit, plausible_unit

TIME = np.arange(200) / 100
NAMES = ["pelvis_rotation", "hip_flexion_r", "knee_angle_r", "ankle_angle_r"]


def _walk_deg(hip=22.0, knee=30.0):
    turn = 2 * np.pi * TIME
    return np.column_stack([400 * TIME, hip * np.cos(turn) + 5, knee * (1 - np.cos(2 * turn)), 12 * np.sin(turn)])


@given(st.floats(10, 30), st.floats(20, 40))
def test_walking_is_recognised_and_mistakes_are_refused(hip, knee):
    degrees = _walk_deg(hip, knee)
    radians = np.radians(degrees)
    assert plausible_unit(TIME, degrees, NAMES, "deg", "a.mot") == ("deg", None)
    assert plausible_unit(TIME, radians, NAMES, "rad", "a.mot") == ("rad", None)
    assert plausible_unit(TIME, degrees, NAMES, None, "a.mot")[0] == "deg"
    assert plausible_unit(TIME, radians, NAMES, None, "a.mot")[0] == "rad"
    with pytest.raises(UnitError):
        plausible_unit(TIME, degrees, NAMES, "rad", "a.mot")
    with pytest.raises(UnitError):
        plausible_unit(TIME, radians, NAMES, "deg", "a.mot")


def test_the_words_name_channel_and_number():
    with pytest.raises(UnitError, match=r"inDegrees=no\).*6\.28; knee_angle_r.*60"):
        plausible_unit(TIME, _walk_deg(), NAMES, "rad", "a.mot")
    with pytest.raises(UnitError, match=r"a\.mot.*2\.5.*1\.04"):
        plausible_unit(TIME, np.radians(_walk_deg()), NAMES, "deg", "a.mot")


def test_a_silent_header_is_reported_and_standing_still_is_refused():
    finding = plausible_unit(TIME, _walk_deg(), NAMES, None, "a.mot")[1]
    assert finding is not None and says(finding.what, "(largest joint angle 60)")
    with pytest.raises(UnitError, match=r"largest joint angle.*0"):
        plausible_unit(TIME, np.zeros((200, 4)), NAMES, None, "a.mot")
    with pytest.raises(UnitError, match="angle that would"):
        plausible_unit(TIME, _walk_deg()[:, :1], NAMES[:1], None, "a.mot")


def test_standing_in_degrees_and_a_turning_pelvis_are_not_accused():
    standing = np.tile([90.0, 3.0, 2.0, 1.0], (200, 1)) + 0.1 * np.sin(TIME)[:, None]
    assert plausible_unit(TIME, standing, NAMES, "deg", "a.mot") == ("deg", None)
    turning = np.radians(_walk_deg())
    assert turning[:, 0].max() > 7
    assert plausible_unit(TIME, turning, NAMES, "rad", "a.mot") == ("rad", None)


@pytest.mark.parametrize("unit", ["deg", "rad"])
def test_an_arm_that_winds_on_and_a_fit_that_lost_its_markers_hide_no_unit(unit):
    degrees = np.column_stack([_walk_deg(), 300 * TIME])
    degrees[-8:, 1] += 170  # the hip of the last frames, as a fit without markers has it
    names = [*NAMES, "arm_rot_r"]
    values = degrees if unit == "deg" else np.radians(degrees)
    assert np.abs(np.radians(degrees[:, -1])).max() > 2 * np.pi
    assert plausible_unit(TIME, values, names, unit, "a.mot") == (unit, None)
    with pytest.raises(UnitError):
        plausible_unit(TIME, values, names, "rad" if unit == "deg" else "deg", "a.mot")


def test_ankles_alone_leave_a_doubt_not_a_refusal():
    unit, finding = plausible_unit(TIME, 0.5 * np.sin(9 * TIME)[:, None], ["ankle_angle_r"], "deg", "a.mot")
    assert unit == "deg" and finding is not None and finding.kind == "unit in doubt"


def test_a_copied_coordinate_follows_its_knee_in_either_unit():
    knee = _walk_deg()[:, 2]
    angles = {"knee_angle_r": knee}
    assert copied_coordinate_unit("knee_angle_r_beta", np.radians(knee), angles) == "rad"
    assert copied_coordinate_unit("knee_angle_r_beta", knee, angles) == "deg"
    assert copied_coordinate_unit("knee_angle_r_beta", knee[::-1] ** 2, angles) is None
    assert copied_coordinate_unit("knee_angle_l_beta", knee, angles) is None
    assert copied_coordinate_unit("knee_angle_r_beta", np.full(200, np.nan), angles) is None
