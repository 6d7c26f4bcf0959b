"""Joint centres from landmarks: hip by regression, knee and ankle by midpoints or by one lateral marker and a width."""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from gaitdisc.errors import ShapeError

_MM = 1e-3


def harrington_hip(width_m: float, depth_m: float, side: str) -> NDArray[np.float64]:
    """Hip centre in the pelvis' frame from mid-ASIS [m], of width and depth [m]; Harrington 2007, J Biomech 40:595.

    >>> harrington_hip(0.240, 0.150, "r").round(4).tolist()
    [-0.0459, -0.0829, 0.0865]
    """
    lateral = 0.33 * width_m + 7.3 * _MM
    return np.array([-0.24 * depth_m - 9.9 * _MM, -0.30 * width_m - 10.9 * _MM, lateral if side == "r" else -lateral])


def hip_of_spines(
    left: NDArray[np.float64], right: NDArray[np.float64], sacrum: NDArray[np.float64], side: str
) -> NDArray[np.float64]:
    """Harrington's hip centre of each frame, from spines and sacrum (frame, 3) [m]; width and depth are medians.

    >>> spine, back = np.array([[0.0, 0.0, 0.12]]), np.array([[-0.15, 0.0, 0.0]])
    >>> hip_of_spines(-spine, spine, back, "r").round(4).tolist()
    [[-0.0459, -0.0829, 0.0865]]
    """
    middle, across = (left + right) / 2, right - left
    upward = np.cross(across, middle - sacrum)
    width, depth = (float(np.nanmedian(np.linalg.norm(one, axis=1))) for one in (across, middle - sacrum))
    axes = [np.cross(upward, across), upward, across]
    units = np.stack([one / np.linalg.norm(one, axis=1, keepdims=True) for one in axes], axis=2)
    return np.asarray(middle + units @ harrington_hip(width, depth, side), np.float64)


@dataclass(frozen=True)
class DavisHip:
    """Hip joint centre of Plug-in Gait, from leg length.

    Source: Davis 1991, Hum Mov Sci 10:575; Kadaba 1990: theta = 28.4 deg and beta = 18 deg, as 0.5 and 0.314 rad.
    """

    width_m: float  # distance between the anterior superior iliac spines [m]
    mean_leg_m: float  # mean length of both legs [m]
    leg_m: float  # length of the leg itself [m], from which the distance from spine to trochanter is estimated
    marker_radius_m: float  # of the markers [m]

    def centre(self, side: str) -> NDArray[np.float64]:
        """Hip joint centre in the frame of the pelvis, from mid-ASIS [m]."""
        c = 0.115 * self.mean_leg_m - 15.3 * _MM
        to_trochanter = 0.1288 * self.leg_m - 48.56 * _MM
        theta, beta = 0.5, 0.314
        depth = to_trochanter + self.marker_radius_m
        forward = c * math.cos(theta) * math.sin(beta) - depth * math.cos(beta)
        upward = -c * math.cos(theta) * math.cos(beta) - depth * math.sin(beta)
        lateral = self.width_m / 2 - c * math.sin(theta)
        return np.array([forward, upward, lateral if side == "r" else -lateral])


def chord_centre(
    proximal: NDArray[np.float64], wand: NDArray[np.float64], lateral: NDArray[np.float64], distance_m: float
) -> NDArray[np.float64]:
    """Joint centre in the plane of three points, at a distance from the lateral one and at a right angle there.

    The line from the centre to the proximal joint and the line from the centre to the lateral marker are at right
    angles; of the two such points the one away from the wand is taken.

    proximal (3,) [m]: joint centre above
    wand (3,) [m]: marker that shows the plane, lateral of the segment
    lateral (3,) [m]: marker over the lateral condyle or malleolus
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
            "a joint centre by one lateral marker needs a marker farther from the joint above than half its width, "
            "and a wand beside the line between them",
            f"the marker is {length:.4g} m from the joint above, half the width is {distance_m:.4g} m, "
            f"the wand is {area / max(length, 1e-9):.4g} m beside the line",
            "Check the markers of the static trial and the width.",
        )
    along = along / length
    across = np.cross(normal / area, along)
    away = -across if (wand - proximal) @ across > 0 else across
    cosine = distance_m / length
    return lateral - along * distance_m * cosine + away * distance_m * math.sqrt(1 - cosine**2)
