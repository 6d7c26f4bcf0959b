"""Segments: a long record cut into short runs, so that a wrong model stays near the data and its error can be read.

Where the record went through a filter without lag, each run goes on for a margin before and after what is compared, so
that the simulated channel can go through the same filter.
"""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from gaitdisc.errors import SamplingError
from gaitdisc.recording.arrays import Values
from gaitdisc.simulation.compiled_simulation import Drive, Rows

FEWEST_SAMPLES = 16  # of a segment


@dataclass(frozen=True)
class Segments:
    """Runs of equal length inside the trials, each sample in at most one."""

    trial: NDArray[np.intp]  # (segment,), the trial that each lies in
    begin: NDArray[np.intp]  # (segment,), its first sample
    length: int
    margin: int = 0  # samples at either end that are run and not compared
    every: int = 1  # of the others, which are compared: every one, every other, ..

    def __len__(self) -> int:
        return len(self.begin)

    def of(self, records: Values) -> Values:
        """Return the segments (segment, sample, ...) of records of every trial (trial, sample, ...)."""
        return records[self.trial[:, None], self.samples]

    def starts(self, states: Values) -> Values:
        """Return the states (segment, state) at each segment's first sample, of those of every trial."""
        return states[self.trial, self.begin]

    def put(self, records: Values, runs: Values) -> Values:
        """Return every trial's states with runs put in; of two that overlap, the one that is compared."""
        out, runs = records.copy(), runs[..., : records.shape[-1]]
        out[self.trial[:, None], self.samples] = runs
        if self.margin:
            inner = slice(self.margin, self.length - self.margin)
            out[self.trial[:, None], self.samples[:, inner]] = runs[:, inner]
        return out

    @property
    def compared(self) -> slice:
        """Which samples of each are compared with the measurement."""
        return slice(self.margin, self.length - self.margin, self.every)

    @property
    def span(self) -> int:
        """Samples of each without the margins."""
        return self.length - 2 * self.margin

    def among(self, some: NDArray[np.intp]) -> Segments:
        """Return some of the segments."""
        return replace(self, trial=self.trial[some], begin=self.begin[some])

    def spread(self, most: int) -> Segments:
        """Return every second, third, ... segment of each trial, so that they hold about a number of samples together.

        most: samples, all segments together; each trial keeps its first segment

        >>> cut_segments(np.array([100]), (0,), 20).spread(60).begin.tolist()
        [0, 40, 80]
        """
        step = -(-len(self) * self.length // most)
        if step == 1:
            return self
        number = np.arange(len(self)) - np.searchsorted(self.trial, self.trial)
        return self.among(np.flatnonzero(number % step == 0))

    @property
    def samples(self) -> NDArray[np.intp]:
        """Number, within its trial, of every sample (segment, sample)."""
        return self.begin[:, None] + np.arange(self.length)

    def times(self, drive: Drive) -> Values:
        """Time of every sample (segment, sample) [s]."""
        return drive.time0[self.trial][:, None] + self.samples / drive.rate

    @property
    def steps(self) -> Segments:
        """Every step of every segment as a segment of its own."""
        steps = self.length - 1
        return Segments(np.repeat(self.trial, steps), self.samples[:, :-1].ravel(), 2)

    def rows(self, starts: Values, values: Values) -> Rows:
        """Return what it takes to run several versions of a simulation over all segments, version by version."""
        versions, segments = starts.shape[:2]
        trial, begin = np.tile(self.trial, versions), np.tile(self.begin, versions)
        return Rows(trial, begin, starts.reshape(versions * segments, -1), np.repeat(values, segments, axis=0))


def cut_segments(
    samples: NDArray[np.intp], trials: tuple[int, ...], length: int, margin: int = 0, every: int = 1
) -> Segments:
    """Cut trials into segments of about a length.

    samples (trial,): samples of every trial
    length: samples wanted without the margins; the shortest of the trials decides what divides it evenly. A length
        that came of a cut comes of it again
    margin: samples that are run before and after these; as many at either end of a trial are not compared

    >>> cut_segments(np.array([100, 70]), (0, 1), 30).begin.tolist()
    [0, 35, 0, 35]
    """
    shortest = int(min(samples[trial] for trial in trials)) - 2 * margin
    if shortest < 4:
        detail = f"one trial has {shortest + 2 * margin}"
        raise SamplingError(f"a trial must have at least {4 + 2 * margin} samples", detail, "Remove this trial.")
    if shortest // max(shortest // length, 1) != length:
        length = shortest // max(round(shortest / length), 1)
    pairs = [(trial, at) for trial in trials for at in range(0, int(samples[trial]) - 2 * margin - length + 1, length)]
    trial, begin = np.array(pairs, dtype=np.intp).T
    return Segments(trial, begin, length + 2 * margin, margin, every)
