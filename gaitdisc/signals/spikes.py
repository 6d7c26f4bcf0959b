"""Spikes: a sample or a few, far from what lies around them, that no body did; they are gaps, not measurements."""

from __future__ import annotations

import numpy as np
from numpy.lib.stride_tricks import sliding_window_view
from numpy.typing import NDArray

from gaitdisc.recording import Finding, Recording
from gaitdisc.recording.arrays import runs, spans_s
from gaitdisc.recording.wrapping import unwrapped

HALF_S = 0.03  # of the window of the running median: spikes of up to three samples at 100 Hz
MAD_TIMES = 8.0  # of the robust standard deviation of the differences from sample to sample
LEAP_TIMES = 4.0  # of the step that one sample in a hundred exceeds: on the way in and on the way out
LEAST = {"deg": 1.0, "rad": 0.02, "m": 0.01}
LEAST_SHARE = 0.05  # of the channel's range, 1st to 99th percentile
QUANTITIES = ("angle", "translation", "marker")  # forces, moments and EMG do rise from one sample to the next
FEWEST_SAMPLES = 20


def spikes(recording: Recording) -> NDArray[np.bool_]:
    """Mark samples far from the running median of their channel, (time, channel).

    Far means eight robust standard deviations of the differences between neighbours, and 5 % of the channel's range (1
    deg or 1 cm at least); and the channel leaps there and back, each by four times the step that one sample in a
    hundred exceeds: a stumble is fast too, but has samples on its way. Within 0.03 s of an end or of a gap nothing is
    tested. A heading is looked at as it goes on.

    Source: Hampel 1974, J. Am. Stat. Assoc. 69, 383; Pearson 2002, IEEE Trans. Control Syst. Technol. 10, 55. Differs:
        the scale is that of the whole channel, not of the window, for a smooth channel has none in a window.

    >>> from gaitdisc.channel import Channel
    >>> x = 30 * np.sin(np.arange(500) / 15)
    >>> x[200] += 15
    >>> knee = Channel("knee_angle_r", "angle", "deg", "r")
    >>> np.flatnonzero(spikes(Recording(np.arange(500) / 100, x[:, None], (knee,)))).tolist()
    [200]
    """
    marks = np.zeros(recording.values.shape, bool)
    plain = unwrapped(recording)
    half = max(2, round(HALF_S * recording.rate_hz))
    for column, channel in enumerate(recording.channels):
        x = np.where(np.isfinite(plain.values[:, column]), plain.values[:, column], np.nan)
        known = np.isfinite(x)
        if channel.quantity in QUANTITIES and known.sum() >= FEWEST_SAMPLES:
            steps = np.diff(x)
            size = np.abs(steps[np.isfinite(steps)])
            least = max(
                LEAST_SHARE * float(np.subtract(*np.percentile(x[known], [99, 1]))), LEAST.get(channel.unit, 0.0)
            )
            spread = 1.4826 * float(np.median(np.abs(size - np.median(size)))) if len(size) else 0.0
            far = np.abs(x - _running_median(x, half)) > max(MAD_TIMES * spread, least)
            leap = max(LEAP_TIMES * float(np.percentile(size, 99)), least) if len(size) else np.inf
            for start, end in runs(far):
                there, back = steps[start - 1], steps[end - 1]
                if end - start <= half and there * back < 0 and min(abs(there), abs(back)) > leap:
                    marks[start:end, column] = True
    return marks


def without_spikes(recording: Recording) -> Recording:
    """Recording in which spikes are gaps: bridged and marked suspect where short (`filled`), else left out."""
    marks = spikes(recording)
    return recording.with_values(np.where(marks, np.nan, recording.values)) if marks.any() else recording


def spike_findings(recording: Recording) -> list[Finding]:
    """Say which channels have spikes, how large and where."""
    marks = spikes(recording)
    findings = []
    for column in np.flatnonzero(marks.any(axis=0)):
        channel, here = recording.channels[column], marks[:, column]
        x = recording.values[:, column]
        rest = np.where(here | ~np.isfinite(x), np.nan, x)
        low, high = np.nanpercentile(rest, [1, 99])
        outside = np.where(here, np.abs(x - (low + high) / 2), 0.0)
        at = int(np.argmax(outside))
        places, known = len(runs(here)), np.flatnonzero(np.isfinite(rest))
        beside = rest[known[np.abs(known - at).argmin()]]
        findings.append(
            Finding(
                "warning",
                "spike",
                recording.source.file,
                f"{x[at]:.4g} {channel.unit} at {recording.time[at]:.2f} s (frame {at + 1}) beside "
                f"{beside:.4g} {channel.unit}; {places} place{'s' if places > 1 else ''} in all",
                "nothing: taken out before the filter, bridged where short, and marked",
                channel.name,
                spans_s(recording.time, here),
            )
        )
    return findings


def _running_median(x: NDArray[np.float64], half: int) -> NDArray[np.float64]:
    """Median over a window about each sample; NaN where the window is not whole."""
    middle = np.full(len(x), np.nan)
    if len(x) > 2 * half:
        middle[half : len(x) - half] = np.median(sliding_window_view(x, 2 * half + 1), axis=1)
    return middle
