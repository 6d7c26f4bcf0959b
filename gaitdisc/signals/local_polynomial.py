"""Savitzky-Golay smoothing of one signal; by numpy alone, since scipy.signal takes half a second to import."""

from __future__ import annotations

import math

import numpy as np
from numpy.typing import NDArray


def savgol_filter(
    values: NDArray[np.float64], width: int, degree: int, derivative: int = 0, step: float = 1.0
) -> NDArray[np.float64]:
    """Smoothed signal or a derivative of it, from a polynomial fitted around each sample.

    values (sample,): evenly sampled, finite, `width` samples or more
    step: between two samples [s]
    returns (sample,): within half a width of an end, the polynomial of the first or last `width` samples
    Source: Savitzky, Golay 1964, Analytical Chemistry 36, 1627; the same numbers as `scipy.signal.savgol_filter` to
        rounding.

    >>> time = np.arange(6) * 0.1
    >>> savgol_filter(time**3, 5, 3, 1, 0.1)[1:].round(3)
    array([0.03, 0.12, 0.27, 0.48, 0.75])
    """
    half = width // 2
    offsets = np.arange(-half, half + 1.0)
    fit = np.linalg.pinv(offsets[:, None] ** np.arange(degree + 1))
    slopes = np.array([math.perm(power, derivative) for power in range(degree + 1)]) / step**derivative
    at_offsets = slopes * offsets[:, None] ** np.maximum(np.arange(degree + 1) - derivative, 0)
    weights = at_offsets @ fit  # (where in the window, sample of the window)
    inside = np.lib.stride_tricks.sliding_window_view(values, width) @ weights[half]
    return np.concatenate([weights[:half] @ values[:width], inside, weights[half + 1 :] @ values[-width:]])
