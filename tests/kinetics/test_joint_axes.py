import numpy as np
import pytest
from scipy.spatial.transform import Rotation

from gaitdisc.kinematics.pose import Pose
from gaitdisc.kinetics.joint_moments import PARTS, along, joint_axes
from gaitdisc.kinetics.newton_euler import segment_motion

TIME = np.arange(200) / 100
HIP = [part for part in PARTS if part.joint == "hip"]


def pose(rotation):
    return Pose(np.zeros((len(rotation), 3)), rotation)


def relative(angles, sign):
    """Grood & Suntay: flexion about the nearer z, adduction about the floating x, rotation about the farther y."""
    flexion, adduction, rotation = angles
    turns = np.stack([flexion, sign * adduction, sign * rotation], axis=1)
    return Rotation.from_euler("ZXY", turns).as_matrix()


@pytest.mark.parametrize(("side", "sign"), [("r", 1), ("l", -1)])
def test_the_parts_of_a_moment_times_the_rates_of_the_angles_are_the_power(side, sign):
    angles = [0.5 * np.sin(4 * TIME), 0.2 + 0.2 * np.cos(3 * TIME), -0.3 * np.sin(2 * TIME + 1)]
    rates = [2.0 * np.cos(4 * TIME), -0.6 * np.sin(3 * TIME), -0.6 * np.cos(2 * TIME + 1)]
    nearer = Rotation.from_rotvec(np.outer(np.sin(TIME), [0.3, -0.2, 0.5])).as_matrix()
    near, far = pose(nearer), pose(nearer @ relative(angles, sign))
    turning = segment_motion(far, 100.0).angular_velocity - segment_motion(near, 100.0).angular_velocity
    moment = np.random.default_rng(5).normal(size=(len(TIME), 3))
    power = np.einsum("fx,fx->f", moment, turning)
    axes = joint_axes(near, far)
    by_parts = sum(along(moment, axes, part, side) * rate for part, rate in zip(HIP, rates, strict=True))
    assert by_parts[3:-3] == pytest.approx(power[3:-3], abs=1e-4)
    assert np.abs(power[3:-3]).max() > 1


def test_positive_is_the_movement_that_the_moment_makes():
    """A moment turns the farther segment: its lower end goes forwards, to the middle, its front inwards."""
    straight = pose(np.eye(3)[None])
    axes = joint_axes(straight, straight)
    down, front = np.array([0.0, -1.0, 0.0]), np.array([1.0, 0.0, 0.0])
    cases = {"hip_flexion": (down, [1, 0, 0]), "hip_adduction": (down, None), "hip_rotation": (front, None)}
    cases |= {"knee_angle": (down, [-1, 0, 0]), "ankle_angle": (front, [0, 1, 0]), "ankle_inversion": (down, None)}
    for side, inwards in (("r", [0, 0, -1]), ("l", [0, 0, 1])):
        for name, (end, goes) in cases.items():
            part = next(one for one in PARTS if one.angle == name)
            moment = next(m for m in np.vstack([np.eye(3), -np.eye(3)]) if along(m[None], axes, part, side)[0] > 0.5)
            assert np.cross(moment, end) == pytest.approx(np.array(goes or inwards)), (side, name)


def test_axes_on_one_line_have_no_parts():
    locked = pose(Rotation.from_euler("x", [[np.pi / 2]]).as_matrix().reshape(1, 3, 3))
    assert np.isnan(joint_axes(pose(np.eye(3)[None]), locked)[0, 1]).all()
