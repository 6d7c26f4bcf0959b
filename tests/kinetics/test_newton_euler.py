import numpy as np
import pytest
import swinging_links as links
from scipy.spatial.transform import Rotation

from gaitdisc.kinematics.pose import Pose
from gaitdisc.kinetics.newton_euler import (
    GRAVITY,
    RigidBody,
    SegmentMotion,
    joint_wrenches,
    needed_wrench,
    segment_motion,
    smoothed_pose,
)
from gaitdisc.kinetics.platform import Wrench

UP = np.array([0.0, 1.0, 0.0])
TIME = np.arange(300) / 100


def no_ground(frames):
    return Wrench(np.zeros((frames, 3)), np.zeros((frames, 3)))


@pytest.mark.parametrize("seed", [None, 3, 8])
def test_a_double_pendulum_has_the_moments_of_lagrange_in_every_laboratory(seed):
    turn, shift = np.eye(3), np.zeros(3)
    if seed is not None:
        turn = Rotation.random(random_state=seed).as_matrix()
        shift = np.array([3.0, -1.0, 2.0])
    (upper, lower), expected = links.double_pendulum(TIME, turn, shift)
    near, far = links.bodies()
    at_lower, at_upper = joint_wrenches([(lower, far), (upper, near)], no_ground(len(TIME)), turn @ UP)
    found = [w.about(m.pose.origin) @ (turn @ links.Z) for w, m in ((at_upper, upper), (at_lower, lower))]
    assert np.abs(np.stack(found, 1) - expected).max() < 1e-9
    assert np.abs(expected).max() > 5


def test_a_pendulum_from_its_poses_alone_has_its_moment_to_1_percent():
    angle = 0.5 * np.sin(2 * np.pi * 1.2 * TIME)
    body = links.bodies()[0]
    pose = Pose(np.tile([0.4, 1.0, -0.2], (len(TIME), 1)), links.rotations(angle))
    moving = segment_motion(smoothed_pose(pose, TIME, 6.0), 100.0)
    moment = joint_wrenches([(moving, body)], no_ground(len(TIME)), UP)[0].about(pose.origin) @ links.Z
    inertia = links.INERTIAS[0] + links.MASSES[0] * links.CENTRES[0] ** 2
    expected = -inertia * (2 * np.pi * 1.2) ** 2 * angle + links.MASSES[0] * GRAVITY * links.CENTRES[0] * np.sin(angle)
    inner = slice(50, -50)  # the filter's edges
    assert np.abs(moment - expected)[inner].max() < 0.01 * np.abs(expected).max()


def test_a_spinning_top_needs_the_moment_of_euler():
    body = RigidBody(1.0, np.zeros(3), np.diag([0.1, 0.3, 0.2]))
    spin = np.array([[2.0, 5.0, -1.0]])
    still = np.zeros((1, 3))
    moving = SegmentMotion(Pose(still, np.eye(3)[None]), still, spin, still)
    moment = needed_wrench(moving, body, UP).about(np.zeros(3))
    # Euler: (I3 - I2) w2 w3, (I1 - I3) w3 w1, (I2 - I1) w1 w2
    assert moment == pytest.approx(np.array([[-0.1 * 5 * -1, -0.1 * -1 * 2, 0.2 * 2 * 5]]))


def test_a_standing_leg_has_the_moments_of_statics():
    still = np.zeros((1, 3))
    places = {"foot": [0.0, 0.08, 0.1], "shank": [0.02, 0.5, 0.1], "thigh": [0.05, 0.92, 0.09]}
    at = {name: SegmentMotion(Pose(np.array([p]), np.eye(3)[None]), still, still, still) for name, p in places.items()}
    masses = {"foot": 0.9, "shank": 3.5, "thigh": 9.0}
    centres = {"foot": [0.06, -0.04, 0.0], "shank": [-0.01, -0.18, 0.0], "thigh": [-0.02, -0.17, 0.01]}
    chain = [(at[n], RigidBody(masses[n], np.array(centres[n]), np.eye(3))) for n in ("foot", "shank", "thigh")]
    force, point = np.array([12.0, 380.0, -9.0]), np.array([0.07, 0.0, 0.11])
    carried = joint_wrenches(chain, Wrench.at(point, force[None]), UP)
    beyond = []
    for wrench, name in zip(carried, ("foot", "shank", "thigh"), strict=True):
        beyond.append(name)
        joint = np.array(places[name])
        by_hand = -np.cross(point - joint, force)
        for one in beyond:
            arm = np.array(places[one]) + centres[one] - joint
            by_hand += np.cross(arm, masses[one] * GRAVITY * UP)
        assert wrench.about(joint)[0] == pytest.approx(by_hand, abs=1e-12)
    # the force passes 7 cm ahead of the ankle: the calf holds, which is towards plantarflexion, negative about z
    assert carried[0].about(np.array(places["foot"]))[0, 2] < -20
