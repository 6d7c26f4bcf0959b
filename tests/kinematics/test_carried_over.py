"""A gap is closed by the held body without a step at its ends, and stays open where that leads elsewhere."""

from __future__ import annotations

import numpy as np
from scipy.spatial.transform import Rotation

from gaitdisc.kinematics.pose import Pose
from gaitdisc.kinematics.segment_poses import carried_over

FRAMES, GAP = 60, slice(20, 40)


def swinging(offset_deg: float = 0.0, shift_m: float = 0.0) -> Pose:
    angle = 20 * np.sin(np.arange(FRAMES) / 10) + offset_deg
    origin = np.stack([np.arange(FRAMES) / 100, np.zeros(FRAMES) + shift_m, np.zeros(FRAMES)], axis=1)
    return Pose(origin, Rotation.from_euler("z", angle[:, None], degrees=True).as_matrix())


def with_gap(pose: Pose, gap: slice) -> Pose:
    origin, rotation = np.array(pose.origin), np.array(pose.rotation)
    origin[gap], rotation[gap] = np.nan, np.nan
    return Pose(origin, rotation)


def test_a_held_body_that_differs_by_a_constant_closes_the_gap_exactly():
    whole = swinging()
    found = carried_over(with_gap(whole, GAP), swinging(7.0, 0.02))
    np.testing.assert_allclose(found.rotation, whole.rotation, atol=1e-12)
    np.testing.assert_allclose(found.origin, whole.origin, atol=1e-12)


def test_frames_that_are_known_stay_as_they_are():
    whole = swinging()
    assert carried_over(whole, swinging(7.0)) is whole


def test_a_gap_at_the_end_keeps_the_last_difference():
    whole = swinging()
    found = carried_over(with_gap(whole, slice(50, FRAMES)), swinging(7.0, 0.02))
    np.testing.assert_allclose(found.rotation, whole.rotation, atol=1e-12)


def test_where_the_held_body_is_unknown_the_gap_stays():
    found = carried_over(with_gap(swinging(), GAP), with_gap(swinging(), slice(25, 30)))
    assert np.flatnonzero(~found.known).tolist() == [25, 26, 27, 28, 29]


def test_a_held_body_that_has_flipped_is_not_followed():
    """Within the gap the held body is turned by 70 deg, as in another minimum of the squares."""
    held = swinging()
    rotation = np.array(held.rotation)
    rotation[25:30] = rotation[25:30] @ Rotation.from_euler("y", 70, degrees=True).as_matrix()
    found = carried_over(with_gap(swinging(), GAP), Pose(held.origin, rotation))
    assert np.flatnonzero(~found.known).tolist() == [25, 26, 27, 28, 29]
