"""Which zero-lag low-pass a record went through, read off its spectrum.

White sensor noise that went through a Butterworth filter of order 2 forwards and backwards falls as 1/(1 + w^4)^2
above the cut-off, w = tan(pi f / rate) / tan(pi fc / rate): by 48 dB an octave. Nothing that walks does that by itself.
The power spectrum (Welch 1967, Blackman-Harris window: side lobes 92 dB down) is fitted by the likelihood of Whittle
(1953): signal and noise behind a filter and above a floor of rounding, against the same without the filter.
"""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from gaitdisc.recording.arrays import Values, finite_values, runs

ORDER, OTHER = 2, 4  # of one pass: the filter that is sought, and a steeper one
WINDOW = 512  # samples
FEWEST = 128  # samples of a trial whose spectrum is looked at
FEWEST_LINES = 24
BLACKMAN_HARRIS = (0.35875, -0.48829, 0.14128, -0.01168)
WINDOW_POWER = float(np.square(BLACKMAN_HARRIS) @ [1.0, 0.5, 0.5, 0.5])  # mean square
SIGNAL = 1e-2  # of the strongest line: above it all is signal
BEGINNINGS = (0.02, 0.04, 0.07, 0.11, 0.17)  # cut-offs that a search begins from, of the rate
LEAST = 1e-32  # power, of the strongest line: beyond the digits of a number
BOUNDS = ((-90, 9), (-90, 9), (-5, 8), (-90, 9), (np.log(2e-3), np.log(0.45)))  # logarithms
HIGHEST = 0.2  # cut-off, of the rate: one above leaves too little to be seen
FALLEN = 1e3  # times the power just below half the rate, which there is just above the cut-off at least
FALLING = 30.0  # times the power just below half the rate: power at a quarter of the rate where nothing is rounded
ROUNDED = 100.0  # times the power of rounding, below which a floor is one of digits and not of a sensor
SPREAD = 1e-8  # of the strongest line: what the window itself spreads, and no sensor is so quiet
CLEARLY = 60.0  # by which the log likelihood must be better with the filter than without
LIKELIER = 10.0  # by which it must be for the filter that other channels went through, if no other is clearly better


@dataclass(frozen=True)
class Spectrum:
    """Power of a channel over frequency."""

    frequency: Values  # (line,), as a share of the rate
    power: Values  # (line,), [the channel's unit squared]
    windows: int


@dataclass(frozen=True)
class RecordedFilter:
    """A filter that was found in a record: a Butterworth low-pass of order 2, forwards and back."""

    cutoff_hz: float
    likelihood: float  # log likelihood with it, of the same lines whatever the signal is taken to be like
    # power of the signal over that of the noise at the cut-off: where it is far above 1, the number is rough
    signal: float
    noise: float = float("nan")  # standard deviation of the white noise before the filter [the channel's unit]


def find_filter(
    trials: Sequence[Values], rate_hz: float, like: Sequence[Values] | None = None, at_hz: float | None = None
) -> RecordedFilter | None:
    """Find the zero-lag low-pass that a channel went through.

    trials each (sample,): one channel of each trial, evenly sampled; NaN where nothing was measured
    like each (sample,): the same channel as a simulation has it, before any filter: the signal's spectrum is like that
        of these
    at_hz: cut-off of channels that were recorded beside it: less has to speak for that
    returns: none where the spectrum shows none, or one of order 4
    Source: Welch (1967), IEEE Trans. Audio Electroacoust. 15:70-73. Whittle (1953), Ark. Mat. 2:423-434.

    >>> from scipy.signal import butter, sosfiltfilt
    >>> raw = np.sin(2 * np.pi * np.arange(4000) / 100) + np.random.default_rng(0).normal(0, 0.05, 4000)
    >>> low = sosfiltfilt(butter(2, 6.0, fs=100.0, output="sos"), raw)
    >>> bool(abs(find_filter([low], 100.0).cutoff_hz - 6.0) < 0.5), find_filter([raw], 100.0)
    (True, None)
    """
    spectrum = mean_spectrum(trials)
    if spectrum is None or not _may_be_filtered(spectrum, trials):
        return None
    # the lines beyond the last one that is surely signal, without those next to half the rate
    surely = np.flatnonzero(spectrum.power > SIGNAL * spectrum.power[2:].max())
    lines = slice(int(surely[-1]) + 1, len(spectrum.power) - 3)
    above = Spectrum(spectrum.frequency[lines], spectrum.power[lines], spectrum.windows)
    if len(above.frequency) < FEWEST_LINES:
        return None
    model = mean_spectrum(like) if like is not None else None
    shape = np.ones(len(above.power)) if model is None else np.interp(above.frequency, model.frequency, model.power)
    fits = [_Fit(above, shape / shape[0], order) for order in (ORDER, OTHER)]
    best, other = (max(fit.best((begin,)) for begin in BEGINNINGS) for fit in fits)
    beside, enough = fits[0].best((at_hz / rate_hz,), held=True) if at_hz else best, CLEARLY
    if at_hz and (best[0] - beside[0]) * spectrum.windows < CLEARLY:
        best, enough = beside, LIKELIER
    likelihood, cutoff = best[0] * spectrum.windows, best[1]
    gained = likelihood - fits[0].best(())[0] * spectrum.windows
    steeper = (other[0] - best[0]) * spectrum.windows > CLEARLY
    # the power above the cut-off goes on falling, instead of ending on the noise of a sensor
    near = above.power[(above.frequency > cutoff) & (above.frequency < 1.5 * cutoff)]
    falls_far = bool(near.size) and np.median(near) > FALLEN * np.median(above.power[-12:])
    if gained < enough or cutoff > HIGHEST or not falls_far or steeper:
        return None
    density = best[3] * above.power.max() / (2 * (len(spectrum.power) - 1)) / WINDOW_POWER
    return RecordedFilter(cutoff * rate_hz, likelihood, best[2], float(np.sqrt(density)))


def mean_spectrum(trials: Sequence[Values]) -> Spectrum | None:
    """Power spectrum of a channel, averaged over windows that overlap by half; None where all trials are too short.

    trials each (sample,): NaN where nothing was measured: a window takes the longest stretch without any
    """
    stretches = [trial[first:end] for trial in trials for first, end in runs(np.isfinite(trial))]
    length = min(max((len(stretch) for stretch in stretches), default=0), WINDOW)
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
    return Spectrum(np.arange(length // 2 + 1) / length, np.mean(powers, axis=0), len(powers))


def _may_be_filtered(spectrum: Spectrum, trials: Sequence[Values]) -> bool:
    """Whether the power falls up to half the rate, or ends on the floor of the digits that were written."""
    quarter = float(np.median(spectrum.power[(spectrum.frequency > 0.2) & (spectrum.frequency < 0.28)]))
    end = float(np.median(spectrum.power[(spectrum.frequency > 0.42) & (spectrum.frequency < 0.48)]))
    if quarter > FALLING * end or end < SPREAD * float(spectrum.power.max()):
        return True
    steps = np.abs(np.concatenate([np.diff(finite_values(trial)) for trial in trials]))
    step = float(steps[steps > 0].min()) if (steps > 0).any() else 0.0
    length = 2 * (len(spectrum.frequency) - 1)
    return end < ROUNDED * step**2 / 12 * length * WINDOW_POWER


class _Fit:
    """Whittle's likelihood of signal and white noise behind a filter, above a floor.

    The numbers: logarithms of the noise, of the signal at the first line, of its decay, of the floor, of the cut-off.
    """

    def __init__(self, spectrum: Spectrum, shape: Values, order: int) -> None:
        self.frequency, self.shape, self.order = spectrum.frequency, shape, order
        self.power = np.maximum(spectrum.power / spectrum.power.max(), LEAST)
        self.tan, self.beyond = np.tan(np.pi * spectrum.frequency), spectrum.frequency - spectrum.frequency[0]

    def best(self, cutoff: tuple[float, ...], held: bool = False) -> tuple[float, float, float, float]:
        """Likelihood of a window, cut-off (sought, or held), signal over noise there, noise; or of no filter."""
        from scipy.optimize import minimize

        begun = self._begun(cutoff)
        bounds = (*BOUNDS[:4], (begun[4], begun[4])) if held else BOUNDS[: len(begun)]
        optimum = minimize(self._misfit, begun, method="L-BFGS-B", jac=True, bounds=bounds, options={"maxiter": 200})
        noise, signal, decay, _ = optimum.x[:4]
        at = float(np.exp(optimum.x[4])) if cutoff else float(self.frequency[-1])
        shape = float(np.interp(at, self.frequency, self.shape))
        over = signal - noise - np.exp(decay) * (at - self.frequency[0]) + np.log(max(shape, 1e-300))
        return -float(optimum.fun), at, float(np.exp(np.clip(over, -99, 99))), float(np.exp(noise))

    def _begun(self, cutoff: tuple[float, ...]) -> Values:
        low = self.frequency < 2 * cutoff[0] if cutoff else np.zeros(len(self.power), bool)
        level = np.log(np.median(self.power[low] if low.any() else self.power))
        floor = np.log(np.median(self.power[-12:]))
        begun = np.array([level, np.log(self.power[:3].mean()), np.log(100.0), floor, *np.log(cutoff)])
        return np.clip(begun, *np.array(BOUNDS[: len(begun)]).T)

    def _misfit(self, values: Values) -> tuple[float, Values]:
        """Minus the log likelihood and its slopes."""
        passed, steeper = self._passband(values[4:])
        decay = np.exp(values[2]) * self.beyond
        noise, signal = np.exp(values[0]) * passed, np.exp(values[1] - decay) * self.shape * passed
        floor = np.exp(values[3])
        expected = noise + signal + floor
        over = 1 / expected - self.power / expected**2
        slopes = [noise, signal, -decay * signal, np.full(len(expected), floor)]
        slopes += [] if steeper is None else [(noise + signal) * steeper]
        return float(np.sum(np.log(expected) + self.power / expected)), np.array([over @ slope for slope in slopes])

    def _passband(self, cutoff: Values) -> tuple[Values, Values | None]:
        """What the filter passes of the power, and by which share that grows with the logarithm of the cut-off."""
        if not len(cutoff):
            return np.ones(len(self.power)), None
        at = np.exp(cutoff[0])
        ratio = (self.tan / np.tan(np.pi * at)) ** (2 * self.order)
        steeper = 4 * self.order * ratio / (1 + ratio) * 2 * np.pi * at / np.sin(2 * np.pi * at)
        return (1 + ratio) ** -2.0, steeper
