"""Plateaus of a joint angle at a limit of the model: flat where a joint would turn, so that accelerations are false."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from gaitdisc.recording import Finding, Recording
from gaitdisc.recording.runs import runs, spans_s

BAND_SHARE = 0.01  # of the angle's reach: how near the limit counts as on it
DWELL_TIMES = 2.0  # what a sine of the same reach stays in the band
SPREAD_SHARE = 0.006  # of the reach: how much the turning points of a free joint differ at least
CORNER = 0.6  # of the time within 4 % of the reach, spent within 1 %: a parabola has 0.5, a peak with a shoulder less
SHORTEST_S = 0.05
FEWEST = 3
BESIDE_S = 0.05
FEWEST_REACH_DEG = 2.0
NO_MODEL = "ezc3d"  # reader of files whose angles come from segments, not from a model's coordinates


@dataclass(frozen=True, eq=False)
class Plateau:
    """A limit at which one angle stops."""

    channel: str
    limit: float  # value at the plateau [deg]
    marks: NDArray[np.bool_]  # (time,), samples on it


def plateaus(kinematics: Recording) -> list[Plateau]:
    """Find the limits at which joint angles stop, from the angles themselves.

    A joint that turns freely turns at another angle in every stride and dwells near it for a moment only: within 1 % of
    its reach a sine stays 6 % of the time. An angle is at a limit where its dwells near its largest or smallest value
    (1) come three times or more, (2) last 0.05 s or longer, twice the sine's share of the time in all, (3) end at
    values that differ by less than 0.6 % of the reach (robust standard deviation), where free joints differ by more,
    and (4) begin and end at a corner: of the time within 4 % of the reach, 60 % or more is spent within 1 %. The hips
    of treadmill_walk_ik, whose model's limit is soft, have 74 to 88 % there, knees at their limit 70 to 74 %, ordinary
    peaks of C3D files that pass (1) to (3) 11 to 28 %. Angles of a C3D file come from no model with limits: none is
    looked for.

    kinematics: joint angles [deg], not filtered or filtered
    returns: one a channel and limit; constant channels have none

    >>> from gaitdisc.channel import Channel
    >>> t, rng = np.arange(2000) / 100, np.random.default_rng(0)
    >>> hip = 30 * np.cos(2 * np.pi * t) * (1 + 0.03 * np.repeat(rng.normal(size=20), 100))
    >>> x = np.column_stack([hip, np.maximum(hip, -20)])
    >>> names = (Channel("hip_flexion_r", "angle", "deg", "r"), Channel("hip_flexion_l", "angle", "deg", "l"))
    >>> [(p.channel, round(p.limit, 1)) for p in plateaus(Recording(t, x, names))]
    [('hip_flexion_l', -20.0)]
    """
    if kinematics.source.reader.startswith(NO_MODEL):
        return []
    found = []
    for column, channel in enumerate(kinematics.channels):
        if channel.quantity != "angle":
            continue
        x = kinematics.values[:, column]
        known = x[np.isfinite(x)]
        if len(known) < 10 or np.subtract(*np.percentile(known, [99, 1])) < FEWEST_REACH_DEG:
            continue
        for sign in (-1.0, 1.0):
            marks = _dwells(sign * x, kinematics.rate_hz)
            if marks is not None:
                found.append(Plateau(channel.name, float(np.median(x[marks])), marks))
    return found


def plateau_findings(kinematics: Recording) -> list[Finding]:
    """Say which angles stop at a limit of the model, where, and for how much of the time.

    kinematics: joint angles [deg]
    """
    return [
        Finding(
            "warning",
            "plateau",
            kinematics.source.file,
            f"stops at {plateau.limit:.1f} deg in {len(runs(plateau.marks))} places, "
            f"{100 * plateau.marks.mean():.0f} % of the samples",
            "velocity and acceleration there; widen the range of the coordinate in the model and repeat the inverse "
            "kinematics",
            plateau.channel,
            spans_s(kinematics.time, plateau.marks),
        )
        for plateau in plateaus(kinematics)
    ]


def plateau_marked(kinematics: Recording) -> Recording:
    """Mark what lies on a plateau, or within 0.05 s of one, as suspect.

    kinematics: joint angles [deg]; mark before filtering, so that the limits are still sharp
    """
    marks = np.zeros(kinematics.values.shape, bool)
    beside = round(BESIDE_S * kinematics.rate_hz)
    for plateau in plateaus(kinematics):
        column = kinematics.index(plateau.channel)
        for start, end in runs(plateau.marks):
            marks[max(0, start - beside) : end + beside, column] = True
    return kinematics.with_values(kinematics.values, marks)


def _dwells(x: NDArray[np.float64], rate_hz: float) -> NDArray[np.bool_] | None:
    """Samples on a plateau at the top of x, or None."""
    known = x[np.isfinite(x)]
    reach = float(known.max() - np.percentile(known, 1))
    top = float(np.percentile(known, 99.5))
    near = np.isfinite(x) & (x >= top - BAND_SHARE * reach)
    spans = [(a, b) for a, b in runs(near) if (b - a) / rate_hz >= SHORTEST_S]
    if len(spans) < FEWEST:
        return None
    marks = np.zeros(len(x), bool)
    for start, end in spans:
        marks[start:end] = True
    highest = np.array([x[start:end].max() for start, end in spans])
    spread = 1.4826 * float(np.median(np.abs(highest - np.median(highest))))
    sine = 2 / np.pi * float(np.arcsin(np.sqrt(BAND_SHARE)))
    if marks.mean() < DWELL_TIMES * sine or spread > SPREAD_SHARE * reach:
        return None
    corners = [_corner(x, start + int(np.argmax(x[start:end])), reach) for start, end in spans]
    return marks if np.median(corners) >= CORNER else None


def _corner(x: NDArray[np.float64], top: int, reach: float) -> float:
    """Samples in a row about a peak within 1 % of the reach, over those within 4 %."""
    wide = []
    for share in (BAND_SHARE, 4 * BAND_SHARE):
        below = np.flatnonzero(~(x >= x[top] - share * reach))
        at = int(np.searchsorted(below, top))
        first = below[at - 1] if at else -1
        last = below[at] if at < len(below) else len(x)
        wide.append(last - first - 1)
    return wide[0] / wide[1]
