"""The R2 that band-limited noise without any gait reaches: what the filters give away for nothing."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray
from scipy.integrate import trapezoid

from gaitdisc.statistics.r2 import r2

Filtered = Callable[[NDArray[np.float64]], tuple[NDArray[np.float64], NDArray[np.float64], NDArray[np.float64]]]
EDGE = 0.05  # share left away at either end, where filters ring


@dataclass(frozen=True)
class BandLimitNull:
    """R2 of x'' regressed on x and x' of the same noise."""

    r2: float
    standard_error: float


def simulate_null(filtered: Filtered, samples: int, walks: int = 40, seed: int = 0) -> BandLimitNull:
    """Reach of a linear regression of x'' on x and x' in noise that went through the filters of the measurement.

    The spectrum of a low-passed signal ties x'' to x, whatever was measured: a flat band has corr^2(x, x'') = 5/9. A
    model of gait has learned something only where its R2 is above this.

    filtered: takes white noise (sample, walk) and gives x, x', x'' of any one length, filtered and differentiated as
        the measurement was: 6 Hz low-pass for angles; high-pass, rectify, low-pass for EMG
    samples: length of a walk of noise, at the rate that `filtered` takes

    >>> def oscillation(noise):
    ...     t = np.linspace(0, 50, len(noise))[:, None] + noise[:1]
    ...     return np.sin(t), np.cos(t), -np.sin(t)
    >>> round(simulate_null(oscillation, 500, walks=4).r2, 6)
    1.0
    """
    noise = np.random.default_rng(seed).standard_normal((samples, walks))
    x, xdot, xddot = filtered(noise)
    edge = int(EDGE * len(x))
    middle = slice(edge, len(x) - edge)
    reached = [_linear_r2(x[middle, k], xdot[middle, k], xddot[middle, k]) for k in range(walks)]
    return BandLimitNull(float(np.mean(reached)), float(np.std(reached, ddof=1) / np.sqrt(walks)))


def analytic_null(frequency_hz: NDArray[np.float64], gain: NDArray[np.float64]) -> float:
    """Squared correlation of x and x'' for white noise through a linear filter, m2^2 / (m0 m4).

    m_k is the k-th moment of the power that the filter lets through; x' adds nothing, for it does not correlate with
    x'' in stationary noise.

    frequency_hz (frequency,) [Hz]: rising, from 0 to where nothing passes
    gain (frequency,): amplitude gain of the whole filter: of both passes where it runs forward and back

    >>> f = np.linspace(0, 6, 1001)
    >>> round(analytic_null(f, np.ones_like(f)), 4)  # flat: 5/9
    0.5556
    """
    m0, m2, m4 = (trapezoid(frequency_hz**power * gain**2, frequency_hz) for power in (0, 2, 4))
    return float(m2**2 / (m0 * m4))


def _linear_r2(x: NDArray[np.float64], xdot: NDArray[np.float64], xddot: NDArray[np.float64]) -> float:
    columns = np.column_stack([x, xdot, np.ones(len(x))])
    solution = np.linalg.lstsq(columns, xddot, rcond=None)[0]
    return float(r2(xddot[:, None], (columns @ solution)[:, None])[0])
