"""Two labels exchanged in a walk of known angles: named, their frames missing, all else as it was."""

import numpy as np
import pytest
from manufactured_body import (
    GAIT2354,
    HELEN_HAYES,
    MEASURES,
    OXFORD_FOOT,
    PLUG_IN_GAIT,
    RAJAGOPAL,
    known_angles,
    markers_of,
    static_of,
)
from texts import says

from gaitdisc.errors import ShapeError
from gaitdisc.kinematics.calibration import calibrate_body
from gaitdisc.kinematics.marker_set import marker_set
from gaitdisc.kinematics.motion import motion

KNOWN = known_angles(120)
SETS = {"plug_in_gait": PLUG_IN_GAIT, "oxford_foot": OXFORD_FOOT, "helen_hayes": HELEN_HAYES, "rajagopal": RAJAGOPAL,
        "gait2354": GAIT2354}  # fmt: skip


def exchanged(markers, pair, frames=slice(None)):
    values = np.array(markers.values)
    for axis in "xyz":
        first, second = (markers.index(f"{label}.{axis}") for label in pair)
        values[frames, first], values[frames, second] = markers.values[frames, second], markers.values[frames, first]
    return markers.with_values(values)


def said(found):
    return [one for one in found.findings if one.kind == "exchanged markers"]


@pytest.mark.parametrize(
    ("name", "pair", "lost"),
    [
        ("plug_in_gait", ("RHEE", "RTOE"), {"ankle_angle_r"}),
        ("plug_in_gait", ("RTHI", "RKNE"), {"hip_flexion_r", "knee_angle_r"}),
        ("plug_in_gait", ("LANK", "LHEE"), {"knee_angle_l", "ankle_angle_l"}),
        ("plug_in_gait", ("LHEE", "RHEE"), {"ankle_angle_l", "ankle_angle_r"}),
        ("plug_in_gait", ("LASI", "RASI"), {"pelvis_tilt", "hip_flexion_r", "hip_flexion_l"}),
        ("helen_hayes", ("R.Heel", "R.Toe"), {"ankle_angle_r"}),
        ("oxford_foot", ("RP5M", "RHEE"), {"ankle_angle_r"}),
        ("rajagopal", ("LTH1", "LTH3"), {"hip_flexion_l", "knee_angle_l"}),
        ("gait2354", ("R.Heel", "R.Toe.Tip"), {"ankle_angle_r"}),
    ],
)
def test_half_a_second_is_missing_and_said_and_all_else_is_exact(name, pair, lost):
    calibration = calibrate_body(static_of(SETS[name]), marker_set(name), MEASURES)
    span = slice(40, 90)
    found = motion(exchanged(markers_of(KNOWN, SETS[name]), pair, span), calibration, (1, 0, 0))
    (one,) = said(found)
    assert (one.severity, one.spans) == ("warning", ((0.4, 0.9),))
    assert all(label in one.channel for label in pair)
    for channel in lost:
        assert np.isnan(found.angles[channel][span]).all(), channel
    other = motion(markers_of(KNOWN, SETS[name]), calibration, (1, 0, 0))
    for channel in found.angles.names:
        known = np.isfinite(found.angles[channel])
        assert known[:40].all(), channel
        assert known[90:].all(), channel
        np.testing.assert_allclose(found.angles[channel][known], other.angles[channel][known], atol=1e-6)


def test_heel_and_toe_are_told_apart_on_a_foot_whose_ankle_lies_on_their_line():
    """Such a foot's turn about the line is not known, and its markers may lie at one distance from the ankle."""
    places = {segment: dict(own) for segment, own in PLUG_IN_GAIT.items()}
    for side in "LR":
        places[f"foot_{side.lower()}"] = {f"{side}HEE": np.array([-0.1, 0, 0]), f"{side}TOE": np.array([0.1, 0, 0])}
    calibration = calibrate_body(static_of(places), marker_set("plug_in_gait"), MEASURES)
    clean = motion(markers_of(KNOWN, places), calibration, (1, 0, 0))
    assert not said(clean) and np.isnan(clean.angles["ankle_angle_r"]).all()
    for pair in (("RHEE", "RTOE"), ("LHEE", "RHEE")):
        (one,) = said(motion(exchanged(markers_of(KNOWN, places), pair, slice(40, 90)), calibration, (1, 0, 0)))
        assert one.channel == f"{pair[0]}, {pair[1]}" and one.spans == ((0.4, 0.9),)


def test_a_whole_walk_with_heel_and_toe_exchanged_loses_that_ankle_alone():
    calibration = calibrate_body(static_of(PLUG_IN_GAIT), marker_set("plug_in_gait"), MEASURES)
    found = motion(exchanged(markers_of(KNOWN, PLUG_IN_GAIT), ("RHEE", "RTOE")), calibration, (1, 0, 0))
    assert says(said(found)[0].what, "RHEE", "RTOE", "120 of 120 frames", "0 mm, before a reversed axis")
    assert np.isnan(found.angles["ankle_angle_r"]).all()
    assert np.isnan(found.markers["RHEE.x"]).all()
    for name in ("knee_angle_r", "hip_flexion_r", "ankle_angle_l"):
        np.testing.assert_allclose(found.angles[name], KNOWN[name], atol=1e-6)


def test_the_same_labels_exchanged_in_both_trials_are_said_of_the_static_one():
    static = exchanged(static_of(PLUG_IN_GAIT), ("RHEE", "RTOE"))
    walk = exchanged(markers_of(KNOWN, PLUG_IN_GAIT), ("RHEE", "RTOE"))
    found = motion(walk, calibrate_body(static, marker_set("plug_in_gait"), MEASURES), (1, 0, 0))
    assert says(said(found)[0].what, "RHEE", "RTOE", "static trial corrects")
    assert np.isnan(found.angles["ankle_angle_r"]).all()
    np.testing.assert_allclose(found.angles["ankle_angle_l"], KNOWN["ankle_angle_l"], atol=1e-6)


def test_a_pelvis_that_never_fits_refuses_the_trial_and_names_the_labels():
    calibration = calibrate_body(static_of(PLUG_IN_GAIT), marker_set("plug_in_gait"), MEASURES)
    walk = exchanged(markers_of(KNOWN, PLUG_IN_GAIT), ("RASI", "LASI"))
    with pytest.raises(ShapeError, match=r"LASI.*RASI.*corrects"):
        motion(walk, calibration, (1, 0, 0))


def test_skin_that_slides_by_15_mm_is_no_exchange():
    """A soft-tissue artefact of the thigh's size (Leardini 2005), in step with the walk."""
    markers = markers_of(KNOWN, PLUG_IN_GAIT)
    slide = 0.015 * np.sin(2 * np.pi * markers.time)[:, None]
    thigh = np.array([name[1:4] in ("THI", "KNE") for name in markers.names])
    found = motion(markers.with_values(markers.values + slide * thigh), calibrate_body(
        static_of(PLUG_IN_GAIT), marker_set("plug_in_gait"), MEASURES), (1, 0, 0))  # fmt: skip
    assert not [one for one in found.findings if one.kind in ("exchanged markers", "broken segment")]
    assert np.isfinite(found.angles.values).all()
