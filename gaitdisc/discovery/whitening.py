"""Compiled: take from each sample what the samples before it say."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from gaitdisc.compiled import compiled


@compiled(nogil=True)
def whiten(
    residual: NDArray[np.float64],
    channel: int,
    predictors: NDArray[np.float64],
    spread: NDArray[np.float64],
    out: NDArray[np.float64],
) -> None:
    """Write one channel's innovations, in units of their spread.

    Parameters
    ----------
    residual : ndarray (segment, sample, channel, column)
        What is left; each segment begins afresh.
    channel : int
        Which channel.
    predictors : ndarray (order + 1, order)
        Row p predicts from the p samples before.
    spread : ndarray (order + 1,)
        What each leaves.
    out : ndarray (segment, sample, channel, column)
        Written in place.
    """
    segments, samples, _, columns = residual.shape
    last = len(spread) - 1
    for segment in range(segments):
        for sample in range(samples):
            order = min(sample, last)
            for column in range(columns):
                out[segment, sample, channel, column] = residual[segment, sample, channel, column]
            for lag in range(order):
                weight = predictors[order, lag]
                before = residual[segment, sample - 1 - lag, channel]
                for column in range(columns):
                    out[segment, sample, channel, column] -= weight * before[column]
            for column in range(columns):
                out[segment, sample, channel, column] /= spread[order]
