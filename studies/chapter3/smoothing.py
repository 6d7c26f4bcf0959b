"""Zero-lag smoothing of a measured record, with the cut-off that its noise needs."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray
from scipy.signal import butter, sosfiltfilt, welch

ORDER = 4
HIGH_BAND = 0.75  # of half the rate: nothing but noise is looked for above
ABOVE, NEIGHBOURS, MARGIN = 5.0, 5, 1.5
EDGE_PERIODS = 1.8  # of the cut-off, over which the filter's ends are not to be trusted (as in `signals.butterworth`)


def smoothed(values: NDArray[np.float64], rate_hz: float, cutoff_hz: float | None = None) -> NDArray[np.float64]:
    """Low-passed channels, (sample, channel)."""
    columns = []
    for column in np.asarray(values, float).T:
        cutoff = noise_cutoff_hz(column, rate_hz) if cutoff_hz is None else cutoff_hz
        columns.append(_lowpassed(column, rate_hz, cutoff))
    return np.column_stack(columns)


def noise_cutoff_hz(values: NDArray[np.float64], rate_hz: float) -> float:
    """Half as much again as the highest frequency at which signal stands out of the noise.

    The noise's power density is the median of that above 0.75 of half the rate, taken as white; signal stands out where
    the density, as the mean of five neighbours, is above five times that.

    Source: Welch 1967, IEEE Trans. Audio Electroacoust. 15:70, with segments of a quarter of the record. It stands for
        the published code's 4 Hz, which suits neither system: it costs the Lorenz system its turns and leaves the Van
        der Pol oscillator most of the noise.
    """
    length = max(32, len(values) // 4)
    frequency, density = welch(values, rate_hz, nperseg=min(length, len(values)), detrend="linear")
    floor = np.median(density[frequency > HIGH_BAND * rate_hz / 2])
    wide = np.convolve(density, np.ones(NEIGHBOURS) / NEIGHBOURS, mode="same")
    loud = np.flatnonzero(wide > ABOVE * floor)
    highest = frequency[loud[-1]] if loud.size else 0.0
    return float(np.clip(MARGIN * highest, 4 * rate_hz / len(values), 0.45 * rate_hz))


def edge_samples(rate_hz: float, cutoff_hz: float = 4.0) -> int:
    """Samples at each end that the filter's start and end still shape."""
    return int(np.ceil(EDGE_PERIODS / cutoff_hz * rate_hz))


def _lowpassed(values: NDArray[np.float64], rate_hz: float, cutoff_hz: float) -> NDArray[np.float64]:
    sections = butter(ORDER, cutoff_hz, fs=rate_hz, output="sos")
    padding = min(len(values) - 2, int(np.ceil(3 * rate_hz / cutoff_hz)))
    return np.asarray(sosfiltfilt(sections, values, padtype="odd", padlen=padding))
