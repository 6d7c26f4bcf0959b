"""How long numbers in time remember themselves."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray


def autocorrelation_time(values: NDArray[np.float64], forgotten: float = 0.0) -> NDArray[np.float64]:
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
