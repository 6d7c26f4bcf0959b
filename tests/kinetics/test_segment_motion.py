import numpy as np
import pytest
from scipy.spatial.transform import Rotation

from gaitdisc.errors import SamplingError, ShapeError
from gaitdisc.kinematics.pose import Pose
from gaitdisc.kinetics.newton_euler import nearest_rotations, segment_motion, segment_motions, smoothed_pose

TIME = np.arange(400) / 200
AXIS = np.array([2.0, -1.0, 2.0]) / 3


def turning():
    """About a fixed axis by 0.8 sin(4 t), its origin on a circle."""
    angle = 0.8 * np.sin(4 * TIME)
    rotation = Rotation.from_rotvec(angle[:, None] * AXIS).as_matrix()
    return Pose(np.stack([np.cos(3 * TIME), np.sin(3 * TIME), TIME], 1), rotation)


def test_derivatives_of_a_known_motion():
    moving = segment_motion(turning(), 200.0)
    inner = slice(2, -2)
    assert moving.angular_velocity[inner] == pytest.approx((3.2 * np.cos(4 * TIME))[inner, None] * AXIS, abs=1e-5)
    assert moving.angular_acceleration[inner] == pytest.approx((-12.8 * np.sin(4 * TIME))[inner, None] * AXIS, abs=1e-3)
    assert moving.acceleration[inner] == pytest.approx(-9 * (turning().origin * [1, 1, 0])[inner], abs=1e-5)
    assert np.isnan(moving.acceleration[:2]).all() and np.isnan(moving.angular_velocity[-2:]).all()


def test_a_point_of_the_segment_accelerates_as_its_path_does():
    pose, point = turning(), np.array([0.1, -0.3, 0.05])
    path = pose.to_laboratory(point)
    expected = segment_motion(Pose(path, pose.rotation), 200.0).acceleration
    found = segment_motion(pose, 200.0).acceleration_of(point)
    assert found[2:-2] == pytest.approx(expected[2:-2], abs=2e-4)


def test_smoothing_keeps_slow_turns_and_takes_tremor_away():
    slow = turning()
    tremor = Rotation.from_rotvec(np.outer(0.02 * np.sin(2 * np.pi * 30 * TIME), [0, 0, 1])).as_matrix()
    smooth = smoothed_pose(Pose(slow.origin, slow.rotation @ tremor), TIME, 6.0)
    inner = slice(60, -60)
    apart = Rotation.from_matrix(smooth.rotation[inner]).inv() * Rotation.from_matrix(slow.rotation[inner])
    assert apart.magnitude().max() < 2e-3
    assert np.abs(np.swapaxes(smooth.rotation, 1, 2) @ smooth.rotation - np.eye(3)).max() < 1e-12


def test_a_body_that_falls_accelerates_by_g():
    origin = np.outer(-0.5 * 9.81 * TIME**2, [0.0, 1.0, 0.0])
    poses = {"foot_r": Pose(origin, np.tile(np.eye(3), (400, 1, 1)))}
    moving = segment_motions(poses, TIME, np.inf, ["foot_r", "foot_l"])
    assert list(moving) == ["foot_r"]
    assert moving["foot_r"].acceleration[2:-2, 1] == pytest.approx(-9.81, rel=1e-6)


def test_a_mirror_image_is_made_a_rotation():
    assert np.linalg.det(nearest_rotations(np.diag([1.0, 1.0, -0.1])[None]))[0] == pytest.approx(1.0)


def test_a_long_gap_stays_unknown():
    origin = np.array(turning().origin)
    origin[100:200] = np.nan
    moving = segment_motion(smoothed_pose(Pose(origin, turning().rotation), TIME, 6.0), 200.0)
    assert np.isnan(moving.acceleration[100:200]).all()
    assert np.isfinite(moving.acceleration[10:90]).all()


def test_frames_that_do_not_fit_are_refused():
    with pytest.raises(ShapeError, match=r"foot_r.*400 frames.*399 times"):
        segment_motions({"foot_r": turning()}, TIME[:-1], np.inf, ["foot_r"])
    with pytest.raises(SamplingError, match="5 samples"):
        segment_motion(Pose(np.zeros((3, 3)), np.tile(np.eye(3), (3, 1, 1))), 100.0)
