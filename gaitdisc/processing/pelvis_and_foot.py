"""Pelvis and foot progression of a model's own angles under the vocabulary's names, each with the house's sign."""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from gaitdisc.channel import Channel, vocabulary
from gaitdisc.recording import Recording

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
    return replace(
        angles,
        values=np.column_stack([angles.values, angles.values[:, columns] * signs]),
        channels=(*angles.channels, *(channel for channel, _ in taken.values())),
        suspect=None if marks is None else np.column_stack([marks, marks[:, columns]]),
    )
