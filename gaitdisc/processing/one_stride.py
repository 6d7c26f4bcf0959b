"""A periodic simulation gives one stride that closes in itself: it is walked on until contacts can be found in it."""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from gaitdisc.errors import SamplingError, StrideError
from gaitdisc.recording import Finding, Recording, Trial
from gaitdisc.signals.strides import MAX_S, MIN_S

TIMES = 8
LEGS = ("hip", "knee", "ankle")
CLOSES = 0.08  # of an angle's reach: how far apart both ends may lie


def repeated_stride(trial: Trial) -> Trial:
    """Walk that repeats the one stride of a trial, so that contacts are found as in any other walk.

    Only streams on the time base of the kinematics are kept. A last sample that repeats the first is left out.

    trial: with the kinematics of one stride, wherever in the stride it begins

    >>> from gaitdisc.channel import Channel
    >>> t = np.linspace(0.0, 1.0, 101)
    >>> hip = Recording(t, 30 * np.cos(2 * np.pi * t)[:, None], (Channel("hip_flexion_r", "angle", "deg", "r"),))
    >>> round(repeated_stride(Trial("sim", {"kinematics": hip})).stream("kinematics").duration_s, 2)
    8.0
    """
    kinematics = trial.stream("kinematics")
    count = _period(kinematics, trial.name)
    kept = {
        key: _repeated(recording, count)
        for key, recording in trial.streams.items()
        if len(recording.time) == len(kinematics.time) and np.allclose(recording.time, kinematics.time, atol=1e-6)
    }
    left = sorted(set(trial.streams) - set(kept))
    what = f"one stride of {count / kinematics.rate_hz:.3f} s that closes in itself, walked {TIMES} times"
    if left:
        what += f"; {', '.join(left)} left out: on another time base"
    spread = "a spread of its own: it is taken as a curve"
    note = Finding("note", "one stride", kinematics.source.file or trial.name, what, spread)
    return replace(trial, streams=kept, events=(), findings=(*trial.findings, note))


def _period(kinematics: Recording, name: str) -> int:
    """Samples of the stride: all of them, or one less where the last repeats the first."""
    angles = kinematics.selected_by(lambda channel: channel.quantity == "angle" and channel.name.startswith(LEGS))
    needed = f"one stride of a periodic simulation lasts {MIN_S:g} to {MAX_S:g} s and ends where it began"
    if not MIN_S <= kinematics.duration_s <= MAX_S or len(kinematics.time) < 8:
        found = f"{name} lasts {kinematics.duration_s:.2f} s in {len(kinematics.time)} samples"
        raise StrideError(needed, found, "Give one whole stride, or a walk of several.")
    x = angles.values
    reach = np.ptp(x, axis=0)
    moving = np.isfinite(reach) & (reach > 1.0)
    if not moving.any():
        raise StrideError(needed, f"{name} has no angle of the legs that moves", "Give joint angles in deg or rad.")
    apart = np.abs(x[-1] - x[0])[moving] / reach[moving]
    if np.median(apart) > CLOSES:
        worst = int(np.flatnonzero(moving)[np.argmax(apart)])
        found = f"in {name} {angles.names[worst]} ends {abs(x[-1, worst] - x[0, worst]):.1f} deg from where it began"
        raise StrideError(needed, found, "Give a whole stride (two steps), or a walk of several.")
    step = np.abs(np.diff(x, axis=0)).mean(axis=0)[moving] / reach[moving]
    beside = np.abs(x[1] - x[-1])[moving] / reach[moving]
    closing = np.median(apart) < 0.25 * np.median(step) and np.median(beside) > np.median(apart)
    return len(x) - 1 if closing else len(x)


def _repeated(recording: Recording, count: int) -> Recording:
    if len(recording.time) < count:
        raise SamplingError("a stride to repeat needs all its samples", f"found {len(recording.time)}", "Export again.")
    time = recording.time[0] + np.arange(TIMES * count) / recording.rate_hz
    assert recording.suspect is not None  # set by Recording
    return replace(
        recording,
        time=time,
        values=np.tile(recording.values[:count], (TIMES, 1)),
        suspect=np.tile(recording.suspect[:count], (TIMES, 1)),
    )
