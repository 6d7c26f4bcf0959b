"""The noise of the sensors, estimated from the record alone: no simulation has a part in it.

Source: Savitzky and Golay 1964, Anal. Chem. 36, 1627 (local polynomials).
"""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from gaitdisc.signals.derivatives import savgol_filter

WINDOW, ORDER = 7, 3  # samples, and the order of the polynomial through them
FEWEST = 12  # samples of a trial
MAD_OF_NORMAL = 1.4826  # standard deviation over the median absolute deviation
LEAST = 1e-6  # of a channel's spread: what rounding leaves


def sensor_noise(observed: NDArray[np.float64]) -> NDArray[np.float64]:
    """Estimate the standard deviation of each channel's white noise: what a local cubic over 7 samples leaves.

    Noise that a filter has made smooth is not seen: of such a record the estimate is too small.

    observed (trial, sample, channel): measured, NaN where nothing was
    returns (channel,): [the channel's unit]; the median over the trials

    >>> t = np.arange(2000) / 100
    >>> noise = np.random.default_rng(0).normal(0, 0.02, t.size)
    >>> bool(abs(sensor_noise((np.sin(6 * t) + noise)[None, :, None])[0] - 0.02) < 0.002)
    True
    """
    powers = np.vander(np.arange(WINDOW) - WINDOW // 2, ORDER + 1).astype(float)
    kept = 1 - (powers @ np.linalg.pinv(powers))[WINDOW // 2, WINDOW // 2]
    spread = np.nanstd(observed, axis=(0, 1))
    found = LEAST * spread
    for channel in range(observed.shape[2]):
        sizes = [_rough(record[np.isfinite(record)]) for record in observed[:, :, channel]]
        sizes = [one for one in sizes if np.isfinite(one)]
        if sizes:
            found[channel] = max(MAD_OF_NORMAL * float(np.median(sizes)) / np.sqrt(kept), found[channel])
    return found


def _rough(record: NDArray[np.float64]) -> float:
    """Median absolute deviation of a record from its local cubic; NaN for one that is too short."""
    if len(record) < FEWEST:
        return float("nan")
    left = record - savgol_filter(record, WINDOW, ORDER)
    return float(np.median(np.abs(left[WINDOW // 2 : -(WINDOW // 2)])))
