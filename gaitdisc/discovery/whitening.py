"""Compiled: take from each sample what the samples before it say."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from gaitdisc.compiled import compiled


@compiled(nogil=True)
def whiten(
    residual: NDArray[np.float64],
    channel: int,
    known: NDArray[np.bool_],
    predictors: NDArray[np.float64],
    spread: NDArray[np.float64],
    out: NDArray[np.float64],
) -> None:
    """Write one channel's innovations, in units of their spread.

    residual (segment, sample, channel, column): what is left; each segment begins afresh, and so does what follows a
        gap
    known (segment, sample, channel): where there is a residual; nothing is left elsewhere
    predictors (order + 1, order): row p predicts from the p samples before
    spread (order + 1,): what each leaves
    out (segment, sample, channel, column): written in place
    """
    segments, samples, _, columns = residual.shape
    last = len(spread) - 1
    for segment in range(segments):
        run = 0
        for sample in range(samples):
            if not known[segment, sample, channel]:
                run = 0
                out[segment, sample, channel, :] = 0.0
                continue
            order = min(run, last)
            run += 1
            for column in range(columns):
                out[segment, sample, channel, column] = residual[segment, sample, channel, column]
            for lag in range(order):
                weight = predictors[order, lag]
                before = residual[segment, sample - 1 - lag, channel]
                for column in range(columns):
                    out[segment, sample, channel, column] -= weight * before[column]
            for column in range(columns):
                out[segment, sample, channel, column] /= spread[order]
