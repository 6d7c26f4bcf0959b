"""Where a segment is and how it is turned, frame by frame: what angles, moments and powers are computed from."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from gaitdisc.errors import ShapeError
from gaitdisc.recording.arrays import read_only

SEGMENTS = ("pelvis", "thigh_l", "thigh_r", "shank_l", "shank_r", "foot_l", "foot_r")
JOINTS = ("hip_l", "hip_r", "knee_l", "knee_r", "ankle_l", "ankle_r")
NOT_A_ROTATION = 1e-6  # largest difference of R^T R from the identity, and of det R from 1


@dataclass(frozen=True, eq=False)
class Pose:
    """Origin and axes of one segment in the laboratory's frame.

    >>> Pose(np.zeros((2, 3)), np.tile(np.eye(3), (2, 1, 1))).known
    array([ True,  True])
    """

    # (frame, 3) [m], the segment's origin in the laboratory's frame; NaN where it is unknown
    origin: NDArray[np.float64]
    # (frame, 3, 3), columns are the segment's axes in the laboratory's frame: x forward, y up, z to the right of the
    # person; NaN where unknown. `rotation @ v` turns a vector of the segment into the laboratory's frame
    rotation: NDArray[np.float64]

    def __post_init__(self) -> None:
        """Check shapes and that every known matrix is a rotation, once."""
        origin, rotation = read_only(self.origin), read_only(self.rotation)
        if origin.ndim != 2 or origin.shape[1] != 3 or rotation.shape != (len(origin), 3, 3):
            raise ShapeError(
                "a pose needs an origin of shape (frame, 3) and a rotation of shape (frame, 3, 3)",
                f"found {origin.shape} and {rotation.shape}",
                "Put frames first; the columns of a rotation are the segment's axes.",
            )
        known = np.isfinite(rotation).all(axis=(1, 2))
        some = rotation[known]
        stretch = np.abs(np.swapaxes(some, 1, 2) @ some - np.eye(3)).max(axis=(1, 2), initial=0.0)
        wrong = (stretch > NOT_A_ROTATION) | (np.abs(np.linalg.det(some) - 1) > NOT_A_ROTATION)
        if wrong.any():
            first = int(np.flatnonzero(wrong)[0])
            raise ShapeError(
                "a pose needs rotations: axes of length 1, at right angles, right-handed",
                f"frame {int(np.flatnonzero(known)[first])} has determinant {np.linalg.det(some[first]):.6g} "
                f"and axes that differ from right angles and length 1 by up to {stretch[first]:.3g}",
                "Give the columns as x forward, y up, z to the right of the person.",
            )
        object.__setattr__(self, "origin", origin)
        object.__setattr__(self, "rotation", rotation)

    def __len__(self) -> int:
        return len(self.origin)

    @property
    def known(self) -> NDArray[np.bool_]:
        """Frames in which both origin and rotation are known (frame,)."""
        return np.asarray(np.isfinite(self.origin).all(axis=1) & np.isfinite(self.rotation).all(axis=(1, 2)))

    def without(self, frames: NDArray[np.bool_]) -> Pose:
        """Same pose, not known in some frames (frame,)."""
        return Pose(
            np.where(frames[:, None], np.nan, self.origin), np.where(frames[:, None, None], np.nan, self.rotation)
        )

    def to_laboratory(self, points: NDArray[np.float64]) -> NDArray[np.float64]:
        """Points fixed in the segment, in the laboratory's frame.

        points (point, 3) or (3,) [m]: in the segment's frame
        returns (frame, point, 3) or (frame, 3) [m]

        >>> Pose(np.ones((1, 3)), np.eye(3)[None]).to_laboratory(np.array([0.0, 1.0, 0.0]))
        array([[1., 2., 1.]])
        """
        points = np.asarray(points, float)
        if points.ndim == 1:
            return self.origin + self.rotation @ points
        return self.origin[:, None] + np.einsum("fij,pj->fpi", self.rotation, points)

    def to_segment(self, points: NDArray[np.float64]) -> NDArray[np.float64]:
        """Points of the laboratory's frame, in the segment's frame.

        points (frame, point, 3) or (frame, 3) [m]: in the laboratory's frame
        returns of the same shape [m]

        >>> Pose(np.ones((1, 3)), np.eye(3)[None]).to_segment(np.array([[1.0, 2.0, 1.0]]))
        array([[0., 1., 0.]])
        """
        points = np.asarray(points, float)
        if points.ndim == 2:
            return np.einsum("fji,fj->fi", self.rotation, points - self.origin)
        return np.einsum("fji,fpj->fpi", self.rotation, points - self.origin[:, None])
