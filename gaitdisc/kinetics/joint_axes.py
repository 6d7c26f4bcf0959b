"""Axes of a joint between two segments, and the parts of a vector along them with the package's signs.

Axes of Grood & Suntay (1983), as the joint angles have them: the first is the nearer segment's z (to the right of the
person), about which flexion turns; the third is the farther segment's y (along the bone), about which rotation turns;
the second is at right angles to both, forwards. A part is the projection on an axis, so that the parts of a moment
times the rates of their angles are the joint's power, as with the generalised forces of OpenSim.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from gaitdisc.kinematics.pose import Pose

SEGMENTS_OF = {"hip": ("pelvis", "thigh"), "knee": ("thigh", "shank"), "ankle": ("shank", "foot")}


class JointPart(NamedTuple):
    """One of the three parts of a joint moment."""

    joint: str
    angle: str  # angle that a positive part drives, without its side: `knee_angle`
    axis: int  # 0 nearer segment's z, 1 floating, 2 farther segment's y
    right: int  # sign of the positive angle about the axis, for each leg
    left: int  # sign of the positive angle about the axis, for each leg

    def sign(self, side: str) -> int:
        """Sign of the positive angle about the axis."""
        return self.right if side == "r" else self.left


PARTS = (
    JointPart("hip", "hip_flexion", 0, 1, 1),
    JointPart("hip", "hip_adduction", 1, 1, -1),
    JointPart("hip", "hip_rotation", 2, 1, -1),
    JointPart("knee", "knee_angle", 0, -1, -1),
    JointPart("knee", "knee_adduction", 1, 1, -1),
    JointPart("knee", "knee_rotation", 2, 1, -1),
    JointPart("ankle", "ankle_angle", 0, 1, 1),
    JointPart("ankle", "ankle_inversion", 1, 1, -1),
    JointPart("ankle", "ankle_rotation", 2, 1, -1),
)


def joint_axes(nearer: Pose, farther: Pose) -> NDArray[np.float64]:
    """Unit axes of a joint in the laboratory's frame, (frame, axis, 3); NaN where the first and third lie on one line.

    nearer, farther: the segments on the trunk's side of the joint and beyond it
    Source: Grood & Suntay (1983), J. Biomech. Eng. 105, 136-144. Schache & Baker (2007), Gait Posture 25, 440-452,
        compare the frames in which joint moments are given, and recommend these axes.

    >>> straight = Pose(np.zeros((1, 3)), np.eye(3)[None])
    >>> joint_axes(straight, straight)[0].tolist()
    [[0.0, 0.0, 1.0], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0]]
    """
    flexion, rotation = nearer.rotation[:, :, 2], farther.rotation[:, :, 1]
    floating = np.cross(rotation, flexion)
    size = np.linalg.norm(floating, axis=1, keepdims=True)
    floating = floating / np.where(size > 1e-6, size, np.nan)
    return np.stack([flexion, floating, rotation], axis=1)


def along(vector: NDArray[np.float64], axes: NDArray[np.float64], part: JointPart, side: str) -> NDArray[np.float64]:
    """Part of a vector towards the positive angle, (frame,).

    vector (frame, 3): in the laboratory's frame, such as a moment [N m]
    axes (frame, axis, 3): from `joint_axes`
    """
    return part.sign(side) * np.einsum("fx,fx->f", vector, axes[:, part.axis])
