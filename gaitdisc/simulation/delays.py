"""Delayed signals outside a run: along rows that were run, and along the samples of one trial."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

from gaitdisc.simulation.drive import Drive

if TYPE_CHECKING:
    from gaitdisc.simulation.running import Compiled


def delayed_in_rows(
    compiled: Compiled,
    recorded: tuple[Drive, NDArray[np.int64], NDArray[np.float64] | None],
    states: NDArray[np.float64],
    seconds: NDArray[np.float64],
) -> NDArray[np.float64]:
    """Delayed signals of the observations along rows, (row, step, delay).

    States are cubic between the samples of their row, near to the finer steps of the run; inputs are linear.

    Parameters
    ----------
    compiled : Compiled
        Whose observations are wanted.
    recorded : tuple of Drive, ndarray (row, 2), ndarray (trial, sample, state) or None
        Inputs, place of the rows as trial and first sample, measured states before the rows begin.
    states : ndarray (row, step, state)
        From `Compiled.run`.
    seconds : ndarray (row, delay)
        How long ago [s].
    """
    drive, place, past = recorded
    count, steps, _ = states.shape
    late = np.empty((count, steps, seconds.shape[1]))
    for k, (signal, _) in enumerate(compiled.observation.delays):
        position = np.arange(steps) - seconds[:, k, None] * drive.rate  # samples since the row's start
        if signal in compiled.inputs:
            column = compiled.inputs.index(signal)
            wraps = compiled.simulation.inputs[column].wraps
            at = np.clip(place[:, 1, None] + position, 0, drive.samples[place[:, 0], None] - 1)
            late[:, :, k] = linear_in_rows(drive.inputs[:, :, column], place[:, 0], at, wraps)
            continue
        column = compiled.states.index(signal)
        late[:, :, k] = _cubic(states[:, :, column], np.clip(position, 0, steps - 1))
        before = (position < 0) & (place[:, 1, None] > 0)
        if past is not None and before.any():
            measured = before_rows(past[:, :, column], place, position, states[:, 0, column])
            late[:, :, k] = np.where(before, measured, late[:, :, k])
    return late


def delayed_in_series(
    signal: NDArray[np.float64], seconds: NDArray[np.float64], rate: float, wraps: bool = False
) -> NDArray[np.float64]:
    """Signal some seconds ago, linear between its samples and held at the first.

    Parameters
    ----------
    signal : ndarray (sample,)
        Consecutive samples.
    seconds : ndarray (sample,) or ()
        How long ago [s].
    rate : float
        Samples a second [Hz].
    wraps : bool
        Whether it goes from just below 1 to 0 without passing what lies between.

    Examples
    --------
    >>> delayed_in_series(np.arange(4.0), np.array(0.15), 10.0).tolist()
    [0.0, 0.0, 0.5, 1.5]
    """
    at = np.clip(np.arange(len(signal)) - seconds * rate, 0, len(signal) - 1)
    return linear_in_rows(signal[None], np.array([0]), at[None], wraps)[0]


def linear_in_rows(
    series: NDArray[np.float64], which: NDArray[np.int64], at: NDArray[np.float64], wraps: bool
) -> NDArray[np.float64]:
    """Values between the samples of series, (row, step).

    Parameters
    ----------
    series : ndarray (trial, sample)
        Signals.
    which : ndarray (row,)
        Trial of each row.
    at : ndarray (row, step)
        Places, in samples, inside the trial.
    wraps : bool
        Whether the signal wraps at 1.
    """
    k = np.minimum(at.astype(int), series.shape[1] - 2) if series.shape[1] > 1 else np.zeros(at.shape, int)
    value, after = series[which[:, None], k], series[which[:, None], np.minimum(k + 1, series.shape[1] - 1)]
    slope = after - value
    if wraps:
        slope -= np.round(slope)
    value = np.where(at > k, value + (at - k) * slope, value)
    return value % 1.0 if wraps else value


def _cubic(series: NDArray[np.float64], at: NDArray[np.float64]) -> NDArray[np.float64]:
    """Values (row, step) of series (row, sample) at places (row, step), by the polynomial through four samples."""
    count, steps = series.shape
    rows = np.arange(count)
    if steps < 4:
        return linear_in_rows(series, rows, at, False)
    first = np.clip(at.astype(int) - 1, 0, steps - 4)
    found = np.zeros(at.shape)
    for i in range(4):
        weight = np.ones(at.shape)
        for j in range(4):
            if j != i:
                weight *= (at - first - j) / (i - j)
        found += np.where(weight == 0, 0.0, weight * series[rows[:, None], first + i])
    return found


def before_rows(
    past: NDArray[np.float64], place: NDArray[np.int64], position: NDArray[np.float64], start: NDArray[np.float64]
) -> NDArray[np.float64]:
    """Measured state before each row began, joined to the row's own start, (row, step).

    Parameters
    ----------
    past : ndarray (trial, sample)
        Measured state; where it is NaN the start counts.
    place : ndarray (row, 2)
        Trial and first sample of each row.
    position : ndarray (row, step)
        Places, in samples, counted from each row's start.
    start : ndarray (row,)
        State at the start.
    """
    begin = place[:, 1, None]
    at = np.clip(begin + position, 0, begin)
    k = np.minimum(at.astype(int), np.maximum(begin - 1, 0))
    value = past[place[:, 0, None], k]
    after = np.where(k + 1 >= begin, start[:, None], past[place[:, 0, None], np.minimum(k + 1, past.shape[1] - 1)])
    value = value + (at - k) * (after - value)
    return np.where(np.isfinite(value), value, start[:, None])
