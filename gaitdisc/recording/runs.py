"""Runs of samples at which a condition holds."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray


def runs(mask: NDArray[np.bool_]) -> NDArray[np.intp]:
    """First sample of each run of True, and the one after its last.

    mask (time,): any condition on the samples
    returns (run, 2) [sample]

    >>> runs(np.array([False, True, True, False, True])).tolist()
    [[1, 3], [4, 5]]
    """
    steps = np.flatnonzero(np.diff(np.concatenate(([False], mask, [False])).astype(np.int8)))
    return steps.reshape(-1, 2)


def spans_s(time: NDArray[np.float64], mask: NDArray[np.bool_]) -> tuple[tuple[float, float], ...]:
    """Spans of the runs of True, from the first sample of each to one step after its last.

    time (time,) [s]: even
    mask (time,): any condition on the samples

    >>> spans_s(np.arange(4.0), np.array([False, True, True, False]))
    ((1.0, 3.0),)
    """
    step = (time[-1] - time[0]) / (len(time) - 1) if len(time) > 1 else 0.0
    return tuple((round(float(time[a]), 6), round(float(time[b - 1] + step), 6)) for a, b in runs(mask))
