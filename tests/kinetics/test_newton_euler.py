"""Segments in motion and the wrenches that move them: pendulums, a top, a standing leg, a mass that is carried."""

import numpy as np
import pytest
from scipy.spatial.transform import Rotation

from gaitdisc.errors import SamplingError, ShapeError
from gaitdisc.kinematics.pose import Pose
from gaitdisc.kinetics.newton_euler import (
    GRAVITY,
    RigidBody,
    SegmentMotion,
    compute_wrench,
    joint_wrenches,
    moment_per_foot_kg,
    nearest_rotations,
    segment_motion,
    segment_motions,
    smooth_pose,
)
from gaitdisc.kinetics.platform import Wrench

UP = np.array([0.0, 1.0, 0.0])
TIME = np.arange(300) / 100
NO_GROUND = Wrench(np.zeros((len(TIME), 3)), np.zeros((len(TIME), 3)))
LENGTH, CENTRES, MASSES, INERTIAS = 0.42, (0.19, 0.24), (3.4, 1.9), (0.061, 0.035)
Z = np.array([0.0, 0.0, 1.0])


def rotations(angles):
    """About z: 0 hangs down along -y, positive swings forwards."""
    return Rotation.from_euler("z", np.reshape(angles, (-1, 1))).as_matrix()


def bodies():
    """Two links; the second has inertia about the other axes too, which a plane motion does not feel."""
    return [
        RigidBody(mass, np.array([0.0, -centre, 0.0]), np.diag([0.02, 0.01, inertia]))
        for mass, centre, inertia in zip(MASSES, CENTRES, INERTIAS, strict=True)
    ]


def link(origin, acceleration, angle, rate, second):
    """One link's exact motion."""
    spin = np.outer(rate, Z), np.outer(second, Z)
    return SegmentMotion(Pose(origin, rotations(angle)), acceleration, *spin)


def double_pendulum(time, turn=None, shift=None):
    """Two links from a fixed hinge: (upper, lower), and Lagrange's moments at both hinges (time, 2) [N m]."""
    q = np.stack([0.6 * np.sin(3.1 * time), -0.5 + 0.4 * np.sin(5.3 * time + 0.4)])
    v = np.stack([0.6 * 3.1 * np.cos(3.1 * time), 0.4 * 5.3 * np.cos(5.3 * time + 0.4)])
    a = np.stack([-0.6 * 3.1**2 * np.sin(3.1 * time), -0.4 * 5.3**2 * np.sin(5.3 * time + 0.4)])
    whole, spin, second = q.sum(0), v.sum(0), a.sum(0)
    along, across = (
        np.stack([np.sin(q[0]), -np.cos(q[0]), 0 * time], 1),
        np.stack([np.cos(q[0]), np.sin(q[0]), 0 * time], 1),
    )
    tip = LENGTH * along
    tip_acceleration = LENGTH * (a[0][:, None] * across - (v[0] ** 2)[:, None] * along)
    upper = link(np.zeros_like(tip), np.zeros_like(tip), q[0], v[0], a[0])
    lower = link(tip, tip_acceleration, whole, spin, second)
    (m1, m2), (c1, c2), (i1, i2), g = MASSES, CENTRES, INERTIAS, GRAVITY
    coupling, bend = m2 * LENGTH * c2 * np.cos(q[1]), m2 * LENGTH * c2 * np.sin(q[1])
    near, far = i1 + m1 * c1**2 + m2 * LENGTH**2, i2 + m2 * c2**2
    heavy = g * m2 * c2 * np.sin(whole)
    tau2 = (far + coupling) * a[0] + far * a[1] + bend * v[0] ** 2 + heavy
    tau1 = (near + far + 2 * coupling) * a[0] + (far + coupling) * a[1] - bend * (2 * v[0] * v[1] + v[1] ** 2)
    tau1 = tau1 + g * (m1 * c1 + m2 * LENGTH) * np.sin(q[0]) + heavy
    moved = [_moved(one, turn, shift) for one in (upper, lower)]
    return moved, np.stack([tau1, tau2], 1)


def _moved(moving, turn, shift):
    """Same motion in another laboratory's frame."""
    if turn is None:
        return moving
    turned = [vector @ turn.T for vector in (moving.acceleration, moving.angular_velocity, moving.angular_acceleration)]
    return SegmentMotion(Pose(moving.pose.origin @ turn.T + shift, turn @ moving.pose.rotation), *turned)


@pytest.mark.parametrize("seed", [None, 3, 8])
def test_a_double_pendulum_has_the_moments_of_lagrange_in_every_laboratory(seed):
    turn, shift = np.eye(3), np.zeros(3)
    if seed is not None:
        turn = Rotation.random(random_state=seed).as_matrix()
        shift = np.array([3.0, -1.0, 2.0])
    (upper, lower), expected = double_pendulum(TIME, turn, shift)
    near, far = bodies()
    up = turn @ UP
    at_lower, at_upper = joint_wrenches([compute_wrench(lower, far, up), compute_wrench(upper, near, up)], NO_GROUND)
    found = [w.about(m.pose.origin) @ (turn @ Z) for w, m in ((at_upper, upper), (at_lower, lower))]
    assert np.abs(np.stack(found, 1) - expected).max() < 1e-9
    assert np.abs(expected).max() > 5


def test_a_pendulum_from_its_poses_alone_has_its_moment_to_1_percent():
    angle = 0.5 * np.sin(2 * np.pi * 1.2 * TIME)
    body = bodies()[0]
    pose = Pose(np.tile([0.4, 1.0, -0.2], (len(TIME), 1)), rotations(angle))
    moving = segment_motion(smooth_pose(pose, TIME, 6.0), 100.0)
    moment = joint_wrenches([compute_wrench(moving, body, UP)], NO_GROUND)[0].about(pose.origin) @ Z
    inertia = INERTIAS[0] + MASSES[0] * CENTRES[0] ** 2
    expected = -inertia * (2 * np.pi * 1.2) ** 2 * angle + MASSES[0] * GRAVITY * CENTRES[0] * np.sin(angle)
    inner = slice(50, -50)  # the filter's edges
    assert np.abs(moment - expected)[inner].max() < 0.01 * np.abs(expected).max()


def test_a_spinning_top_needs_the_moment_of_euler():
    body = RigidBody(1.0, np.zeros(3), np.diag([0.1, 0.3, 0.2]))
    spin = np.array([[2.0, 5.0, -1.0]])
    still = np.zeros((1, 3))
    moving = SegmentMotion(Pose(still, np.eye(3)[None]), still, spin, still)
    moment = compute_wrench(moving, body, UP).about(np.zeros(3))
    # Euler: (I3 - I2) w2 w3, (I1 - I3) w3 w1, (I2 - I1) w1 w2
    assert moment == pytest.approx(np.array([[-0.1 * 5 * -1, -0.1 * -1 * 2, 0.2 * 2 * 5]]))


def test_a_standing_leg_has_the_moments_of_statics():
    still = np.zeros((1, 3))
    places = {"foot": [0.0, 0.08, 0.1], "shank": [0.02, 0.5, 0.1], "thigh": [0.05, 0.92, 0.09]}
    at = {name: SegmentMotion(Pose(np.array([p]), np.eye(3)[None]), still, still, still) for name, p in places.items()}
    masses = {"foot": 0.9, "shank": 3.5, "thigh": 9.0}
    centres = {"foot": [0.06, -0.04, 0.0], "shank": [-0.01, -0.18, 0.0], "thigh": [-0.02, -0.17, 0.01]}
    bodies = {name: RigidBody(masses[name], np.array(centre), np.eye(3)) for name, centre in centres.items()}
    force, point = np.array([12.0, 380.0, -9.0]), np.array([0.07, 0.0, 0.11])
    carried = joint_wrenches([compute_wrench(at[n], bodies[n], UP) for n in places], Wrench.at(point, force[None]))
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


FAST = np.arange(400) / 200
AXIS = np.array([2.0, -1.0, 2.0]) / 3


def turning():
    """About a fixed axis by 0.8 sin(4 t), its origin on a circle."""
    angle = 0.8 * np.sin(4 * FAST)
    rotation = Rotation.from_rotvec(angle[:, None] * AXIS).as_matrix()
    return Pose(np.stack([np.cos(3 * FAST), np.sin(3 * FAST), FAST], 1), rotation)


def test_derivatives_of_a_known_motion():
    moving = segment_motion(turning(), 200.0)
    inner = slice(2, -2)
    assert moving.angular_velocity[inner] == pytest.approx((3.2 * np.cos(4 * FAST))[inner, None] * AXIS, abs=1e-5)
    assert moving.angular_acceleration[inner] == pytest.approx((-12.8 * np.sin(4 * FAST))[inner, None] * AXIS, abs=1e-3)
    assert moving.acceleration[inner] == pytest.approx(-9 * (turning().origin * [1, 1, 0])[inner], abs=1e-5)
    assert np.isnan(moving.acceleration[:2]).all() and np.isnan(moving.angular_velocity[-2:]).all()


def test_a_point_of_the_segment_accelerates_as_its_path_does():
    pose, point = turning(), np.array([0.1, -0.3, 0.05])
    path = pose.to_laboratory(point)
    expected = segment_motion(Pose(path, pose.rotation), 200.0).acceleration
    found = segment_motion(pose, 200.0).point_acceleration(point)
    assert found[2:-2] == pytest.approx(expected[2:-2], abs=2e-4)


def test_smoothing_keeps_slow_turns_and_takes_tremor_away():
    slow = turning()
    tremor = Rotation.from_rotvec(np.outer(0.02 * np.sin(2 * np.pi * 30 * FAST), [0, 0, 1])).as_matrix()
    smooth = smooth_pose(Pose(slow.origin, slow.rotation @ tremor), FAST, 6.0)
    inner = slice(60, -60)
    apart = Rotation.from_matrix(smooth.rotation[inner]).inv() * Rotation.from_matrix(slow.rotation[inner])
    assert apart.magnitude().max() < 2e-3
    assert np.abs(np.swapaxes(smooth.rotation, 1, 2) @ smooth.rotation - np.eye(3)).max() < 1e-12


def test_a_body_that_falls_accelerates_by_g():
    origin = np.outer(-0.5 * 9.81 * FAST**2, [0.0, 1.0, 0.0])
    poses = {"foot_r": Pose(origin, np.tile(np.eye(3), (400, 1, 1)))}
    moving = segment_motions(poses, FAST, np.inf)
    assert list(moving) == ["foot_r"]
    assert moving["foot_r"].acceleration[2:-2, 1] == pytest.approx(-9.81, rel=1e-6)


def test_a_mirror_image_is_made_a_rotation():
    assert np.linalg.det(nearest_rotations(np.diag([1.0, 1.0, -0.1])[None]))[0] == pytest.approx(1.0)


def test_a_long_gap_stays_unknown():
    origin = np.array(turning().origin)
    origin[100:200] = np.nan
    moving = segment_motion(smooth_pose(Pose(origin, turning().rotation), FAST, 6.0), 200.0)
    assert np.isnan(moving.acceleration[100:200]).all()
    assert np.isfinite(moving.acceleration[10:90]).all()


def test_frames_that_do_not_fit_are_refused():
    with pytest.raises(ShapeError, match=r"foot_r.*400 frames.*399 times"):
        segment_motions({"foot_r": turning()}, FAST[:-1], np.inf)
    with pytest.raises(SamplingError, match="5 samples"):
        segment_motion(Pose(np.zeros((3, 3)), np.tile(np.eye(3), (3, 1, 1))), 100.0)


ABOVE = np.array([0.0, 0.0, 1.0])


def test_a_mass_swung_on_a_circle_needs_the_moment_of_a_pendulum():
    """1 kg at radius r: r^2 times the angular acceleration, and r g sin of the angle from hanging."""
    rate, radius = 200.0, 0.4
    t = np.arange(400) / rate
    angle = 0.5 * np.sin(2 * np.pi * t)
    middle = radius * np.column_stack([np.sin(angle), 0 * t, -np.cos(angle)])
    ahead = np.column_stack([np.cos(angle), 0 * t, np.sin(angle)]) * 0.1
    found = moment_per_foot_kg(np.zeros((400, 3)), middle - ahead, middle + ahead, ABOVE, rate)
    speedup = -0.5 * (2 * np.pi) ** 2 * np.sin(2 * np.pi * t)
    true = radius**2 * speedup + 9.80665 * radius * np.sin(angle)
    inner = slice(5, -5)
    assert found[inner] == pytest.approx(true[inner], abs=0.01)


def test_it_does_not_matter_which_way_the_person_walks():
    still = np.zeros((9, 3))
    turned = [moment_per_foot_kg(still, still - one, still + 3 * one, ABOVE, 100.0)[4] for one in 0.04 * np.eye(3)[:2]]
    assert turned[0] == pytest.approx(turned[1])
