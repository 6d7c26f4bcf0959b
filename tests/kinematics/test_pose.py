"""A pose turns points there and back, and refuses what is no rotation."""

from __future__ import annotations

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from scipy.spatial.transform import Rotation

from gaitdisc.errors import ShapeError
from gaitdisc.kinematics.pose import Pose


@settings(deadline=None)
@given(st.integers(0, 2**32 - 1))
def test_points_come_back_from_the_laboratory(seed):
    random = np.random.default_rng(seed)
    pose = Pose(random.normal(size=(7, 3)), Rotation.random(7, random_state=seed).as_matrix())
    points = random.normal(size=(4, 3))
    there = pose.to_laboratory(points)
    assert there.shape == (7, 4, 3)
    np.testing.assert_allclose(pose.to_segment(there), np.broadcast_to(points, (7, 4, 3)), atol=1e-12)
    one = pose.to_laboratory(points[0])
    np.testing.assert_allclose(one, there[:, 0], atol=1e-12)
    np.testing.assert_allclose(pose.to_segment(one), np.broadcast_to(points[0], (7, 3)), atol=1e-12)


def test_the_columns_are_the_axes():
    heading = Rotation.from_euler("y", 90, degrees=True).as_matrix()[None]  # forward x becomes laboratory -z
    pose = Pose(np.zeros((1, 3)), heading)
    np.testing.assert_allclose(pose.to_laboratory(np.array([1.0, 0.0, 0.0])), [[0.0, 0.0, -1.0]], atol=1e-15)


def test_frames_that_are_unknown_stay_so():
    rotation = np.tile(np.eye(3), (3, 1, 1))
    rotation[1] = np.nan
    origin = np.zeros((3, 3))
    origin[2, 0] = np.nan
    pose = Pose(origin, rotation)
    assert pose.known.tolist() == [True, False, False]
    assert np.isnan(pose.to_laboratory(np.ones(3))[1]).all()


def test_arrays_are_read_only():
    pose = Pose(np.zeros((1, 3)), np.eye(3)[None])
    assert len(pose) == 1
    with pytest.raises(ValueError, match="read-only"):
        pose.origin[0, 0] = 1.0


def test_a_mirrored_frame_is_refused():
    mirrored = np.tile(np.eye(3), (2, 1, 1))
    mirrored[1] = np.diag([1.0, 1.0, -1.0])
    with pytest.raises(ShapeError, match=r"frame 1.*-1.*right"):
        Pose(np.zeros((2, 3)), mirrored)


def test_a_stretched_frame_is_refused():
    with pytest.raises(ShapeError, match=r"1 by up to 0\.21"):
        Pose(np.zeros((1, 3)), np.diag([1.1, 1.0, 1.0])[None])


def test_shapes_that_do_not_fit_are_refused():
    with pytest.raises(ShapeError, match=r"\(2, 3\).*\(3, 3, 3\)"):
        Pose(np.zeros((2, 3)), np.tile(np.eye(3), (3, 1, 1)))
