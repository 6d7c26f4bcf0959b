"""Inverse dynamics of a chain of rigid segments, from the one that meets the ground upwards (Newton and Euler).

Everything is held about the laboratory's origin, so that the equations are sums: what a joint carries is the change of
momentum of all segments beyond it, less their weight, less what the ground gives.
"""

import itertools
from collections.abc import Mapping, Sequence
from dataclasses import dataclass

import numpy as np

from gaitdisc.errors import ShapeError
from gaitdisc.kinematics.pose import Pose
from gaitdisc.kinetics.platform import Wrench, low_passed
from gaitdisc.recording.arrays import Values, mean_rate
from gaitdisc.signals.derivatives import derivative

GRAVITY = 9.80665  # m/s2


@dataclass(frozen=True, eq=False)
class SegmentMotion:
    """A pose and its first two derivatives in the laboratory's frame."""

    pose: Pose
    acceleration: Values  # (frame, 3) [m/s2], of the origin
    angular_velocity: Values  # (frame, 3) [rad/s], of the segment
    angular_acceleration: Values  # (frame, 3) [rad/s2], of the segment

    def point_acceleration(self, point: Values) -> Values:
        """Acceleration (frame, 3) [m/s2] of a point (3,) [m] of the segment's frame."""
        arm = self.pose.rotation @ np.asarray(point, float)
        spin = np.cross(self.angular_velocity, np.cross(self.angular_velocity, arm))
        return self.acceleration + np.cross(self.angular_acceleration, arm) + spin


def smooth_pose(pose: Pose, time: Values, cutoff_hz: float) -> Pose:
    """Pose low-passed on even times, its axes made a rotation again; gaps up to 0.1 s are bridged, longer stay NaN."""
    frames = len(pose)
    values = np.hstack([pose.origin, pose.rotation.reshape(frames, 9)])
    values[~pose.known] = np.nan
    smooth = low_passed(time, values, cutoff_hz)
    return Pose(smooth[:, :3], nearest_rotations(smooth[:, 3:].reshape(frames, 3, 3)))


def nearest_rotations(matrices: Values) -> Values:
    """Rotations (frame, 3, 3) nearest to such matrices by least squares; NaN where a matrix has one.

    >>> nearest_rotations(1.01 * np.eye(3)[None]).round(9).tolist()
    [[[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]]]
    """
    rotations = np.full(matrices.shape, np.nan)
    known = np.isfinite(matrices).all(axis=(1, 2))
    left, _, right = np.linalg.svd(matrices[known])
    left[:, :, 2] *= np.sign(np.linalg.det(left @ right))[:, None]
    rotations[known] = left @ right
    return rotations


def segment_motion(pose: Pose, rate_hz: float) -> SegmentMotion:
    """Derivatives of a pose by the package's five-point differences; NaN within two frames of an end or a gap."""
    flat = pose.rotation.reshape(len(pose), 9)
    turned = np.swapaxes(pose.rotation, 1, 2)
    rate = derivative(flat, rate_hz).reshape(-1, 3, 3) @ turned
    second = derivative(flat, rate_hz, 2).reshape(-1, 3, 3) @ turned
    # R'' R^T is the cross-product matrix of the angular acceleration and a symmetric part
    return SegmentMotion(pose, derivative(pose.origin, rate_hz, 2), _axial(rate), _axial(second))


def segment_motions(poses: Mapping[str, Pose], time: Values, cutoff_hz: float) -> dict[str, SegmentMotion]:
    """SegmentMotion of several segments on even times, filtered alike."""
    motions = {}
    rate_hz = mean_rate(time) if len(time) > 1 else np.nan
    for name, pose in poses.items():
        if len(pose) != len(time):
            raise ShapeError(
                "there must be one pose for each time",
                f"{name} has {len(pose)} frames, and there are {len(time)} times",
                "Use the poses and times of the same recording.",
            )
        smooth = smooth_pose(pose, time, cutoff_hz) if np.isfinite(cutoff_hz) else pose
        motions[name] = segment_motion(smooth, rate_hz)
    return motions


def _axial(matrices: Values) -> Values:
    """Vector of the skew part of each matrix."""
    skew = (matrices - np.swapaxes(matrices, 1, 2)) / 2
    return np.stack([skew[:, 2, 1], skew[:, 0, 2], skew[:, 1, 0]], axis=1)


@dataclass(frozen=True, eq=False)
class RigidBody:
    """Inertia of one segment in its own frame.

    >>> RigidBody(3.0, np.array([0.0, -0.2, 0.0]), 0.05 * np.eye(3)).mass_kg
    3.0
    """

    mass_kg: float
    centre: Values  # (3,) [m], of mass, from the segment's origin
    tensor: Values  # (3, 3) [kg m2], about the centre of mass


def compute_wrench(moving: SegmentMotion, body: RigidBody, up: Values) -> Wrench:
    """Wrench that moves a segment and bears its weight: m (a - g), rate of angular momentum; up (3,) is a unit vector.

    >>> from gaitdisc.kinematics.pose import Pose
    >>> still = SegmentMotion(Pose(np.zeros((1, 3)), np.eye(3)[None]), *np.zeros((3, 1, 3)))
    >>> body = RigidBody(2.0, np.array([0.1, 0.0, 0.0]), np.eye(3))
    >>> compute_wrench(still, body, np.array([0.0, 1.0, 0.0])).moment.round(5)
    array([[0.     , 0.     , 1.96133]])
    """
    rotation = moving.pose.rotation
    tensor = rotation @ body.tensor @ np.swapaxes(rotation, 1, 2)
    spin = moving.angular_velocity
    turning = _times(tensor, moving.angular_acceleration) + np.cross(spin, _times(tensor, spin))
    force = body.mass_kg * (moving.point_acceleration(body.centre) + GRAVITY * np.asarray(up, float))
    return Wrench.at(moving.pose.to_laboratory(body.centre), force, turning)


def joint_wrenches(needed: Sequence[Wrench], ground: Wrench) -> list[Wrench]:
    """What each joint of a chain gives to the segments beyond it, from the last joint upwards.

    needed: `compute_wrench` of the segments from the one on the ground (foot) to the nearest to the trunk (thigh); each
        one's proximal joint is the joint that is named after it
    returns: one for each segment, by its proximal joint: of the nearer segment on the farther one. `about` the joint's
        centre it is the internal joint moment
    Source: Winter (2009), Biomechanics and Motor Control of Human Movement, chapter 7; Dumas, Aissaoui & de Guise
        (2004), Comput. Methods Biomech. Biomed. Eng. 7, 159-166, compute the same moments with wrenches and
        quaternions.
    """
    return list(itertools.accumulate([needed[0] - ground, *needed[1:]]))


def _times(tensors: Values, vectors: Values) -> Values:
    return np.einsum("fij,fj->fi", tensors, vectors)


def moment_per_foot_kg(joint: Values, heel: Values, toe: Values, up: Values, rate_hz: float) -> Values:
    """Return the moment that carries 1 kg midway between heel and toes (sample,) [N m/kg].

    It is positive towards dorsiflexion and hip flexion; at the knee that is extension.

    joint, heel, toe (sample, 3): low-passed places [m]

    >>> still = np.zeros((9, 3))
    >>> found = moment_per_foot_kg(still, still - [0.04, 0, 0], still + [0.16, 0, 0], np.array([0.0, 0, 1]), 100.0)
    >>> round(float(found[4]), 2)  # 6 cm before the joint
    0.59
    """
    middle = (heel + toe) / 2
    forward = toe - heel
    forward = forward - np.outer(forward @ up, up)
    axis = np.cross(forward / np.linalg.norm(forward, axis=1, keepdims=True), up)
    push = derivative(middle, rate_hz, 2) + GRAVITY * up
    return np.einsum("fx,fx->f", axis, np.cross(middle - joint, push))
