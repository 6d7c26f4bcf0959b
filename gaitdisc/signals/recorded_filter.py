"""Which zero-lag low-pass a record went through, read off its spectrum.

White sensor noise that went through a Butterworth filter forwards and backwards falls as 1/(1 + w^2n)^2 above the cut-off,
w = tan(pi f / rate) / tan(pi fc / rate): by 48 dB an octave for n = 2. Nothing that walks does that by itself. The power
spectrum (Welch 1967, Blackman-Harris window: side lobes 92 dB down) is fitted by the likelihood of Whittle (1953): signal
and noise behind a filter and above a floor of rounding, against the same without the filter.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

WINDOW = 512  # samples
FEWEST = 128  # samples of a trial whose spectrum is looked at
BLACKMAN_HARRIS = (0.35875, -0.48829, 0.14128, -0.01168)
SIGNAL = 1e-2  # of the strongest line: above it all is signal
BEGINNINGS = (0.03, 0.06, 0.12, 0.2)  # cut-offs that a search begins from, of the rate
FALLEN = 1e3  # times the power just below half the rate, which there is just above the cut-off at least
CLEARLY = 60.0  # by which the log likelihood must be better with the filter than without


@dataclass(frozen=True)
class Spectrum:
    """Power of a channel over frequency.

    Parameters
    ----------
    frequency : ndarray (line,)
        As a share of the rate.
    power : ndarray (line,)
        [the channel's unit squared].
    windows : int
        How many were averaged.
    """

    frequency: NDArray[np.float64]
    power: NDArray[np.float64]
    windows: int


@dataclass(frozen=True)
class RecordedFilter:
    """A filter that was found in a record.

    Parameters
    ----------
    cutoff_hz : float
        -3 dB frequency of one pass.
    order : int
        Of one pass; it ran forwards and backwards.
    gained : float
        Log likelihood with it less that without it.
    """

    cutoff_hz: float
    order: int
    gained: float


def recorded_filter(trials: Sequence[NDArray[np.float64]], rate_hz: float) -> RecordedFilter | None:
    """Find the zero-lag low-pass that a channel went through.

    Parameters
    ----------
    trials : sequence of ndarray (sample,)
        One channel of each trial, evenly sampled; NaN where nothing was measured.
    rate_hz : float
        Samples a second.

    Returns
    -------
    RecordedFilter or None
        None where the spectrum shows none. Where the signal reaches far above the cut-off, its number is rough.

    References
    ----------
    Welch (1967), IEEE Trans. Audio Electroacoust. 15:70-73. Whittle (1953), Ark. Mat. 2:423-434.

    Examples
    --------
    >>> from scipy.signal import butter, sosfiltfilt
    >>> noise = np.random.default_rng(0).normal(size=4000)
    >>> low = sosfiltfilt(butter(2, 6.0, fs=100.0, output="sos"), noise)
    >>> found = recorded_filter([low], 100.0)
    >>> found.order, bool(abs(found.cutoff_hz - 6.0) < 0.5), recorded_filter([noise], 100.0)
    (2, True, None)
    """
    spectrum = spectrum_of(trials)
    if spectrum is None:
        return None
    above = _above_the_signal(spectrum)
    if len(above.frequency) < 24:
        return None
    without = max(_likelihood(above, 0, 0, share)[0] for share in BEGINNINGS)
    found = []
    for order, passes in ((2, 1), (2, 2), (4, 2)):
        likelihood, cutoff = max(_likelihood(above, order, passes, share) for share in BEGINNINGS)
        found.append((likelihood - without, order, passes, cutoff))
    gained, order, passes, cutoff = max(found)
    if gained < CLEARLY or passes < 2 or not 0.005 < cutoff < 0.45 or not _falls_far(above, cutoff):
        return None
    return RecordedFilter(cutoff * rate_hz, order, gained)


def spectrum_of(trials: Sequence[NDArray[np.float64]]) -> Spectrum | None:
    """Power spectrum of a channel, averaged over windows that overlap by half; None where all trials are too short.

    Parameters
    ----------
    trials : sequence of ndarray (sample,)
        NaN where nothing was measured: a window takes the longest stretch without any.
    """
    stretches = [stretch for trial in trials for stretch in _whole_stretches(trial)]
    length = min(max((len(one) for one in stretches), default=0), WINDOW)
    if length < FEWEST:
        return None
    angle = 2 * np.pi * np.arange(length) / length
    window = sum(weight * np.cos(turn * angle) for turn, weight in enumerate(BLACKMAN_HARRIS))
    line = np.stack([np.ones(length), np.linspace(-1, 1, length)], axis=1)
    powers = []
    for stretch in stretches:
        for begin in range(0, len(stretch) - length + 1, length // 2):
            part = stretch[begin : begin + length]
            part = part - line @ np.linalg.lstsq(line, part, rcond=None)[0]
            powers.append(np.abs(np.fft.rfft(part * window)) ** 2)
    return Spectrum(np.fft.rfftfreq(length), np.mean(powers, axis=0), len(powers))


def _whole_stretches(trial: NDArray[np.float64]) -> list[NDArray[np.float64]]:
    edges = np.flatnonzero(np.diff(np.concatenate([[False], np.isfinite(trial), [False]]).astype(int)))
    return [trial[first:end] for first, end in edges.reshape(-1, 2)]


def _above_the_signal(spectrum: Spectrum) -> Spectrum:
    """Return the lines beyond the last one that is surely signal, without those next to half the rate."""
    surely = np.flatnonzero(spectrum.power > SIGNAL * spectrum.power[2:].max())
    kept = slice(int(surely[-1]) + 1, len(spectrum.power) - 3)
    return Spectrum(spectrum.frequency[kept], np.maximum(spectrum.power[kept], 1e-300), spectrum.windows)


def _falls_far(spectrum: Spectrum, cutoff: float) -> bool:
    """Whether the power above the cut-off goes on falling, instead of ending on the noise of a sensor."""
    near = spectrum.power[(spectrum.frequency > cutoff) & (spectrum.frequency < 1.5 * cutoff)]
    return bool(near.size) and float(np.median(near)) > FALLEN * float(np.median(spectrum.power[-12:]))


def _likelihood(spectrum: Spectrum, order: int, passes: int, begin: float) -> tuple[float, float]:
    """Whittle's log likelihood of signal and white noise behind a filter, above a floor, and the cut-off found."""
    from scipy.optimize import minimize

    frequency, power = spectrum.frequency, spectrum.power
    low = frequency < 2 * begin
    level = np.log(np.median(power[low] if low.any() else power))
    first = np.array([level, np.log(begin), np.log(power[:3].mean()), np.log(30.0), np.log(np.median(power[-12:]))])

    def misfit(values: NDArray[np.float64]) -> float:
        noise, cutoff, signal, decay, floor = values
        w = np.tan(np.pi * frequency) / np.tan(np.pi * np.clip(np.exp(cutoff), 1e-4, 0.49))
        passed = (1 + w ** (2 * order)) ** -float(passes) if passes else 1.0
        falling = np.exp(np.clip(signal, -600, 600) - np.exp(np.clip(decay, -5, 8)) * (frequency - frequency[0]))
        expected = (falling + np.exp(np.clip(noise, -600, 600))) * passed + np.exp(np.clip(floor, -600, 600))
        return float(np.sum(np.log(expected) + power / expected))

    options = {"maxiter": 1500, "maxfev": 1500, "xatol": 1e-3, "fatol": 1e-2 / spectrum.windows}
    found = minimize(misfit, first, method="Nelder-Mead", options=options)
    return -float(found.fun) * spectrum.windows, float(np.exp(found.x[1]))
