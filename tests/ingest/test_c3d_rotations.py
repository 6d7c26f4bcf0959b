"""Poses of segments as ezc3d writes them: read back, in metres, with what is not known left empty."""

from __future__ import annotations

import ezc3d
import numpy as np
import pytest
from scipy.spatial.transform import Rotation

from gaitdisc.errors import ReadError
from gaitdisc.ingest.c3d import read_c3d

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
