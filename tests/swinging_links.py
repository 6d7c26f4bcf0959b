"""Links on hinges whose motion is written down: exact poses, accelerations and Lagrange's moments."""

import numpy as np
from scipy.spatial.transform import Rotation

from gaitdisc.kinematics.pose import Pose
from gaitdisc.kinetics.newton_euler import GRAVITY, RigidBody, SegmentMotion

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
    tip = LENGTH * np.stack([np.sin(q[0]), -np.cos(q[0]), 0 * time], 1)
    along, across = (
        np.stack([np.sin(q[0]), -np.cos(q[0]), 0 * time], 1),
        np.stack([np.cos(q[0]), np.sin(q[0]), 0 * time], 1),
    )
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
