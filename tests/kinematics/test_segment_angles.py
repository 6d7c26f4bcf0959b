"""Angles of segments that are given as poses are those by which the body moved."""

from __future__ import annotations

import numpy as np
import pytest
from manufactured_body import body_frames, known_angles
from texts import says

from gaitdisc.channel import Channel
from gaitdisc.errors import ChannelError, ShapeError
from gaitdisc.kinematics.motion import segment_angles
from gaitdisc.recording import Recording, Source

LABORATORY = np.array([[0.0, 0, 1], [1, 0, 0], [0, 1, 0]])  # forward y, up z, right x, as Theia3D has it
BACK = [2, 0, 1]  # columns forward, up, right as right, forward, up


def segments_of(angles: dict[str, np.ndarray], speed: float = 1.3) -> Recording:
    """Poses of a body as a system without markers writes them."""
    channels, columns = [], []
    for name, (origin, rotation) in body_frames(angles, speed).items():
        part, _, side = name.partition("_")
        label = f"{side}_{part}" if side else part
        axes = (LABORATORY @ rotation)[:, :, BACK]
        columns += [origin @ LABORATORY.T, axes.reshape(-1, 9)]
        channels += [Channel(f"{label}.{axis}", "translation", "m") for axis in "xyz"]
        channels += [Channel(f"{label}.r{row}{column}", "signal", "1") for row in "123" for column in "123"]
    values = np.hstack(columns).astype(np.float32).astype(float)  # as a file holds them
    return Recording(np.arange(len(values)) / 100, values, tuple(channels), source=Source("theia.c3d"))


@pytest.mark.parametrize("speed", [0.0, 1.3])
def test_known_angles_come_back(speed):
    known = known_angles(300)
    angles, findings = segment_angles(segments_of(known, speed))
    for name, expected in known.items():
        # on its path a walker has the mean of the pelvis' rotation as a turn of the whole, in place too
        apart = angles[name] - expected
        apart -= apart.mean() if name == "pelvis_rotation" else 0.0
        slack = 0.5 if name in ("pelvis_tilt", "pelvis_list", "pelvis_rotation") else 1e-4
        assert np.abs(apart).max() < slack, name
    assert {finding.kind for finding in findings} == {"segments", "direction"}


def test_frames_without_a_pose_are_empty_and_counted():
    segments = segments_of(known_angles(200))
    values = np.array(segments.values)
    values[20:30, [segments.index(name) for name in segments.names if name.startswith("l_shank")]] = np.nan
    angles, findings = segment_angles(segments.with_values(values))
    assert np.isnan(angles["knee_angle_l"][20:30]).all() and np.isfinite(angles["knee_angle_r"]).all()
    (said,) = [finding.what for finding in findings if finding.kind == "gap"]
    assert says(said, "l_shank: not", "10 of 200 frames")


def test_a_segment_that_is_missing_and_axes_that_are_none_are_refused():
    segments = segments_of(known_angles(50))
    with pytest.raises(ChannelError, match=r"theia\.c3d.*no r_foot.*l_foot, l_shank, l_thigh"):
        segment_angles(segments.selected([name for name in segments.names if not name.startswith("r_foot")]))
    values = np.array(segments.values)
    values[9, segments.index("l_thigh.r11")] *= 1.2
    with pytest.raises(ShapeError, match=r"theia\.c3d: l_thigh.*frame 10"):
        segment_angles(segments.with_values(values))
