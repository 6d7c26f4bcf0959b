"""Strides unlike the person's other strides."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
from numpy.typing import NDArray

from gaitdisc.recording import DroppedStride, Finding, Recording, Strides
from gaitdisc.recording.runs import runs

OUTLYING = 3.5  # robust standard deviations of the logarithm of a stride's distance
FEWEST_STRIDES = 8
LONGEST_ACCIDENT = 3  # strides in a row
FEWEST_TIMES = 2.0  # times the usual distance: steady walkers' strides are all alike


def stride_distances(recording: Recording, strides: Strides) -> NDArray[np.float64]:
    """Distance of every stride from the person's median curve, (stride, channel) [channel's unit].

    The root mean square over the stride; the median curve is not moved by the strides that are looked for.

    >>> from gaitdisc.channel import Channel
    >>> t = np.arange(500) / 100
    >>> x = np.sin(2 * np.pi * t) + 3 * ((t > 2) & (t < 3))
    >>> walk = Recording(t, x[:, None], (Channel("knee_angle_r", "angle", "deg", "r"),))
    >>> stride_distances(walk, Strides(np.arange(4.0), np.arange(1.0, 5.0), "r", "force")).ravel().round(1)
    array([0., 0., 3., 0.])
    """
    curves = strides.normalised(recording)
    known: NDArray[np.bool_] = np.asarray(np.isfinite(curves).all(axis=1, keepdims=True))
    whole = np.where(known, curves, np.nan)
    middle = np.zeros((1, *curves.shape[1:]))
    for column in range(curves.shape[2]):
        rows = known[:, 0, column]
        if rows.any():
            middle[0, :, column] = np.median(whole[rows, :, column], axis=0)
    return np.sqrt(np.mean((whole - middle) ** 2, axis=1))


def outlying(recording: Recording, strides: Strides) -> NDArray[np.bool_]:
    """Which strides lie far from the person's median curve, (stride, channel).

    Far means: the logarithm of the distance is 3.5 robust standard deviations above its median, and the distance twice
    the usual one. Steady changes do not count; `late_change` looks for these.
    """
    distance = stride_distances(recording, strides)
    far = np.zeros(distance.shape, bool)
    for column in range(distance.shape[1]):
        d = distance[:, column]
        known = np.isfinite(d) & (d > 0)
        if known.sum() < FEWEST_STRIDES:
            continue
        logs = np.log(d[known])
        middle = float(np.median(logs))
        spread = 1.4826 * float(np.median(np.abs(logs - middle)))
        far[known, column] = (logs > middle + OUTLYING * spread) & (logs > middle + np.log(FEWEST_TIMES))
    return far


def stride_findings(recording: Recording, strides: Strides) -> list[Finding]:
    """Say which strides are unlike the others, channel by channel."""
    far, distance = outlying(recording, strides), stride_distances(recording, strides)
    findings = []
    for column, channel in enumerate(recording.channels):
        rows = np.flatnonzero(far[:, column])
        if not len(rows):
            continue
        worst = rows[np.argmax(distance[rows, column])]
        findings.append(
            Finding(
                "warning",
                "outlying stride",
                recording.source.file,
                f"{len(rows)} of {len(strides)} strides of side {strides.side}, the worst at "
                f"{strides.start[worst]:.2f} s: "
                f"{distance[worst, column]:.3g} {channel.unit} from the median curve, "
                f"{distance[worst, column] / np.nanmedian(distance[:, column]):.1f} times the usual distance",
                "means and models that take these strides for ordinary ones",
                channel.name,
                tuple((float(strides.start[k]), float(strides.end[k])) for k in rows),
            )
        )
    return findings


def without_outlying(recording: Recording, strides: Strides, fewest_channels: int = 1) -> Strides:
    """Strides without those that are unlike the others; each goes to `dropped` with its reason.

    An accident, a stumble say, spoils one to three strides. Four or more in a row are another way of walking: they
    stay, and `late_change` tests them.

    fewest_channels: in how many channels a stride must be outlying to be dropped
    """
    far, distance = outlying(recording, strides), stride_distances(recording, strides)
    out = far.sum(axis=1) >= fewest_channels
    for start, end in runs(out):
        out[start:end] = end - start <= LONGEST_ACCIDENT
    if not out.any():
        return strides
    usual = np.full(distance.shape[1], np.nan)  # also of a channel without one whole stride
    known = np.isfinite(distance).any(axis=0)
    usual[known] = np.nanmedian(distance[:, known], axis=0)
    usual[usual == 0] = np.nan  # a locked coordinate has no usual distance
    dropped = []
    for k in np.flatnonzero(out):
        times = distance[k] / usual
        column = int(np.argmax(np.where(far[k], times, 0.0)))
        more = f" and {far[k].sum() - 1} more channels" if far[k].sum() > 1 else ""
        reason = f"unlike the others: {recording.names[column]}{more} {times[column]:.1f} times the usual distance away"
        dropped.append(DroppedStride(float(strides.start[k]), float(strides.end[k]), reason))
    return replace(strides, start=strides.start[~out], end=strides.end[~out], dropped=(*strides.dropped, *dropped))
