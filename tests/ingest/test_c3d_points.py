"""Points and segments of a C3D file in metres; a scale that is 0, infinite or no number never gives other numbers."""

import struct

import ezc3d
import numpy as np
import pytest
from scipy.spatial.transform import Rotation
from texts import says

from gaitdisc.errors import ReadError, UnitError
from gaitdisc.ingest.c3d import list_unscaled, read_c3d
from gaitdisc.ingest.c3d_labels import LabelMap
from gaitdisc.ingest.c3d_parameters import C3DParameters
from gaitdisc.ingest.c3d_points import length_unit, point_streams
from gaitdisc.ingest.reading import read_trial


def _parameters(**point):
    return C3DParameters({("POINT", name): value for name, value in point.items()}, "a.c3d")


def _streams(rows, labels=(), channels=None, **point):
    parameters = _parameters(LABELS=tuple(labels), **point)
    return point_streams(np.array(rows, float), parameters, LabelMap(channels))


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
    found, findings = length_unit(_parameters(), WALK_MM * scale)
    assert found == unit
    assert f"and are read as {unit}" in findings[0].what


def test_an_absent_unit_that_the_numbers_do_not_tell_and_one_that_is_no_length_are_refused():
    with pytest.raises(UnitError, match=r"a\.c3d.*50"):
        length_unit(_parameters(), np.full((5, 3), 50.0))
    with pytest.raises(UnitError, match=r"a\.c3d says 'deg'"):
        length_unit(_parameters(UNITS=("deg",)), WALK_MM)


@pytest.mark.parametrize(("unit", "scale", "looks"), [("m", 1.0, "mm"), ("mm", 1e-3, "m")])
def test_a_unit_that_the_numbers_contradict_is_refused(unit, scale, looks):
    with pytest.raises(UnitError, match=rf"markers in {unit} must be .* looks like {looks}"):
        length_unit(_parameters(UNITS=(unit,)), WALK_MM * scale)


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
    assert says(findings[0].what, "angle exceeds 1 deg")


def test_a_place_at_exactly_the_origin_was_not_seen():
    streams, _, findings = _streams([[0.0, 0, 0, 300, 400, 0]], ["A", "B"], UNITS=("mm",))
    assert np.isnan(streams["markers"][0][0, :3]).all()
    assert streams["markers"][0][0, 5] == 0
    assert findings[0].what.startswith("marker positions at") and findings[0].what.endswith(": 1")


def test_equal_and_missing_labels_are_made_unique():
    streams, _, findings = _streams([[300.0] * 12], ["A", "A", "B"], UNITS=("mm",))
    names = [channel.name for channel in streams["markers"][1]][::3]
    assert names == ["A_1.x", "A_2.x", "B.x", "point_4.x"]
    assert says(findings[0].what, "labels", "1 in all")


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
    assert said.severity == "note" and "LKneeAngles_M is read as LKneeAngles" in said.what


@pytest.mark.parametrize("labels", [("LKneeAngles", "LKneeAngles_M"), ("LKneeAngles_M", "LHipAngles_F")])
def test_a_word_that_tells_two_models_apart_stays(labels):
    streams, _, findings = _streams(np.ones((4, 6)), labels, ANGLES=labels)
    named = [channel.name for channel in streams["kinematics"][1]]
    assert f"{labels[1]}.x" in named and "model suffix" not in {finding.kind for finding in findings}


def test_the_study_names_an_output_by_the_label_of_its_file():
    map_ = {"LKneeAngles_M.x": "knee_angle_r"}
    streams, *_ = _streams(np.full((4, 3), 9.0), ["LKneeAngles_M"], map_, ANGLES=("LKneeAngles_M",))
    assert streams["kinematics"][1][0].name == "knee_angle_r"


FRAMES = 60
TURNS = Rotation.from_quat(np.random.default_rng(0).normal(size=(2 * FRAMES, 4))).as_matrix().reshape(FRAMES, 2, 3, 3)
PLACES = np.random.default_rng(1).normal(size=(FRAMES, 2, 3)) + 0.5  # [m]


def written(path, points=0, ratio=1, unit="mm"):
    """A file of two segments, with markers beside them where wanted."""
    file = ezc3d.c3d()
    rotations = np.zeros((4, 4, 2, FRAMES))
    rotations[:3, :3] = TURNS.transpose(2, 3, 1, 0)
    rotations[:3, 3] = PLACES.transpose(2, 1, 0) * (1000 if unit == "mm" else 1)
    rotations[3, 3] = 1
    rotations[:, :, 1, 7] = np.nan
    file["parameters"]["POINT"]["RATE"]["value"] = [100.0 / ratio]
    file["parameters"]["POINT"]["UNITS"]["value"] = [unit]
    file["parameters"]["POINT"]["LABELS"]["value"] = [f"M{number}" for number in range(points)]
    file["data"]["points"] = np.full((4, points, FRAMES // ratio), 700.0)
    file.add_parameter("ROTATION", "RATE", [100.0])
    file.add_parameter("ROTATION", "LABELS", ["pelvis_4X4", "Erika:l_thigh_4X4"])
    file["data"]["rotations"] = rotations
    file.write(str(path))
    return path


@pytest.mark.parametrize(("points", "unit"), [(0, "mm"), (3, "mm"), (0, "m")])
def test_poses_are_read_back_with_their_names_and_in_metres(tmp_path, points, unit):
    trial = read_c3d(written(tmp_path / "a.c3d", points, unit=unit))
    segments = trial.stream("segments")
    assert ("markers" in trial.streams) == bool(points)
    assert not [finding for finding in trial.findings if finding.severity == "warning"]
    assert (segments.rate_hz, len(segments.time), segments.source.file) == (pytest.approx(100.0), FRAMES, "a.c3d")
    assert list(dict.fromkeys(name.rpartition(".")[0] for name in segments.names)) == ["pelvis", "l_thigh"]
    for place, name in enumerate(("pelvis", "l_thigh")):
        known = np.ones(FRAMES, bool)
        known[7] = place == 0
        origin = np.stack([segments[f"{name}.{axis}"] for axis in "xyz"], axis=1)
        cells = np.stack([segments[f"{name}.r{row}{column}"] for row in "123" for column in "123"], axis=1)
        assert np.isfinite(cells).all(axis=1).tolist() == known.tolist()
        np.testing.assert_allclose(origin[known], PLACES[known, place], atol=1e-6)
        np.testing.assert_allclose(cells[known].reshape(-1, 3, 3), TURNS[known, place], atol=1e-6)


def test_more_than_one_pose_a_frame(tmp_path):
    segments = read_c3d(written(tmp_path / "a.c3d", 3, ratio=2)).stream("segments")
    assert (segments.rate_hz, len(segments.time)) == (pytest.approx(100.0), FRAMES)


def test_a_file_that_is_cut_off_is_refused_with_its_numbers(tmp_path):
    path = written(tmp_path / "a.c3d")
    path.write_bytes(path.read_bytes()[:-4000])
    with pytest.raises(ReadError, match=r"60 frames.*2 segments.*ROTATION.*8160 bytes"):
        read_c3d(path)


def test_files_of_markers_have_no_segments(tmp_path, gait_data):
    assert "segments" not in read_c3d(gait_data / "treadmill_c3d_emg" / "walking_1.c3d").streams


UNUSABLE = (float("nan"), float("inf"), float("-inf"), 0.0)


def _with_float(path, group, name, number, place=0):
    """Write a number over one of a parameter of floats, found by the number of its group."""
    content = bytearray(path.read_bytes())
    of_group = 256 - content[content.index(group.encode(), 512) - 1]
    after = content.index(bytes([len(name), of_group]) + name.encode(), 512) + 2 + len(name) + 2
    assert content[after] == 4, "a float has four bytes"
    at = after + 2 + content[after + 1] + 4 * place
    content[at : at + 4] = struct.pack("<f", number)
    path.write_bytes(content)


@pytest.fixture
def real(gait_data, tmp_path):
    """A real trial with two plates, EMG, and points as floats, to be spoiled."""
    (found,) = (gait_data / "young_straight_and_turn" / "HC030A" / "straight").glob("*.c3d")
    path = tmp_path / "walk.c3d"
    path.write_bytes(found.read_bytes())
    return path


@pytest.mark.parametrize("number", UNUSABLE)
@pytest.mark.parametrize(("group", "name"), [("ANALOG", "GEN_SCALE"), ("POINT", "SCALE")])
def test_a_scale_of_everything_that_cannot_be_used_is_refused(real, reader, group, name, number):
    _with_float(real, group, name, number)
    said = rf"must be finite and not 0; {group}:{name} of walk\.c3d is {number:g}\. Export the trial again"
    with pytest.raises(ReadError, match=said):
        read_trial(real, reader=reader)


@pytest.mark.parametrize("number", UNUSABLE)
def test_a_scale_of_points_in_the_header_that_cannot_be_used_is_refused(real, reader, number):
    content = bytearray(real.read_bytes())
    content[12:16] = struct.pack("<f", number)
    real.write_bytes(content)
    with pytest.raises(ReadError, match=rf"walk\.c3d.*{number:g}"):
        read_trial(real, reader=reader)


@pytest.mark.parametrize("number", UNUSABLE)
def test_a_channel_without_a_scale_is_missing_and_named(real, reader, number):
    sound = read_trial(real, reader=reader)
    place = 12  # the first after the channels of two plates
    _with_float(real, "ANALOG", "SCALE", number, place)
    trial = read_trial(real, reader=reader)
    (said,) = [f for f in trial.findings if f.kind == "scale"]
    assert said.severity == "warning" and said.file == "walk.c3d"
    assert said.what.startswith(f"ANALOG:SCALE of channel #{place + 1} ") and f"is {number:g}; a ch" in said.what
    emg, before = trial.stream("emg").values, sound.stream("emg").values
    gone = np.isnan(emg).all(axis=0)
    assert gone.sum() == 1
    np.testing.assert_array_equal(emg[:, ~gone], before[:, ~gone])
    np.testing.assert_array_equal(trial.stream("forces").values, sound.stream("forces").values)


def test_a_plate_with_such_a_channel_is_not_used(real, reader):
    _with_float(real, "ANALOG", "SCALE", float("nan"), 2)
    trial = read_trial(real, reader=reader)
    assert {name[:7] for name in trial.stream("forces").names} == {"plate_2"}
    assert any(says(f.what, "force plate 1", "scale") for f in trial.findings)


def test_offsets_are_held_to_the_same_and_zero_is_one():
    parameters = C3DParameters(
        {
            ("ANALOG", "LABELS"): ("L Rect", "R Rect", "L Hams"),
            ("ANALOG", "SCALE"): np.array([1.0, 0.0, 1.0]),
            ("ANALOG", "OFFSET"): np.array([0.0, 0.0, np.nan]),
        }
    )
    columns, (finding,) = list_unscaled(parameters, 3)
    assert columns == {1, 2}
    assert says(finding.what, "ANALOG:SCALE", "#2", "0; ANALOG:OFFSET", "#3")
