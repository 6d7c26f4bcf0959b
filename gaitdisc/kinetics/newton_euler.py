"""Inverse dynamics of a chain of rigid segments, from the one that meets the ground upwards (Newton and Euler).

Everything is held about the laboratory's origin, so that the equations are sums: what a joint carries is the change of
momentum of all segments beyond it, less their weight, less what the ground gives.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from gaitdisc.kinetics.segment_motion import SegmentMotion
from gaitdisc.kinetics.wrench import Wrench

GRAVITY = 9.80665  # m/s2


@dataclass(frozen=True, eq=False)
class RigidBody:
    """Inertia of one segment in its own frame.

    >>> RigidBody(3.0, np.array([0.0, -0.2, 0.0]), 0.05 * np.eye(3)).mass_kg
    3.0
    """

    mass_kg: float
    centre: NDArray[np.float64]  # (3,) [m], of mass, from the segment's origin
    tensor: NDArray[np.float64]  # (3, 3) [kg m2], about the centre of mass


def needed_wrench(moving: SegmentMotion, body: RigidBody, up: NDArray[np.float64]) -> Wrench:
    """Wrench that moves a segment as it moves and bears its weight: m (a - g), and the rate of its angular momentum.

    up (3,): unit vector against gravity, in the laboratory's frame

    >>> from gaitdisc.kinematics.pose import Pose
    >>> still = SegmentMotion(Pose(np.zeros((1, 3)), np.eye(3)[None]), *np.zeros((3, 1, 3)))
    >>> body = RigidBody(2.0, np.array([0.1, 0.0, 0.0]), np.eye(3))
    >>> needed_wrench(still, body, np.array([0.0, 1.0, 0.0])).moment.round(5)
    array([[0.     , 0.     , 1.96133]])
    """
    rotation = moving.pose.rotation
    tensor = rotation @ body.tensor @ np.swapaxes(rotation, 1, 2)
    spin = moving.angular_velocity
    turning = _times(tensor, moving.angular_acceleration) + np.cross(spin, _times(tensor, spin))
    force = body.mass_kg * (moving.acceleration_of(body.centre) + GRAVITY * np.asarray(up, float))
    return Wrench.at(moving.pose.to_laboratory(body.centre), force, turning)


def joint_wrenches(
    chain: Sequence[tuple[SegmentMotion, RigidBody]], ground: Wrench, up: NDArray[np.float64]
) -> list[Wrench]:
    """What each joint of a chain gives to the segments beyond it, from the last joint upwards.

    chain sequence of (SegmentMotion, RigidBody): segments from the one on the ground (foot) to the nearest to the
        trunk (thigh); each one's proximal joint is the joint that is named after it
    up (3,): unit vector against gravity
    returns: one for each segment, by its proximal joint: of the nearer segment on the farther one. `about` the joint's
        centre it is the internal joint moment
    Source: Winter (2009), Biomechanics and Motor Control of Human Movement, chapter 7; Dumas, Aissaoui & de Guise
        (2004), Comput. Methods Biomech. Biomed. Eng. 7, 159-166, compute the same moments with wrenches and
        quaternions.
    """
    carried, beyond = [], None
    for moving, body in chain:
        own = needed_wrench(moving, body, up)
        beyond = own - ground if beyond is None else beyond + own
        carried.append(beyond)
    return carried


def _times(tensors: NDArray[np.float64], vectors: NDArray[np.float64]) -> NDArray[np.float64]:
    return np.einsum("fij,fj->fi", tensors, vectors)
