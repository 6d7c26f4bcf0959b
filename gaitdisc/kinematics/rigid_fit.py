"""A rigid body laid over its markers by least squares, all frames at once, whichever markers are seen."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from gaitdisc.kinematics.pose import Pose

FEWEST_POINTS = 3
LEAST_BREADTH_M = 0.01  # second largest extent of the points that are seen: on a line no turn about it is known


@dataclass(frozen=True, eq=False)
class RigidFit:
    """Pose of a body and how well its markers keep their shape."""

    pose: Pose  # NaN in frames with fewer than three points, or points on a line
    seen: NDArray[np.bool_]  # (frame, point), points that were there
    # (frame,) [m], root of the mean square distance between the points and those of the body
    residual_m: NDArray[np.float64]


def fitted_pose(body: NDArray[np.float64], observed: NDArray[np.float64]) -> RigidFit:
    """Pose that brings a rigid body nearest to the observed points.

    body (point, 3) [m]: points in the frame of the segment
    observed (frame, point, 3) [m]: the same points in the laboratory; NaN where they are not seen
    Source: Söderkvist & Wedin 1993, J Biomech 26:1473 (singular values; a mirrored solution is never taken).

    >>> body = np.array([[0, 0, 0], [0.1, 0, 0], [0, 0.2, 0], [0, 0, 0.1]])
    >>> fitted_pose(body, body[None] + 1.0).pose.origin.round(9)
    array([[1., 1., 1.]])
    """
    seen = np.asarray(np.isfinite(observed).all(axis=2))
    weight = seen / np.maximum(seen.sum(axis=1, keepdims=True), 1)
    places = np.where(seen[..., None], observed, 0.0)
    middle_body = weight @ body
    middle = np.einsum("fp,fpi->fi", weight, places)
    from_body = (body - middle_body[:, None]) * seen[..., None]
    from_places = (places - middle[:, None]) * seen[..., None]
    left, _, right = np.linalg.svd(np.einsum("fpi,fpj->fij", from_places, from_body))
    turn = np.ones((len(observed), 3))
    turn[:, 2] = np.sign(np.linalg.det(left @ right))
    rotation = (left * turn[:, None]) @ right
    origin = middle - np.einsum("fij,fj->fi", rotation, middle_body)
    apart = from_places - np.einsum("fij,fpj->fpi", rotation, from_body)
    residual = np.sqrt((apart**2).sum(axis=(1, 2)) / np.maximum(seen.sum(axis=1), 1))
    unknown = ~_determined(body, seen)
    rotation[unknown], origin[unknown], residual[unknown] = np.nan, np.nan, np.nan
    return RigidFit(Pose(origin, rotation), seen, residual)


def residual_m(pose: Pose, body: NDArray[np.float64], observed: NDArray[np.float64]) -> NDArray[np.float64]:
    """Root mean square distance of observed points from those of a body in a pose, frame by frame [m].

    body (point, 3) [m]: points in the frame of the segment
    observed (frame, point, 3) [m]: the same points in the laboratory; NaN where they are not seen
    """
    apart = ((observed - pose.to_laboratory(body)) ** 2).sum(axis=2)
    seen = np.isfinite(apart)
    mean = np.where(seen, apart, 0.0).sum(axis=1) / np.maximum(seen.sum(axis=1), 1)
    return np.where(seen.any(axis=1), np.sqrt(mean), np.nan)


def _determined(body: NDArray[np.float64], seen: NDArray[np.bool_]) -> NDArray[np.bool_]:
    """Frames whose points that are seen show a turn about every axis; each pattern of missing points once."""
    patterns, which = np.unique(seen, axis=0, return_inverse=True)
    enough = [
        pattern.sum() >= FEWEST_POINTS
        and np.linalg.svd(body[pattern] - body[pattern].mean(axis=0), compute_uv=False)[1] >= LEAST_BREADTH_M
        for pattern in patterns
    ]
    return np.asarray(enough, bool)[which.ravel()]
