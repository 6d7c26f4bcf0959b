"""One shift along the stride that most channels of two walks share: marks of initial contact that lie apart."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray

from gaitdisc.results.mismatch import Alignment

MOST_SHIFT = 15  # % of the stride; farther, the halves of a stride are taken for each other
LEAST_SHIFT = 0.2  # % of the stride: two milliseconds
SCATTER = 1.0  # % of the stride by which contacts scatter: a knee moves 4 deg in it, and a gap may hardly shrink
FEWEST_CHANNELS = 3
LEAST_AGREEING, WITHIN = 0.6, 2.0  # share of the channels whose own best shift lies within 2 % of the common one
MOST_LEFT = 0.9  # of the gap, the median over channels, where the shift is more than scatter


def common_shift(first: NDArray[np.float64], second: NDArray[np.float64]) -> Alignment:
    """By how much later all curves of the first walk fit those of the second best.

    Each channel's own best shift is taken without its offset; the common one is their median. It is applied where three
    channels or more have one, 60 % of all lie within 2 % of the stride of the median, and moving the curves leaves 90 %
    of the gap or less in half of them (where it is less than 1 % of the stride: does not widen it). A joint that turns
    later by itself, or walks of another rhythm, share none.

    first, second (phase, channel) [each channel's unit]: mean curves over one stride on 101 points

    >>> percent = np.arange(101.0)
    >>> wave = np.stack([np.sin(2 * np.pi * k * percent / 100 + k) for k in (1, 2, 3)], axis=1)
    >>> found = common_shift(shifted(wave, -7.0), wave + [0.0, 5.0, -2.0])
    >>> round(found.percent, 1), found.applied, found.agreeing
    (7.0, True, 3)
    """
    own = np.array([own_shift(a, b) for a, b in zip(first.T, second.T, strict=True)])
    free = own[np.abs(own) < MOST_SHIFT]
    if len(free) < FEWEST_CHANNELS:
        return Alignment(0.0, False, 0, first.shape[1])
    middle = round(float(np.median(free)), 1)
    agreeing = int(np.sum(np.abs(own - middle) <= WITHIN))
    left = _rms(shifted(first, middle), second) / np.maximum(_rms(first, second), 1e-12)
    applied = (
        abs(middle) >= LEAST_SHIFT
        and agreeing >= max(FEWEST_CHANNELS, LEAST_AGREEING * len(own))
        and float(np.median(left)) <= (MOST_LEFT if abs(middle) >= SCATTER else 1.0)
    )
    return Alignment(middle, applied, agreeing, len(own))


def own_shift(first: NDArray[np.float64], second: NDArray[np.float64]) -> float:
    """By how much later one curve fits another best, whatever lies between them [% stride].

    first, second (phase,) [channel's unit]: mean curves on 101 points
    returns: to a fraction of a percent, by a parabola through the three least gaps; 15 or -15 where there is none
        within
    """
    one, other = first[:-1] - first[:-1].mean(), second[:-1] - second[:-1].mean()
    shifts = np.arange(-MOST_SHIFT, MOST_SHIFT + 1)
    gaps = np.array([np.mean((np.roll(one, shift) - other) ** 2) for shift in shifts])
    at = int(np.argmin(gaps))
    if at in (0, len(shifts) - 1):
        return float(shifts[at])
    left, middle, right = gaps[at - 1 : at + 2]
    bend = left - 2 * middle + right
    return float(shifts[at] + (0.5 * (left - right) / bend if bend > 0 else 0.0))


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


def _rms(first: NDArray[np.float64], second: NDArray[np.float64]) -> NDArray[np.float64]:
    """Root mean square of the gap without its mean, (channel,)."""
    gap = first[:-1] - second[:-1]
    return gap.std(axis=0)
