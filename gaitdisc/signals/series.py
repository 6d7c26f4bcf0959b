"""A series of numbers: its spread, whatever a few of them are, and how long it resembles itself."""

from __future__ import annotations

import numpy as np

from gaitdisc.recording.arrays import Values


def robust_sd(values: Values) -> float:
    """Standard deviation by the median absolute deviation: that of normal numbers, whatever a few others are."""
    return 1.4826 * float(np.median(np.abs(values - np.median(values))))


def autocorrelation_time(values: Values, forgotten: float = 0.0) -> Values:
    """Integrated autocorrelation time of each column [samples], (column,): 1 of white noise.

    So many numbers in a row say no more together than one that stands alone. Correlations are summed up to the first
    that is no larger than `forgotten`.

    values (time, column): in order of time
    Source: Sokal 1997, Monte Carlo methods in statistical mechanics.

    >>> noise = np.random.default_rng(0).standard_normal(100_000)
    >>> slow = np.convolve(noise, np.ones(5), "same")
    >>> autocorrelation_time(np.column_stack([noise, slow]), 0.05).round(1).tolist()
    [1.0, 5.0]
    """
    n = len(values)
    spectrum = np.abs(np.fft.rfft(values - values.mean(axis=0), 2 * n, axis=0)) ** 2
    products = np.fft.irfft(spectrum, axis=0)[:n]
    rho = products / np.where(products[0] > 0, products[0], 1.0)
    remembered = np.logical_and.accumulate(rho[1:] > forgotten, axis=0)
    return 1 + 2 * (rho[1:] * remembered).sum(axis=0)
