"""Which way a file counts the knee: flexion is positive inside, and a knee that bends the other way is turned."""

from __future__ import annotations

import re
from collections.abc import Mapping
from dataclasses import replace

import numpy as np
from numpy.typing import NDArray

from gaitdisc.recording import Finding, Recording

BENT_DEG = 30.0  # no knee is hyperextended that far, so it was flexed
HYPEREXTENDED_DEG = 25.0  # what a lax knee or an offset of the model may show on the other side
FEWEST = 20  # samples
_KNEE = re.compile(r"knee_angle_[rl](_beta)?")
_MOVES = re.compile(r"(knee_angle_[rl](?:_beta)?)(/speed|/accel|_moment|_force)")
_GENERALISED = ("mot", "sto")  # OpenSim: the moment belongs to the coordinate and has its sign


def with_flexion_positive(streams: Mapping[str, Recording]) -> tuple[dict[str, Recording], list[Finding]]:
    """Streams with knee flexion positive, and what was turned.

    A knee bends to one side only. Where its angle goes beyond 30 deg one way and stays within 25 deg the other way
    (the central 98 % of the samples), the wide side is flexion: where that is the negative one, as in gait2392, the
    channel is turned, and with it its speed, its acceleration and OpenSim's generalised moment of that coordinate. A
    knee that hardly bends follows the other knee of the trial. One that goes beyond both is left and named.

    >>> from gaitdisc.channel import vocabulary
    >>> knee = np.linspace(5, -60, 100)[:, None]
    >>> walk = Recording(np.arange(100) / 100, knee, (vocabulary().named("knee_angle_r"),))
    >>> turned, findings = with_flexion_positive({"kinematics": walk})
    >>> float(turned["kinematics"]["knee_angle_r"].max()), findings[0].kind
    (60.0, 'knee sign')
    """
    kinematics = streams.get("kinematics")
    if kinematics is None:
        return dict(streams), []
    knees = [
        c.name for c in kinematics.channels if _KNEE.fullmatch(c.name) and (c.quantity, c.unit) == ("angle", "deg")
    ]
    reaches = {name: _reach(kinematics[name]) for name in knees}
    senses = {name: _sense(*reach) for name, reach in reaches.items()}
    proven = {sense for sense in senses.values() if sense}
    turned = [name for name, sense in senses.items() if sense == -1 or (sense == 0 and proven == {-1})]
    spans = {name: f"goes from {low:.0f} to {high:.0f} deg" for name, (low, high) in reaches.items()}
    file, findings = kinematics.source.file, []
    for name in (name for name, sense in senses.items() if sense is None):
        what = (
            f"{spans[name]}; a knee bends beyond {HYPEREXTENDED_DEG:g} deg to one side only, so its sign is not known "
            "and it is left as it is"
        )
        spoils = "whatever rests on the knee; correct the file, or leave the damaged part out by crop_s"
        findings.append(Finding("warning", "knee sign", file, what, spoils, name))
    if not turned:
        return dict(streams), findings
    moved = {key: _turned(recording, turned) for key, recording in streams.items()}
    for name in turned:
        others = [c for key in moved for c in moved[key][1] if _of_knee(c) == name and c != name]
        why = (
            ", so flexion is negative in this file" if senses[name] == -1 else " and follows the other knee of the file"
        )
        also = f"; with it {', '.join(others)}" if others else ""
        what = f"{name} {spans[name]}{why}; turned around, flexion is positive here{also}"
        findings.append(Finding("note", "knee sign", file, what, "", name))
    if proven == {1, -1}:
        kept, other = (", ".join(name for name, sense in senses.items() if sense == way) for way in (1, -1))
        what = f"flexion is positive in {kept} and negative in {other} of one file; only the latter was turned"
        findings.append(Finding("warning", "knee sign", file, what, "the knees if this is wrong; correct the file"))
    return {key: recording for key, (recording, _) in moved.items()}, findings


def _reach(values: NDArray[np.float64]) -> tuple[float, float]:
    finite = values[np.isfinite(values)]
    if len(finite) < FEWEST:
        return 0.0, 0.0
    low, high = np.quantile(finite, [0.01, 0.99])
    return float(low), float(high)


def _sense(low: float, high: float) -> int | None:
    """+1 where flexion is positive, -1 where it is negative, 0 where the knee hardly bends, None where it cannot be."""
    if max(-low, high) < BENT_DEG:
        return 0
    if min(-low, high) > HYPEREXTENDED_DEG:
        return None
    return 1 if high > -low else -1


def _of_knee(name: str) -> str:
    found = _MOVES.fullmatch(name)
    return found[1] if found else name


def _turned(recording: Recording, knees: list[str]) -> tuple[Recording, list[str]]:
    signs, names = np.ones(len(recording.channels)), []
    generalised = set(recording.source.reader.split(" + ")) <= set(_GENERALISED)
    for place, channel in enumerate(recording.channels):
        if _of_knee(channel.name) in knees and (channel.quantity != "moment" or generalised):
            signs[place] = -1.0
            names.append(channel.name)
    return (replace(recording, values=recording.values * signs) if names else recording), names
