"""One shift along the stride that most channels of two walks share: marks of initial contact that lie apart."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray

from gaitdisc.results.mismatch import Alignment

MOST_SHIFT = 15  # % of the stride; farther, the halves of a stride are taken for each other
LEAST_SHIFT = 0.2  # % of the stride: two milliseconds
FEWEST_CHANNELS = 3
LEAST_AGREEING = 0.6  # of the channels: their gap narrows
# 62 pairs of real walks cut at the same mark: r rises by less in 96 %; with 8.7 % of the stride planted, more in 97 %
LEAST_GAIN = 0.05
MOST_LEFT = 0.9  # or the gap that is left, median over channels: strides of one person show smaller shifts


def common_shift(first: NDArray[np.float64], second: NDArray[np.float64]) -> Alignment:
    """By how much later all curves of the first walk together fit those of the second best.

    The shift is where the correlation of the curves, mean over the channels, is highest. It is applied where the gap
    of 60 % of the channels narrows (offsets aside), and the mean correlation rises by 0.05 or the median gap falls to
    90 %.

    first, second (phase, channel) [each channel's unit]: mean curves over one stride on 101 points

    >>> percent = np.arange(101.0)
    >>> wave = np.stack([np.sin(2 * np.pi * k * percent / 100 + k) for k in (1, 2, 3)], axis=1)
    >>> found = common_shift(shifted(wave, -7.0), wave + [0.0, 5.0, -2.0])
    >>> round(found.percent, 1), found.applied, found.agreeing
    (7.0, True, 3)
    """
    count = first.shape[1]
    shifts = np.arange(-MOST_SHIFT, MOST_SHIFT + 1.0)
    gains = np.array([_correlation(shifted(first, shift), second).mean() for shift in shifts])
    at = int(np.argmax(gains))
    if at in (0, len(shifts) - 1) or count < FEWEST_CHANNELS:
        return Alignment(0.0, False, 0, count)
    before, peak, after = gains[at - 1 : at + 2]  # a parabola through them
    percent = round(float(shifts[at] + 0.5 * (before - after) / min(before - 2 * peak + after, -1e-12)), 1)
    moved = shifted(first, percent)
    left = (moved - second)[:-1].std(axis=0) / np.maximum((first - second)[:-1].std(axis=0), 1e-12)
    gain = float(_correlation(moved, second).mean()) - gains[MOST_SHIFT]
    agreeing = int(np.sum(left < 1.0))
    applied = bool(
        abs(percent) >= LEAST_SHIFT
        and agreeing >= LEAST_AGREEING * count
        and (gain >= LEAST_GAIN or float(np.median(left)) <= MOST_LEFT)
    )
    largest = np.abs((first if applied else moved) - second).max(axis=0)
    return Alignment(percent, applied, agreeing, count, largest.tolist())


def shifted(curves: NDArray[np.float64], percent: float) -> NDArray[np.float64]:
    """Curves moved later along the stride, which is closed: 100 % is 0 %.

    curves (phase, ...) [each channel's unit]: on 101 points
    percent: linear between points [% stride]
    """
    places = (np.arange(100.0) - percent) % 100.0
    low = np.floor(places).astype(int) % 100
    share = (places - np.floor(places)).reshape(-1, *([1] * (curves.ndim - 1)))
    moved = (1 - share) * curves[low] + share * curves[(low + 1) % 100]
    return np.concatenate([moved, moved[:1]])


def aligned(walks: Sequence[NDArray[np.float64]], percent: float) -> list[NDArray[np.float64]]:
    """Strides of walks moved later along the stride.

    walks each (stride, phase, channel) [each channel's unit]: complete
    percent: by how much [% stride]
    """
    return [np.moveaxis(shifted(np.moveaxis(curves, 1, 0), percent), 0, 1) for curves in walks]


def _correlation(first: NDArray[np.float64], second: NDArray[np.float64]) -> NDArray[np.float64]:
    """Correlation of two curves over the stride, (channel,); 0 where one does not move."""
    one, other = (curves[:-1] - curves[:-1].mean(axis=0) for curves in (first, second))
    return (one * other).sum(axis=0) / np.maximum(np.sqrt((one**2).sum(axis=0) * (other**2).sum(axis=0)), 1e-12)
