"""Angles between two segments as a clinician names them: flexion, adduction, rotation."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray


def clinical_angles(proximal: NDArray[np.float64], distal: NDArray[np.float64]) -> NDArray[np.float64]:
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


def rotation_of(angles_deg: NDArray[np.float64]) -> NDArray[np.float64]:
    """Rotation of the distal segment in the proximal one; what `clinical_angles` takes apart.

    angles_deg (frame, 3) [deg]: flexion, adduction, rotation, with the signs of a right limb
    returns (frame, 3, 3)

    >>> angles = np.array([[30.0, -5.0, 8.0]])
    >>> clinical_angles(np.eye(3)[None], rotation_of(angles)).round(9).tolist()
    [[30.0, -5.0, 8.0]]
    """
    (cz, cx, cy), (sz, sx, sy) = np.cos(np.radians(angles_deg)).T, np.sin(np.radians(angles_deg)).T
    rows = [
        [cz * cy - sz * sx * sy, -sz * cx, cz * sy + sz * sx * cy],
        [sz * cy + cz * sx * sy, cz * cx, sz * sy - cz * sx * cy],
        [-cx * sy, sx, cx * cy],
    ]
    return np.moveaxis(np.array(rows), 2, 0)
