"""What chapter 3 learns from: a true trajectory, measured with noise and smoothed, in two parts."""

from __future__ import annotations

from dataclasses import dataclass, replace
from typing import Literal

import numpy as np
from numpy.typing import NDArray
from scipy.signal import butter, lfilter, sosfiltfilt, welch

from gaitdisc.errors import SamplingError

from .system import System

NoiseKind = Literal["normal", "student_t", "outliers", "coloured", "multiplicative"]
NOISE_KINDS: tuple[NoiseKind, ...] = ("normal", "student_t", "outliers", "coloured", "multiplicative")
FREEDOM = 3  # degrees of Student's t: its variance is finite, its fourth moment is not
OUTLYING, FARTHER = 0.02, 10.0  # share of the samples, and how many times farther these are thrown
MEMORY_S = 0.1  # after which coloured noise has forgotten all but 1/e
ORDER = 4
HIGH_BAND = 0.75  # of half the rate: nothing but noise is looked for above
ABOVE, NEIGHBOURS, MARGIN = 5.0, 5, 1.5
EDGE_PERIODS = 1.8  # of the cut-off, over which the filter's ends are not to be trusted (as in `signals.butterworth`)
STARTS_SEED, OTHER_NOISE = 41, 1000  # of further starts; what is added to the seed of their noise
LEAST_SAMPLES = 60  # a training part shorter than this carries no smoothing and no inner block


def drawn_noise(
    kind: NoiseKind, clean: NDArray[np.float64], size: NDArray[np.float64], dt_s: float, rng: np.random.Generator
) -> NDArray[np.float64]:
    """Noise of one standard deviation whatever its kind, (sample, channel)."""
    if kind == "student_t":
        return size / np.sqrt(FREEDOM / (FREEDOM - 2)) * rng.standard_t(FREEDOM, clean.shape)
    noise = size * rng.standard_normal(clean.shape)
    if kind == "outliers":
        far = np.where(rng.random(clean.shape) < OUTLYING, FARTHER, 1.0)
        return noise * far / np.sqrt(1 + OUTLYING * (FARTHER**2 - 1))
    if kind == "coloured":
        kept = np.exp(-dt_s / MEMORY_S)
        first = kept * size * rng.standard_normal((1, clean.shape[1]))
        return lfilter([np.sqrt(1 - kept**2)], [1.0, -kept], noise, axis=0, zi=first)[0]
    if kind == "multiplicative":
        return noise * np.abs(clean) / np.sqrt(np.mean(clean**2, axis=0))
    return noise


def smoothed(values: NDArray[np.float64], rate_hz: float, cutoff_hz: float | None = None) -> NDArray[np.float64]:
    """Low-passed channels, (sample, channel)."""
    columns = []
    for column in np.asarray(values, float).T:
        cutoff = noise_cutoff_hz(column, rate_hz) if cutoff_hz is None else cutoff_hz
        sections = butter(ORDER, cutoff, fs=rate_hz, output="sos")
        padding = min(len(column) - 2, int(np.ceil(3 * rate_hz / cutoff)))
        columns.append(np.asarray(sosfiltfilt(sections, column, padtype="odd", padlen=padding)))
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


@dataclass(frozen=True)
class Conditions:
    """How a system is recorded and tested; the defaults are the text's, with what it leaves open done right."""

    noise: float = 0.0  # standard deviation of the noise, as a share of each channel's own, or in its unit
    seed: int = 0
    absolute: bool = False  # the noise is in each channel's unit, as in the published code
    dt_s: float = 0.01  # between samples, and of the record [s]
    duration_s: float = 50.0  # between samples, and of the record [s]
    train_share: float = 0.6  # share of the record that is learned from
    # as the published code: 4 Hz filter where there is noise, central differences, each forecast starts from the last
    # measured sample, and the truth that it is compared with is run again from there. Otherwise: a cut-off where the
    # noise begins, the flow of the known model in place of a derivative, starts and truth of the trajectory
    published: bool = False
    kind: NoiseKind = "normal"
    trajectories: int = 1
    sacrificed_s: float = 0.0


@dataclass(frozen=True, eq=False)
class Record:
    """Truth and measurement of one run."""

    system: System
    conditions: Conditions
    time: NDArray[np.float64]  # (sample,) [s], even
    truth: NDArray[np.float64]  # (sample, state), x0 of Eq. 3.2
    measured: NDArray[np.float64]  # (sample, channel), y of Eqs. 3.3 and 3.15
    filtered: NDArray[np.float64]  # (training sample, channel), measured in the training part, smoothed
    split: int
    others: tuple[Record, ...] = ()  # from other starts, learned from as well; their training parts alone are looked at

    def start(self, forecast: bool) -> NDArray[np.float64]:
        """State that the known and the augmented model begin from, (state,)."""
        if not forecast and self.system.assumed is not None:
            return self.system.assumed
        sample = self.split - 1 if forecast else 0
        complete = len(self.system.channels) == len(self.system.states)
        return self.filtered[sample] if self.conditions.published and complete else self.truth[sample]

    def target(self, forecast: bool) -> NDArray[np.float64]:
        """Noise-free channels that a part is compared with, (sample, channel)."""
        part = slice(self.split - 1, None) if forecast else slice(0, self.split)
        states = self.truth[part]
        if self.conditions.published:
            states = self.system.true.run(self.start(forecast)[None], self.conditions.dt_s, len(states) - 1)[0]
        return states @ self.system.observation.T

    def beginning_of_forecast(self, start: NDArray[np.float64]) -> Record:
        """What of the forecast is sacrificed, as a record of its own, in which the known model begins at a start."""
        made = self.conditions
        count = round(made.sacrificed_s / made.dt_s) + 1
        last = self.split - 1 + count
        if count < LEAST_SAMPLES or last >= len(self.time):
            raise SamplingError(
                f"what is sacrificed of a forecast has {LEAST_SAMPLES} samples at least, and leaves some to test on",
                f"{made.sacrificed_s:g} s have {count} of the forecast's {len(self.time) - self.split + 1}",
                "Change sacrificed_s.",
            )
        part = slice(self.split - 1, last)
        measured = self.measured[part]
        filtered = smoothed(measured, 1.0 / made.dt_s) if made.noise else measured
        system = replace(self.system, assumed=start)
        time = self.time[part] - self.time[self.split - 1]
        return Record(system, made, time, self.truth[part], measured, filtered, count)


def recorded(system: System, conditions: Conditions) -> Record:
    """Run the true system and measure it."""
    steps = round(conditions.duration_s / conditions.dt_s)
    split = round(conditions.train_share * steps) + 1
    if split < LEAST_SAMPLES:
        raise SamplingError(
            f"the training part of a record needs {LEAST_SAMPLES} samples",
            f"{conditions.duration_s:g} s at {conditions.dt_s:g} s give {split}, {LEAST_SAMPLES - split} too few",
            "Record longer, or sample faster.",
        )
    truth = system.true.run(system.start[None], conditions.dt_s, steps)[0]
    if not np.isfinite(truth).all():
        when = conditions.dt_s * int(np.argmin(np.isfinite(truth).all(axis=1)))
        raise SamplingError(
            "a true trajectory stays finite", f"{system.name!r} leaves every bound at {when:g} s", "Change its start."
        )
    clean = truth @ system.observation.T
    size = conditions.noise * (np.ones(clean.shape[1]) if conditions.absolute else clean.std(axis=0))
    rng = np.random.default_rng(conditions.seed)
    measured = clean + drawn_noise(conditions.kind, clean, size, conditions.dt_s, rng)
    time = conditions.dt_s * np.arange(steps + 1.0)
    training = measured[:split]
    if conditions.noise:
        training = smoothed(training, 1.0 / conditions.dt_s, 4.0 if conditions.published else None)
    others = _from_other_starts(system, conditions, truth)
    return Record(system, conditions, np.asarray(time, float), truth, measured, training, split, others)


def _from_other_starts(system: System, conditions: Conditions, truth: NDArray[np.float64]) -> tuple[Record, ...]:
    """Further records, their starts drawn evenly from where the first one went, one after the other."""
    low, high = truth.min(axis=0), truth.max(axis=0)
    found = []
    for number in range(1, conditions.trajectories):
        start = np.random.default_rng([STARTS_SEED, number]).uniform(low, high)
        seed = conditions.seed + OTHER_NOISE * number
        found.append(recorded(replace(system, start=start), replace(conditions, seed=seed, trajectories=1)))
    return tuple(found)
