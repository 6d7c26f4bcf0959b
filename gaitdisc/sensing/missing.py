"""Readings that are missing: made for a trial of a model, and what stands in their place where a model needs all."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace

import numpy as np
from numpy.typing import NDArray

from gaitdisc.errors import SchemaError
from gaitdisc.recording import Recording, Samples

WAYS = {
    "none": "a window that lacks a reading is left out",
    "mean": "the sensor's mean in the training part stands for a reading that is missing",
    "last": "the sensor's last known reading stands for one that is missing",
}
MOST_MISSING = 0.6  # of a window's readings, in training
RUNS = (1, 3, 10)  # readings that go missing in a row, on average


def missing_runs(share: NDArray[np.float64], run: NDArray[np.float64], length: int, seed: int = 0) -> NDArray[np.bool_]:
    """Draw which readings are missing, column by column: a Markov chain of two states.

    share (column,): readings of the column that are missing, between 0 and below 1
    run (column,): readings that are missing in a row, on average; at least 1, at which each is drawn alone if the
        share allows
    returns (length, column)

    >>> lost = missing_runs(np.array([0.0, 0.3]), np.array([5.0, 5.0]), 20_000)
    >>> lost.mean(axis=0).round(1).tolist()
    [0.0, 0.3]
    """
    rng = np.random.default_rng(seed)
    run = np.maximum(run, 1 / (1 - share))  # shorter runs cannot make up the share
    begin, stay = share / (run * (1 - share)), 1 - 1 / run
    lost = np.empty((length, len(share)), bool)
    now = rng.random(len(share)) < share
    for row in range(length):
        lost[row] = now
        now = rng.random(len(share)) < np.where(now, stay, begin)
    return lost


def with_missing(recording: Recording, sensors: Sequence[str], share: float, run_s: float, seed: int = 0) -> Recording:
    """Take a share (0 to below 1) of each sensor's readings away, in drop-outs of mean `run_s` [s]; 0: one by one."""
    shares, runs = np.full(len(sensors), share), np.full(len(sensors), max(1.0, run_s * recording.rate_hz))
    values = recording.values.copy()
    columns = [recording.index(name) for name in sensors]
    lost = missing_runs(shares, runs, len(values), seed)
    values[:, columns] = np.where(lost, np.nan, values[:, columns])
    return recording.with_values(values)


def filled(recording: Recording, sensors: Sequence[str], way: str, means: NDArray[np.float64]) -> Recording:
    """Fill missing readings by a word of `WAYS`, from training means (sensor,); `last` too, before a first reading."""
    refuse_unknown_way(way)
    values = recording.values.copy()
    for name, mean in zip(sensors, means, strict=True):
        column = recording.index(name)
        known = np.isfinite(values[:, column])
        if way == "mean":
            values[~known, column] = mean
        elif way == "last":
            latest = np.maximum.accumulate(np.where(known, np.arange(len(known)), -1))
            values[:, column] = np.where(latest < 0, mean, values[latest, column])
    return recording.with_values(values)


def refuse_unknown_way(way: str) -> None:
    """Refuse what is no way to deal with missing readings."""
    if way not in WAYS:
        raise SchemaError(
            "missing readings are dealt with in one of three ways", f"{way!r} is none", "Use none, mean or last."
        )


def hidden(samples: Samples, sensors: int, seed: int = 0) -> Samples:
    """Hide readings of every second window, for training: a model learns to do without them.

    Each sensor of such a window loses a share of its readings that is drawn between 0 and 0.6, singly or in runs.

    returns: the same windows, NaN where a reading is hidden; the states are all there
    """
    rng = np.random.default_rng(seed)
    chosen = np.arange(1, len(samples), 2)
    readings = samples.x.shape[1] // sensors
    columns = len(chosen) * sensors
    lost = missing_runs(rng.uniform(0, MOST_MISSING, columns), rng.choice(RUNS, columns).astype(float), readings, seed)
    x = samples.x.copy()
    x[chosen] = np.where(
        lost.reshape(readings, len(chosen), sensors).swapaxes(0, 1).reshape(len(chosen), -1), np.nan, x[chosen]
    )
    return replace(samples, x=x)
