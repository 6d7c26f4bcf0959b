"""Zero-lag smoothing of a measured record, with the cut-off that its noise asks for."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray
from scipy.signal import butter, sosfiltfilt

ORDER = 4
HIGH_BAND = 0.75  # of half the rate: nothing but noise is looked for above
CUTOFFS = 40
EDGE_PERIODS = 1.8  # of the cut-off, over which the filter's ends are not to be trusted (as in `signals.butterworth`)


def smoothed(values: NDArray[np.float64], rate_hz: float, cutoff_hz: float | None = None) -> NDArray[np.float64]:
    """Low-passed channels, (sample, channel).

    Parameters
    ----------
    values : ndarray (sample, channel)
        Without gaps.
    rate_hz : float
        Samples a second.
    cutoff_hz : float, optional
        -3 dB frequency of one of the two passes; by residual analysis where absent, for each channel.

    Examples
    --------
    >>> t = np.arange(500) / 100
    >>> noisy = np.sin(t) + 0.1 * np.random.default_rng(0).standard_normal(500)
    >>> bool(np.std(smoothed(noisy[:, None], 100.0)[:, 0] - np.sin(t)) < 0.03)
    True
    """
    columns = []
    for column in np.asarray(values, float).T:
        cutoff = residual_cutoff_hz(column, rate_hz) if cutoff_hz is None else cutoff_hz
        columns.append(_lowpassed(column, rate_hz, cutoff))
    return np.column_stack(columns)


def residual_cutoff_hz(values: NDArray[np.float64], rate_hz: float) -> float:
    """Lowest cut-off whose residual is no larger than the noise.

    The noise is that above 0.75 of half the rate, taken as white; what a filter removes beyond white noise is signal.

    Parameters
    ----------
    values : ndarray (sample,)
        Without gaps.
    rate_hz : float
        Samples a second.

    References
    ----------
    Winter 2009, Biomechanics and Motor Control of Human Movement, section 3.4.4.3: residual analysis, with the line
    through its straight part replaced by the power above a frequency.
    """
    high = sosfiltfilt(butter(ORDER, HIGH_BAND, "highpass", output="sos"), values - values.mean())
    noise = float(np.std(high)) / np.sqrt(1 - HIGH_BAND)
    trials = np.geomspace(rate_hz / 200, 0.45 * rate_hz, CUTOFFS)
    for cutoff in trials:
        removed = np.std(values - _lowpassed(values, rate_hz, float(cutoff)))
        if removed <= 1.01 * noise * np.sqrt(1 - 2 * cutoff / rate_hz):
            return float(cutoff)
    return float(trials[-1])


def edge_samples(rate_hz: float, cutoff_hz: float = 4.0) -> int:
    """Samples at each end that the filter's start and end still shape.

    Parameters
    ----------
    rate_hz, cutoff_hz : float
        Of the record and of the filter.

    Examples
    --------
    >>> edge_samples(100.0)
    45
    """
    return int(np.ceil(EDGE_PERIODS / cutoff_hz * rate_hz))


def _lowpassed(values: NDArray[np.float64], rate_hz: float, cutoff_hz: float) -> NDArray[np.float64]:
    sections = butter(ORDER, cutoff_hz, fs=rate_hz, output="sos")
    padding = min(len(values) - 2, int(np.ceil(3 * rate_hz / cutoff_hz)))
    return np.asarray(sosfiltfilt(sections, values, padtype="odd", padlen=padding))
