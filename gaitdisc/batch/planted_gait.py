"""Gait that is planted into a measured walk of the embedded cohort, for demonstrations and tests of the rules."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace

import numpy as np
from numpy.typing import NDArray
from scipy.ndimage import gaussian_filter1d

from gaitdisc.errors import SchemaError
from gaitdisc.recording import Trial

STIFF_ABOVE_DEG, STIFF_SHARE = 20.0, 0.5  # what the knee bends beyond this is halved: some 20 deg less in swing
DROP_DEG, DROP_SMOOTH_S = 15.0, 0.03  # by which the foot hangs while it is off the ground
LIFTED_N = 20.0


def stiff_knee(trial: Trial, side: str) -> Trial:
    """Same walk, the knee of one side bending less in swing."""
    knee = f"knee_angle_{side}"

    def bent(angle: NDArray[np.float64]) -> NDArray[np.float64]:
        return np.minimum(angle, STIFF_ABOVE_DEG + STIFF_SHARE * (angle - STIFF_ABOVE_DEG))

    return _with_angle(trial, knee, bent)


def drop_foot(trial: Trial, side: str) -> Trial:
    """Same walk, the foot of one side hanging while it is off the ground."""
    forces, kinematics = trial.stream("forces"), trial.stream("kinematics")
    lifted = (forces[f"ground_force_{side}_vy"] < LIFTED_N).astype(float)
    hanging = gaussian_filter1d(lifted, DROP_SMOOTH_S * forces.rate_hz)
    lowered = DROP_DEG * np.interp(kinematics.time, forces.time, hanging)
    return _with_angle(trial, f"ankle_angle_{side}", lambda angle: angle - lowered)


PLANTED: dict[str, Callable[[Trial, str], Trial]] = {"stiff knee": stiff_knee, "drop foot": drop_foot}
FOUND_AS = {"stiff knee": "knee flexion in swing", "drop foot": "dorsiflexion in swing"}  # rule that must speak


def planted(trial: Trial, what: str, side: str) -> Trial:
    """Walk with gait planted: `stiff knee`, `drop foot`; as it is for an empty word."""
    if not what:
        return trial
    if what not in PLANTED:
        raise SchemaError(f"what is planted is one of: {', '.join(PLANTED)}", f"found {what!r}", "Use one of these.")
    return PLANTED[what](trial, side)


def _with_angle(trial: Trial, name: str, change: Callable[[NDArray[np.float64]], NDArray[np.float64]]) -> Trial:
    kinematics = trial.stream("kinematics")
    values = np.array(kinematics.values)
    values[:, kinematics.index(name)] = change(kinematics[name])
    return replace(trial, streams={**trial.streams, "kinematics": kinematics.with_values(values)})
