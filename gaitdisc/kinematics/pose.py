"""Where a segment is and how it is turned, laid over its markers or as angles; joint centres from landmarks."""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from gaitdisc.errors import ShapeError
from gaitdisc.recording.arrays import Values, freeze

PARTS = ("pelvis", "thigh", "shank", "foot")
SEGMENTS = ("pelvis", "thigh_l", "thigh_r", "shank_l", "shank_r", "foot_l", "foot_r")
SEGMENTS_OF = {"hip": ("pelvis", "thigh"), "knee": ("thigh", "shank"), "ankle": ("shank", "foot")}
JOINT_CHANNELS = {  # names, and the sign of flexion about the axis to the right
    "hip": (("hip_flexion", "hip_adduction", "hip_rotation"), 1),
    "knee": (("knee_angle", "knee_adduction", "knee_rotation"), -1),
    "ankle": (("ankle_angle", "ankle_inversion", "ankle_rotation"), 1),
}
NOT_A_ROTATION = 1e-6  # largest difference of R^T R from the identity, and of det R from 1
FEWEST_POINTS = 3
LEAST_BREADTH_M = 0.01  # second largest extent of the points that are seen: on a line no turn about it is known
_MM = 1e-3


@dataclass(frozen=True, eq=False)
class Pose:
    """Origin and axes of one segment in the laboratory's frame.

    >>> Pose(np.zeros((2, 3)), np.tile(np.eye(3), (2, 1, 1))).known
    array([ True,  True])
    """

    # (frame, 3) [m], the segment's origin in the laboratory's frame; NaN where it is unknown
    origin: Values
    # (frame, 3, 3), columns are the segment's axes in the laboratory's frame: x forward, y up, z to the right of the
    # person; NaN where unknown. `rotation @ v` turns a vector of the segment into the laboratory's frame
    rotation: Values

    def __post_init__(self) -> None:
        freeze(self, "origin", "rotation")
        origin, rotation = self.origin, self.rotation
        if origin.ndim != 2 or origin.shape[1] != 3 or rotation.shape != (len(origin), 3, 3):
            raise ShapeError(
                "a pose must have an origin of shape (frame, 3) and a rotation of shape (frame, 3, 3)",
                f"their shapes are {origin.shape} and {rotation.shape}",
                "Put frames first. The columns of a rotation are the segment's axes.",
            )
        known = np.isfinite(rotation).all(axis=(1, 2))
        some = rotation[known]
        stretch = np.abs(np.swapaxes(some, 1, 2) @ some - np.eye(3)).max(axis=(1, 2), initial=0.0)
        wrong = (stretch > NOT_A_ROTATION) | (np.abs(np.linalg.det(some) - 1) > NOT_A_ROTATION)
        if wrong.any():
            first = int(np.flatnonzero(wrong)[0])
            raise ShapeError(
                "the axes of a pose must have length 1, be perpendicular and be right-handed",
                f"frame {int(np.flatnonzero(known)[first])} has determinant {np.linalg.det(some[first]):.6g}, and its "
                f"axes deviate from right angles and length 1 by up to {stretch[first]:.3g}",
                "Give the columns as x forward, y up, z to the right of the person.",
            )

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

    def to_laboratory(self, points: Values) -> Values:
        """Points of the segment, (point, 3) or (3,) [m], in the laboratory, (frame, point, 3) or (frame, 3) [m].

        >>> Pose(np.ones((1, 3)), np.eye(3)[None]).to_laboratory(np.array([0.0, 1.0, 0.0]))
        array([[1., 2., 1.]])
        """
        points = np.asarray(points, float)
        if points.ndim == 1:
            return self.origin + self.rotation @ points
        return self.origin[:, None] + np.einsum("fij,pj->fpi", self.rotation, points)

    def to_segment(self, points: Values) -> Values:
        """Points of the laboratory, (frame, point, 3) or (frame, 3) [m], in the segment's frame.

        >>> Pose(np.ones((1, 3)), np.eye(3)[None]).to_segment(np.array([[1.0, 2.0, 1.0]]))
        array([[0., 1., 0.]])
        """
        points = np.asarray(points, float)
        if points.ndim == 2:
            return np.einsum("fji,fj->fi", self.rotation, points - self.origin)
        return np.einsum("fji,fpj->fpi", self.rotation, points - self.origin[:, None])


@dataclass(frozen=True, eq=False)
class RigidFit:
    """Pose of a body and how well its markers keep their shape."""

    pose: Pose  # NaN in frames with fewer than three points, or points on a line
    # (frame,) [m], root of the mean square distance between the points and those of the body, on a line too
    residual_m: Values


def fit_pose(body: Values, observed: Values) -> RigidFit:
    """Pose that brings a rigid body nearest to the observed points.

    body (point, 3) [m]: points in the frame of the segment
    observed (frame, point, 3) [m]: the same points in the laboratory; NaN where they are not seen
    Source: Söderkvist & Wedin 1993, J Biomech 26:1473 (singular values; a mirrored solution is never taken).

    >>> body = np.array([[0, 0, 0], [0.1, 0, 0], [0, 0.2, 0], [0, 0, 0.1]])
    >>> fit_pose(body, body[None] + 1.0).pose.origin.round(9)
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
    # frames whose points show a turn about every axis; each pattern of missing points once
    patterns, which = np.unique(seen, axis=0, return_inverse=True)
    enough = [
        pattern.sum() >= FEWEST_POINTS
        and np.linalg.svd(body[pattern] - body[pattern].mean(axis=0), compute_uv=False)[1] >= LEAST_BREADTH_M
        for pattern in patterns
    ]
    unknown = ~np.asarray(enough, bool)[which.ravel()]
    rotation[unknown], origin[unknown] = np.nan, np.nan
    residual[seen.sum(axis=1) < FEWEST_POINTS] = np.nan
    return RigidFit(Pose(origin, rotation), residual)


def residual_m(pose: Pose, body: Values, observed: Values) -> Values:
    """Root mean square distance [m] by frame of observed (frame, point, 3) from body points (point, 3) in a pose."""
    apart = ((observed - pose.to_laboratory(body)) ** 2).sum(axis=2)
    seen = np.isfinite(apart)
    mean = np.where(seen, apart, 0.0).sum(axis=1) / np.maximum(seen.sum(axis=1), 1)
    return np.where(seen.any(axis=1), np.sqrt(mean), np.nan)


def clinical_angles(proximal: Values, distal: Values) -> Values:
    """Flexion about the proximal z, adduction about the floating axis, rotation about the distal y, in degrees.

    Signs are those of a right limb that turns to the front (positive about z), to the body's midline (about x) and
    inwards (about y). The floating axis is at right angles to both others, so that no order is chosen; the numbers are
    those of the Cardan sequence z, x, y, and OpenSim's.

    proximal, distal (frame, 3, 3): axes of the segments in the laboratory's frame, as columns: x forward, y up, z to
        the right
    returns (frame, 3) [deg]: each in [-180, 180], adduction in [-90, 90]; NaN where a segment is unknown
    Source: Grood & Suntay 1983, J Biomech Eng 105:136; Wu 2002, J Biomech 35:543.

    >>> quarter = np.array([[[0.0, -1, 0], [1, 0, 0], [0, 0, 1]]])
    >>> clinical_angles(np.eye(3)[None], quarter).tolist()
    [[90.0, 0.0, 0.0]]
    """
    turned = np.swapaxes(proximal, 1, 2) @ distal
    flexion = np.arctan2(-turned[:, 0, 1], turned[:, 1, 1])
    adduction = np.arctan2(turned[:, 2, 1], np.hypot(turned[:, 0, 1], turned[:, 1, 1]))
    rotation = np.arctan2(-turned[:, 2, 0], turned[:, 2, 2])
    return np.degrees(np.stack([flexion, adduction, rotation], axis=1)) + 0.0


def angle_signs(joint: str, side: str) -> Values:
    """Signs (3,) by which `clinical_angles` of a joint become those of its channels, on side `r` or `l`."""
    _, flexion = JOINT_CHANNELS[joint]
    return np.array([flexion, 1.0, 1.0] if side == "r" else [flexion, -1.0, -1.0])


def harrington_hip(width_m: float, depth_m: float, side: str) -> Values:
    """Hip centre in the pelvis' frame from mid-ASIS [m], of width and depth [m]; Harrington 2007, J Biomech 40:595.

    >>> harrington_hip(0.240, 0.150, "r").round(4).tolist()
    [-0.0459, -0.0829, 0.0865]
    """
    lateral = 0.33 * width_m + 7.3 * _MM
    return np.array([-0.24 * depth_m - 9.9 * _MM, -0.30 * width_m - 10.9 * _MM, lateral if side == "r" else -lateral])


def hip_of_spines(left: Values, right: Values, sacrum: Values, side: str) -> Values:
    """Harrington's hip centre of each frame, from spines and sacrum (frame, 3) [m]; width and depth are medians.

    >>> spine, back = np.array([[0.0, 0.0, 0.12]]), np.array([[-0.15, 0.0, 0.0]])
    >>> hip_of_spines(-spine, spine, back, "r").round(4).tolist()
    [[-0.0459, -0.0829, 0.0865]]
    """
    middle, across = (left + right) / 2, right - left
    upward = np.cross(across, middle - sacrum)
    width, depth = (float(np.nanmedian(np.linalg.norm(vector, axis=1))) for vector in (across, middle - sacrum))
    axes = [np.cross(upward, across), upward, across]
    units = np.stack([axis / np.linalg.norm(axis, axis=1, keepdims=True) for axis in axes], axis=2)
    return np.asarray(middle + units @ harrington_hip(width, depth, side), np.float64)


def davis_hip(width_m: float, mean_leg_m: float, leg_m: float, marker_radius_m: float, side: str) -> Values:
    """Hip centre of Plug-in Gait in the pelvis' frame from mid-ASIS [m], of pelvis width and leg lengths [m].

    mean_leg_m: of both legs
    leg_m: of the leg itself, from which the distance from spine to trochanter is estimated
    Source: Davis 1991, Hum Mov Sci 10:575; Kadaba 1990: theta = 28.4 deg and beta = 18 deg, as 0.5 and 0.314 rad.
    """
    c = 0.115 * mean_leg_m - 15.3 * _MM
    to_trochanter = 0.1288 * leg_m - 48.56 * _MM
    theta, beta = 0.5, 0.314
    depth = to_trochanter + marker_radius_m
    forward = c * math.cos(theta) * math.sin(beta) - depth * math.cos(beta)
    upward = -c * math.cos(theta) * math.cos(beta) - depth * math.sin(beta)
    lateral = width_m / 2 - c * math.sin(theta)
    return np.array([forward, upward, lateral if side == "r" else -lateral])


def chord_centre(proximal: Values, wand: Values, lateral: Values, distance_m: float) -> Values:
    """Joint centre in the plane of three points, at a distance from the lateral one and at a right angle there.

    The line from the centre to the proximal joint and the line from the centre to the lateral marker are at right
    angles; of the two such points the one away from the wand is taken.

    proximal (3,) [m]: joint centre above
    wand, lateral (3,) [m]: markers that show the plane, and over the lateral condyle or malleolus
    distance_m: half the width of the joint and the radius of the marker [m]
    Source: Davis 1991, Hum Mov Sci 10:575; Plug-in Gait calls it CHORD.

    >>> centre = chord_centre(np.array([0, 1.0, 0]), np.array([0, 0.5, 0.2]), np.array([0, 0, 0.05]), 0.05)
    >>> centre.round(6).tolist()
    [0.0, 0.0, 0.0]
    """
    along = lateral - proximal
    length = float(np.linalg.norm(along))
    normal = np.cross(wand - proximal, along)
    area = float(np.linalg.norm(normal))
    if not length > distance_m or not area > 1e-4 * length**2:
        raise ShapeError(
            "for a joint centre from one lateral marker, this marker must lie farther from the proximal joint than "
            "half the joint's width, and the wand marker must lie off the line between them",
            f"the marker is {length:.4g} m from the proximal joint, half the width is {distance_m:.4g} m, and the "
            f"wand marker is {area / max(length, 1e-09):.4g} m off the line",
            "Check the markers of the static trial and the width.",
        )
    along = along / length
    across = np.cross(normal / area, along)
    away = -across if (wand - proximal) @ across > 0 else across
    cosine = distance_m / length
    return lateral - along * distance_m * cosine + away * distance_m * math.sqrt(1 - cosine**2)
