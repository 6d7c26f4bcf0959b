"""How a segment moves: velocity, acceleration, angular velocity and acceleration of its pose."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from gaitdisc.channel import Channel
from gaitdisc.errors import ShapeError
from gaitdisc.kinematics.pose import Pose
from gaitdisc.recording import Recording
from gaitdisc.signals.butterworth import lowpassed
from gaitdisc.signals.derivatives import differentiated


@dataclass(frozen=True, eq=False)
class SegmentMotion:
    """A pose and its first two derivatives in the laboratory's frame."""

    pose: Pose
    acceleration: NDArray[np.float64]  # (frame, 3) [m/s2], of the origin
    angular_velocity: NDArray[np.float64]  # (frame, 3) [rad/s], of the segment
    angular_acceleration: NDArray[np.float64]  # (frame, 3) [rad/s2], of the segment

    def acceleration_of(self, point: NDArray[np.float64]) -> NDArray[np.float64]:
        """Acceleration of a point of the segment, (frame, 3) [m/s2].

        point (3,) [m]: in the segment's frame
        """
        arm = self.pose.rotation @ np.asarray(point, float)
        spin = np.cross(self.angular_velocity, np.cross(self.angular_velocity, arm))
        return self.acceleration + np.cross(self.angular_acceleration, arm) + spin


def smoothed_pose(pose: Pose, time: NDArray[np.float64], cutoff_hz: float) -> Pose:
    """Pose without what is faster than the cut-off: origin and axes are filtered, the axes made a rotation again.

    time (frame,) [s]: even
    returns: gaps up to 0.1 s are bridged, as in every filtered recording here; longer ones stay NaN
    """
    frames = len(pose)
    values = np.hstack([pose.origin, pose.rotation.reshape(frames, 9)])
    values[~pose.known] = np.nan
    channels = tuple(Channel(f"pose_{place}", "signal", "1") for place in range(12))
    smooth = lowpassed(Recording(time, values, channels), cutoff_hz).values
    return Pose(smooth[:, :3], nearest_rotations(smooth[:, 3:].reshape(frames, 3, 3)))


def nearest_rotations(matrices: NDArray[np.float64]) -> NDArray[np.float64]:
    """Rotations nearest to matrices in the least-squares sense, (frame, 3, 3); NaN where a matrix has one.

    matrices (frame, 3, 3): nearly rotations

    >>> nearest_rotations(1.01 * np.eye(3)[None]).round(9).tolist()
    [[[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]]]
    """
    found = np.full(matrices.shape, np.nan)
    known = np.isfinite(matrices).all(axis=(1, 2))
    left, _, right = np.linalg.svd(matrices[known])
    left[:, :, 2] *= np.sign(np.linalg.det(left @ right))[:, None]
    found[known] = left @ right
    return found


def segment_motion(pose: Pose, rate_hz: float) -> SegmentMotion:
    """Derivatives of a pose by the package's five-point differences; NaN within two frames of an end or a gap."""
    flat = pose.rotation.reshape(len(pose), 9)
    turned = np.swapaxes(pose.rotation, 1, 2)
    rate = differentiated(flat, rate_hz).reshape(-1, 3, 3) @ turned
    second = differentiated(flat, rate_hz, 2).reshape(-1, 3, 3) @ turned
    # R'' R^T is the cross-product matrix of the angular acceleration and a symmetric part
    return SegmentMotion(pose, differentiated(pose.origin, rate_hz, 2), _axial(rate), _axial(second))


def segment_motions(
    poses: dict[str, Pose], time: NDArray[np.float64], cutoff_hz: float, names: Sequence[str]
) -> dict[str, SegmentMotion]:
    """SegmentMotion of several segments, filtered alike.

    time (frame,) [s]: even
    """
    found = {}
    rate_hz = (len(time) - 1) / float(time[-1] - time[0]) if len(time) > 1 else np.nan
    for name in names:
        if name not in poses:
            continue
        if len(poses[name]) != len(time):
            raise ShapeError(
                "poses need one frame for each time",
                f"{name} has {len(poses[name])} frames and there are {len(time)} times",
                "Give the poses and times of one recording.",
            )
        pose = poses[name]
        if np.isfinite(cutoff_hz):
            pose = smoothed_pose(pose, time, cutoff_hz)
        found[name] = segment_motion(pose, rate_hz)
    return found


def _axial(matrices: NDArray[np.float64]) -> NDArray[np.float64]:
    """Vector of the skew part of each matrix."""
    skew = (matrices - np.swapaxes(matrices, 1, 2)) / 2
    return np.stack([skew[:, 2, 1], skew[:, 0, 2], skew[:, 1, 0]], axis=1)
