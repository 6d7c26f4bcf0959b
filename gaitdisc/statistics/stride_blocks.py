"""Blocks of consecutive strides: units of exchange that hardly depend on each other where strides do."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from gaitdisc.statistics.stride_residuals import effective_strides

FEWEST_BLOCKS = 8  # fewer make the test blind, whatever they gain in independence
LEFT_OVER = 0.15  # correlation of neighbouring blocks that is left to `block_worth`


def stride_correlation(curves: NDArray[np.float64]) -> NDArray[np.float64]:
    """Correlation of successive strides, pooled over the stride, (channel,), 0 to 1.

    curves (stride, phase, channel): in order of time, complete
    Source: Corrected for its bias in short series as in `effective_strides` (Kendall 1954).
    """
    share = effective_strides(curves) / len(curves)
    return (1.0 - share) / (1.0 + share)


def block_length(correlation: float, strides: int) -> int:
    """Strides that a block needs, so that neighbouring blocks hardly depend on each other.

    Strides are taken for a first-order autoregression. The shortest block is taken whose mean correlates with that of
    its neighbour by 0.15 or less, but eight blocks are kept.

    >>> block_length(0.0, 80), block_length(0.3, 80), block_length(0.6, 80), block_length(0.6, 24)
    (1, 3, 8, 3)
    """
    longest = max(1, strides // FEWEST_BLOCKS)
    for length in range(1, longest):
        ends = np.sum(correlation ** np.arange(length))
        neighbours = correlation * ends**2 / _variance(np.array([correlation]), length)[0] / length**2
        if neighbours <= LEFT_OVER:
            return length
    return longest


def block_worth(correlation: NDArray[np.float64], length: int) -> NDArray[np.float64]:
    """Independent blocks that a block of a first-order autoregression is worth, at most 1.

    The variance that its strides have between blocks, over that which the mean of a long series has times the number of
    blocks: (1 + 2 sum (1 - j/k) rho^j) (1 - rho) / (1 + rho) for k strides in a block.

    correlation (channel,): of successive strides

    >>> block_worth(np.array([0.0, 0.6]), 1), block_worth(np.array([0.6]), 8).round(2)
    (array([1.  , 0.25]), array([0.77]))
    """
    return length * _variance(correlation, length) * (1.0 - correlation) / (1.0 + correlation)


def block_means(curves: NDArray[np.float64], length: int) -> NDArray[np.float64]:
    """Mean curves of blocks of consecutive strides, (block, phase, channel) [each channel's unit].

    curves (stride, phase, channel) [each channel's unit]: in order of time, complete
    length: strides in a block; strides that are left over lengthen the first blocks by one

    >>> block_means(np.arange(10.0)[:, None, None] * np.ones((1, 101, 1)), 5)[:, 0, 0]
    array([2., 7.])
    """
    return np.array([part.mean(axis=0) for part in np.array_split(curves, max(1, len(curves) // length))])


def _variance(correlation: NDArray[np.float64], length: int) -> NDArray[np.float64]:
    """Variance of the mean of a block, of strides of variance 1, (channel,)."""
    lags = np.arange(1, length)[:, None]
    return (1.0 + 2.0 * np.sum((1.0 - lags / length) * correlation**lags, axis=0)) / length
