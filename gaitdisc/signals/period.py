"""Stride period and regularity of a joint angle, from its autocorrelation."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

SHORTEST_STRIDE_S, LONGEST_STRIDE_S = 0.4, 2.5


def stride_period(
    x: NDArray[np.float64],
    rate_hz: float,
    shortest_s: float = SHORTEST_STRIDE_S,
    longest_s: float = LONGEST_STRIDE_S,
) -> tuple[float, float]:
    """Period at which an angle repeats, and how well.

    The autocorrelation is that of the two overlapping parts (each lag has its own means and variances), so a perfectly
    repeated stride gives 1 at every multiple of its period. The shortest lag whose peak comes within 0.1 of the highest
    one is the period.

    x (time,): NaN allowed; lags use the pairs that are there
    shortest_s, longest_s: range searched [s]
    returns period_s, regularity: NaN and 0 where nothing repeats or the recording is shorter than 1.7 strides.
        Regularity is the correlation at the period, -1 to 1

    >>> t = np.arange(1000) / 100
    >>> period, regularity = stride_period(np.sin(2 * np.pi * t) + 0.5 * np.sin(4 * np.pi * t), 100.0)
    >>> round(period, 2), round(regularity, 2)
    (1.0, 1.0)
    """
    first = max(1, round(shortest_s * rate_hz))
    last = min(round(longest_s * rate_hz), int(0.6 * len(x)))
    if last <= first + 1 or np.isfinite(x).sum() < first:
        return float("nan"), 0.0
    lags = np.arange(first - 1, last + 2)
    r = np.array([_correlation(x[:-lag], x[lag:]) for lag in lags])
    inner = r[1:-1]
    peaks = np.flatnonzero((inner > r[:-2]) & (inner >= r[2:]) & (inner > 0)) + 1
    if not len(peaks):
        return float("nan"), 0.0
    first_high = peaks[np.flatnonzero(r[peaks] >= r[peaks].max() - 0.1)[0]]
    left, centre, right = r[first_high - 1 : first_high + 2]
    shift = 0.5 * (left - right) / (left - 2 * centre + right)
    return float((lags[first_high] + shift) / rate_hz), float(centre)


def _correlation(a: NDArray[np.float64], b: NDArray[np.float64]) -> float:
    both = np.isfinite(a) & np.isfinite(b)
    if both.sum() < 10:
        return 0.0
    a, b = a[both] - a[both].mean(), b[both] - b[both].mean()
    size = float(np.sqrt((a @ a) * (b @ b)))
    return float(a @ b) / size if size > 0 else 0.0
