"""Pelvis and foot progression of a model's own angles under the vocabulary's names, each with the house's sign."""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from gaitdisc.channel import Channel, vocabulary
from gaitdisc.kinematics.laboratory import PATH_S, STRAIGHT_DEG
from gaitdisc.kinematics.pose import clinical_angles, rotation_of
from gaitdisc.recording import Recording
from gaitdisc.recording.wrapping import unwrapped

# Plug-in Gait: tilt positive forwards, obliquity positive with the named side up, rotation with it forwards.
PLUG_IN_GAIT = {
    "pelvis_tilt": ("RPelvisAngles.x", -1.0),
    "pelvis_list": ("LPelvisAngles.y", 1.0),
    "pelvis_rotation": ("RPelvisAngles.z", 1.0),
    "foot_progression_angle_r": ("RFootProgressAngles.z", 1.0),
    "foot_progression_angle_l": ("LFootProgressAngles.z", 1.0),
}


def with_pelvis_and_foot(angles: Recording) -> Recording:
    """Same angles, and those of the pelvis and of foot progression that stand under Plug-in Gait's labels alone."""
    taken: dict[int, tuple[Channel, float]] = {}
    for name, (label, sign) in PLUG_IN_GAIT.items():
        channel = vocabulary().named(name)
        if channel is None or name in angles.names or label not in angles.names:
            continue
        column = angles.names.index(label)
        if (angles.channels[column].quantity, angles.channels[column].unit) == (channel.quantity, channel.unit):
            taken[column] = (channel, sign)
    if not taken:
        return angles
    columns, signs = list(taken), np.array([sign for _, sign in taken.values()])
    marks = angles.suspect
    own = [channel for channel, _ in taken.values()]
    new = replace(angles, values=angles.values[:, columns] * signs, channels=tuple(own), suspect=None)
    return replace(
        angles,
        values=np.column_stack([angles.values, _from_own_heading(new).values]),
        channels=(*angles.channels, *own),
        suspect=None if marks is None else np.column_stack([marks, marks[:, columns]]),
    )


def _from_own_heading(angles: Recording) -> Recording:
    """Same angles; of a pelvis that turns in the laboratory tilt and list about its own heading, its mean of a second.

    About an axis of the laboratory, tilt is obliquity once a person has turned by 90 deg. Angles about the line of
    walking are missing then.
    """
    if not {"pelvis_tilt", "pelvis_list", "pelvis_rotation"} <= set(angles.names):
        return angles
    turned = unwrapped(angles)["pelvis_rotation"]
    known, time = np.isfinite(turned), np.arange(len(turned))
    half = max(round(PATH_S * angles.rate_hz / 2), 1)
    padded = np.pad(np.interp(time, time[known], turned[known]) if known.any() else turned, half, mode="edge")
    heading = np.convolve(padded, np.full(2 * half + 1, 1 / (2 * half + 1)), "valid")
    if not np.ptp(heading) >= STRAIGHT_DEG:
        return angles
    level = rotation_of(np.stack([0 * heading, 0 * heading, heading], axis=1))
    lab = rotation_of(np.stack([angles["pelvis_tilt"], angles["pelvis_list"], turned], axis=1))
    values = np.full(angles.values.shape, np.nan)
    values[:, [angles.index("pelvis_tilt"), angles.index("pelvis_list")]] = clinical_angles(level, lab)[:, :2]
    return angles.with_values(values)
