from __future__ import annotations

import numpy as np
import pytest
from texts import says

from gaitdisc.errors import UnitError
from gaitdisc.ingest.c3d_labels import LabelMap
from gaitdisc.ingest.c3d_parameters import C3DParameters
from gaitdisc.ingest.c3d_points import length_unit, point_streams


def _parameters(**point):
    return C3DParameters({("POINT", name): value for name, value in point.items()})


def _streams(rows, labels=(), channels=None, **point):
    parameters = _parameters(LABELS=tuple(labels), **point)
    return point_streams(np.array(rows, float), parameters, LabelMap(channels), "a.c3d")


WALK_MM = np.array([[100.0, 900, 1800, 300, 400, 500]])


@pytest.mark.parametrize(("unit", "factor"), [("mm", 1e-3), ("m", 1.0), ("cm", 1e-2)])
def test_markers_come_in_metres(unit, factor):
    rows = WALK_MM * 1e-3 / factor
    streams, found, _ = _streams(rows, ["LASI", "RASI"], UNITS=(unit,))
    values, channels = streams["markers"]
    np.testing.assert_allclose(values, WALK_MM * 1e-3)
    assert [channel.name for channel in channels][:3] == ["LASI.x", "LASI.y", "LASI.z"]
    assert {channel.unit for channel in channels} == {"m"}
    assert found == unit


@pytest.mark.parametrize(("scale", "unit"), [(1.0, "mm"), (1e-3, "m")])
def test_an_absent_unit_is_inferred_and_reported(scale, unit):
    found, findings = length_unit(_parameters(), WALK_MM * scale, "a.c3d")
    assert found == unit
    assert f"so they are read as {unit}" in findings[0].what


def test_an_absent_unit_that_the_numbers_do_not_tell_is_refused():
    with pytest.raises(UnitError, match=r"a\.c3d.*50"):
        length_unit(_parameters(), np.full((5, 3), 50.0), "a.c3d")


@pytest.mark.parametrize(("unit", "scale", "looks"), [("m", 1.0, "mm"), ("mm", 1e-3, "m")])
def test_a_unit_that_the_numbers_contradict_is_refused(unit, scale, looks):
    with pytest.raises(UnitError, match=rf"markers in {unit} are .* looks like {looks}"):
        length_unit(_parameters(UNITS=(unit,)), WALK_MM * scale, "a.c3d")


def test_a_unit_that_is_no_length_is_refused():
    with pytest.raises(UnitError, match=r"a\.c3d says 'deg'"):
        length_unit(_parameters(UNITS=("deg",)), WALK_MM, "a.c3d")


def test_angles_moments_and_powers_are_not_scaled_as_lengths():
    rows = [[1000.0, 1000, 1000, 60, 5, -3, 80000, 90000, 0, 0, 0, 350]]
    streams, _, _ = _streams(
        rows,
        ["Ann:LASI", "Ann:RKneeAngles", "Ann:LHipMoment", "Ann:RAnklePower"],
        UNITS=("mm",),
        ANGLES=("Ann:RKneeAngles",),
        MOMENTS=("Ann:LHipMoment",),
        POWERS=("Ann:RAnklePower",),
        MOMENT_UNITS=("Nmm",),
    )
    values, channels = streams["kinematics"]
    assert [(c.name, c.unit, c.side) for c in channels] == [
        ("knee_angle_r", "deg", "r"),
        ("knee_adduction_r", "deg", "r"),
        ("knee_rotation_r", "deg", "r"),
    ]
    np.testing.assert_array_equal(values, [[60, 5, -3]])
    values, channels = streams["moments"]
    np.testing.assert_allclose(values, [[80, 90, 0, 0, 0, 350]])
    assert [c.name for c in channels][::3] == ["hip_flexion_l_moment", "RAnklePower.x"]
    assert [c.unit for c in channels][::3] == ["N m", "W"]
    np.testing.assert_array_equal(streams["markers"][0], [[1, 1, 1]])


def test_a_known_angle_stays_one_where_the_file_lost_its_lists():
    streams, _, _ = _streams([[1000.0, 1000, 1000, 60, 5, 3]], ["LASI", "LKneeAngles"], UNITS=("mm",))
    assert streams["kinematics"][0][0, 0] == 60


def test_radians_are_converted_and_unknown_angles_keep_their_label():
    streams, _, _ = _streams([[np.pi, 0, 0]], ["LTorsion"], ANGLES=("LTorsion",), ANGLE_UNITS=("rad",))
    values, channels = streams["kinematics"]
    assert values[0, 0] == pytest.approx(180)
    assert (channels[0].name, channels[0].side) == ("LTorsion.x", "l")


def test_angles_that_look_like_radians_are_reported():
    _, _, findings = _streams([[1.0, 0, 0]], ["RKneeAngles"], ANGLES=("RKneeAngles",))
    assert says(findings[0].what, "angle is beyond 1 deg")


def test_a_place_at_exactly_the_origin_was_not_seen():
    streams, _, findings = _streams([[0.0, 0, 0, 300, 400, 0]], ["A", "B"], UNITS=("mm",))
    assert np.isnan(streams["markers"][0][0, :3]).all()
    assert streams["markers"][0][0, 5] == 0
    assert "1 places of markers" in findings[0].what


def test_equal_and_missing_labels_are_made_unique():
    streams, _, findings = _streams([[300.0] * 12], ["A", "A", "B"], UNITS=("mm",))
    names = [channel.name for channel in streams["markers"][1]][::3]
    assert names == ["A_1.x", "A_2.x", "B.x", "point_4.x"]
    assert says(findings[0].what, "1 point labels")


def test_the_study_names_markers_and_components():
    channels = {"LCAL": "LHEE", "KneeR.x": "knee_angle_r"}
    streams, _, _ = _streams([[300.0, 0, 1, 45, 2, 3]], ["LCAL", "KneeR"], channels, UNITS=("mm",), ANGLES=("KneeR",))
    assert streams["markers"][1][0].name == "LHEE.x"
    assert [c.name for c in streams["kinematics"][1]] == ["knee_angle_r", "KneeR.y", "KneeR.z"]


SUFFIXED = ("LASI", "LKneeAngles_M", "LAbsAnkleAngle_M", "LPelvisAngles_M", "LPelvisAngles_TOR", "LKneeMoment_M")


def test_outputs_to_which_one_model_adds_a_word_are_known_by_their_own_labels():
    rows = 1e3 + np.arange(3.0 * len(SUFFIXED))[None] + np.zeros((4, 1))
    listed = {"ANGLES": SUFFIXED[1:5], "MOMENTS": SUFFIXED[5:], "MOMENT_UNITS": ("Nmm",), "UNITS": ("mm",)}
    streams, _, findings = _streams(rows, SUFFIXED, **listed)
    values, channels = streams["kinematics"]
    names = [channel.name for channel in channels]
    assert names[:3] == ["knee_angle_l", "knee_adduction_l", "knee_rotation_l"] and values[0, 0] == 1003.0
    assert [names[3], names[6], names[9]] == ["LAbsAnkleAngle.x", "LPelvisAngles.x", "LPelvisAngles_TOR.x"]
    assert streams["moments"][1][0].name == "knee_angle_l_moment"
    (said,) = [finding for finding in findings if finding.kind == "model suffix"]
    assert said.severity == "note" and "LKneeAngles_M" in said.what and "_M; taken as LKneeAngles" in said.what


@pytest.mark.parametrize("labels", [("LKneeAngles", "LKneeAngles_M"), ("LKneeAngles_M", "LHipAngles_F")])
def test_a_word_that_tells_two_models_apart_stays(labels):
    streams, _, findings = _streams(np.ones((4, 6)), labels, ANGLES=labels)
    named = [channel.name for channel in streams["kinematics"][1]]
    assert f"{labels[1]}.x" in named and "model suffix" not in {finding.kind for finding in findings}


def test_the_study_names_an_output_by_the_label_of_its_file():
    map_ = {"LKneeAngles_M.x": "knee_angle_r"}
    streams, *_ = _streams(np.full((4, 3), 9.0), ["LKneeAngles_M"], map_, ANGLES=("LKneeAngles_M",))
    assert streams["kinematics"][1][0].name == "knee_angle_r"
