"""Spiked samples: one to three of a channel that leap away from their neighbours and back, found without any model.

They are emptied before anything is fitted. A square error would follow them, and a record with one in a hundred speaks
for whatever moves the simulation towards them.
"""

from dataclasses import replace

import numpy as np
from numpy.lib.stride_tricks import sliding_window_view
from numpy.typing import NDArray

from gaitdisc.discovery.noise import MAD_OF_NORMAL
from gaitdisc.recording import Finding
from gaitdisc.recording.arrays import Values, runs
from gaitdisc.simulation.measured import Measured

KIND = "spike"
LONGEST = 3  # samples
SIGMAS = 8.0  # robust standard deviations of a sample from the middle of its neighbours
OF_STEPS = 4.0  # times the median step around it: what moves fast has samples on its way
AROUND = 8  # samples to either side, whose steps these are
OF_RANGE = 0.05  # of the channel's range in the trial, 1st to 99th percentile
APART = 0.5  # of the leap, by which the samples before and after may differ: a step does not come back
MOST = 0.05  # of a channel's samples in a trial, beyond which such leaps are how it moves
FEWEST = 20  # samples
SHOULDERED = 0.25  # of the leaps, beyond which they are pulses of the motion: a spike has no samples on its way
SHOULDER = 10.0  # robust standard deviations by which the sample before or after one turns towards it, and
OF_LEAP = 0.05  # of the leap
ENDS = 7  # samples of which a line continues the record
LISTED = 3  # trials of a channel that the finding names


def without_spikes(measured: Measured) -> Measured:
    """Return trials whose spiked samples are empty, with a finding for each channel that had any.

    Of a record that was low-passed after it was spiked none is seen: there a spike is as smooth as the motion.
    """
    marks = np.zeros(measured.observed.shape, bool)
    for trial, samples in enumerate(measured.samples):
        for channel in range(len(measured.channels)):
            marks[trial, :samples, channel] = mark_spikes(measured.observed[trial, :samples, channel])
    if not marks.any():
        return measured
    findings = tuple(_finding(measured, marks, channel) for channel in np.flatnonzero(marks.any(axis=(0, 1))).tolist())
    observed = np.where(marks, np.nan, measured.observed)
    return replace(measured, observed=observed, findings=(*measured.findings, *findings))


def mark_spikes(record: Values) -> NDArray[np.bool_]:
    """Mark the samples of a channel that leap away from what lies before and after them, and back.

    An impact turns a position with samples on its way, steps a rate once, and gives a force a pulse with shoulders;
    none of them is marked.

    record (sample,): one channel of a trial; NaN where a cell is empty
    Source: Hampel 1974, J. Am. Stat. Assoc. 69, 383. Differs: the deviation is from the line between the neighbours,
        and a step or a corner of the motion is distinguished by what comes after.

    >>> x = np.sin(np.arange(300) / 15)
    >>> x[[100, 200, 201]] += [3.0, -2.0, -2.5]
    >>> np.flatnonzero(mark_spikes(x)).tolist()
    [100, 200, 201]
    """
    marks = np.zeros(len(record), bool)
    known = np.flatnonzero(np.isfinite(record))
    if len(known) < FEWEST:
        return marks
    x = record[known]  # continued at either end along the median line of its samples there, which no spike moves
    x = np.concatenate([_line(x[:ENDS][::-1])[::-1], x, _line(x[-ENDS:])])
    at = np.concatenate([known[0] - np.arange(LONGEST, 0, -1), known, known[-1] + 1 + np.arange(LONGEST)])
    middle = MAD_OF_NORMAL * float(np.median(np.abs(x[1:-1] - (x[:-2] + x[2:]) / 2)))
    least = max(SIGMAS * middle, OF_RANGE * float(np.subtract(*np.percentile(record[known], [99, 1]))))
    padded = np.pad(np.abs(np.diff(x)), (AROUND, AROUND + 1), mode="reflect")
    steps = np.median(sliding_window_view(padded, 2 * AROUND + 1), axis=1)[: len(x)]
    here, shouldered = np.zeros(len(x), bool), []
    for width in range(1, LONGEST + 1):
        before, after = x[: -width - 1], x[width + 1 :]
        shares = np.arange(1, width + 1) / (width + 1)
        inside = sliding_window_view(x, width)[1 : len(before) + 1]
        leap = np.abs(inside - (before[:, None] * (1 - shares) + after[:, None] * shares)).min(axis=1)
        far = leap > np.maximum(least, OF_STEPS * steps[1 : len(before) + 1])
        back = np.abs(after - before) < APART * leap
        beside = at[width + 1 :] - at[: -width - 1] <= width + LONGEST
        for begin in (np.flatnonzero(far & back & beside) + 1).tolist():
            here[begin : begin + width] = True
            # the sample before or after a leap is on its way there: the record turns towards the leap
            up, least = np.sign(x[begin] - x[begin - 1]), max(SHOULDER * middle, OF_LEAP * leap[begin - 1])
            sides = slice(max(begin - 3, 0), begin), slice(begin + width, begin + width + 3)
            shouldered.append(any(bool((up * np.diff(x[side], 2) > least).any()) for side in sides))
    if here.sum() <= MOST * len(known) and np.sum(shouldered) <= SHOULDERED * len(shouldered):
        marks[known] = here[LONGEST:-LONGEST]
    return marks


def _line(x: Values) -> Values:
    """The samples after some, on their line of median slope (Theil 1950)."""
    later, earlier = np.tril_indices(len(x), -1)
    slope = float(np.median((x[later] - x[earlier]) / (later - earlier)))
    level = float(np.median(x - slope * np.arange(len(x))))
    return np.asarray(level + slope * (len(x) + np.arange(LONGEST)), np.float64)


def _finding(measured: Measured, marks: NDArray[np.bool_], channel: int) -> Finding:
    """Which trials of a channel have spikes, how many, and the first."""
    trials, spans = [], []
    for trial in np.flatnonzero(marks[:, :, channel].any(axis=1)).tolist():
        mine, time, seen = marks[trial, :, channel], measured.time(trial), measured.observed[trial, :, channel]
        first = int(np.argmax(mine))
        record = np.where(mine, np.nan, seen)
        known = np.flatnonzero(np.isfinite(record))
        nearest = [known[known < first][-1:], known[known > first][:1]]
        beside = " and ".join(f"{record[sample[0]]:.4g}" for sample in nearest if sample.size)
        trials.append(
            f"trial {measured.trials[trial]!r}: {mine.sum()} of {len(time)} samples (first: {seen[first]:.4g} at "
            f"{time[first]:.4g} s, next to {beside})"
        )
        spans += [(float(time[begin]), float(time[end - 1])) for begin, end in runs(mine)]
    more = f"; further trials with spikes: {len(trials) - LISTED}" if len(trials) > LISTED else ""
    what = "spikes of one to three samples: " + "; ".join(trials[:LISTED]) + more
    spoils = "these samples only, which are excluded like empty cells"
    name = measured.channels[channel]
    return Finding("warning", KIND, measured.source, what, spoils, name, spans=tuple(spans) if len(trials) == 1 else ())
