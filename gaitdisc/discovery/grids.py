"""Where the search for a constant inside a shape begins: thresholds, delays, frequencies, phases."""

from dataclasses import dataclass
from itertools import product

import numpy as np

from gaitdisc.recording.arrays import Values

QUANTILES = {"": np.linspace(0.04, 0.96, 15), "low ": np.linspace(0.04, 0.44, 5), "high ": np.linspace(0.56, 0.96, 5)}
HALF_WIDTHS = np.linspace(0.08, 0.92, 9)
DELAYS_PER_PERIOD = np.linspace(0.02, 0.55, 20)
PHASES = np.linspace(0.025, 0.975, 20)
PHASE_WIDTHS = np.array([0.03, 0.06, 0.12, 0.25])
MOST_FREQUENCIES = 240
NOISE_FACTOR = 6.0  # times the median line of the spectrum is taken for noise


@dataclass(frozen=True)
class Rhythm:
    """The times of a record that grids are made from."""

    period: float  # the motion's main period [s]
    duration: float  # the longest trial [s]
    rate: float  # samples a second [Hz]

    @property
    def samples(self) -> float:
        """Samples of a period."""
        return self.period * self.rate


def find_rhythm(observed: Values, rate: float) -> Rhythm:
    """Read the main period off the measured channels (trial, sample, channel), NaN where a trial has ended; rate in Hz.

    >>> t = np.arange(1000) / 100
    >>> bool(abs(find_rhythm(np.sin(2 * np.pi * 0.5 * t)[None, :, None], 100).period - 2.0) < 0.1)
    True
    """
    periods = []
    for trial in observed:
        known = np.isfinite(trial)  # without the empty end, gaps bridged by straight lines
        length = int(np.flatnonzero(known.any(axis=1))[-1]) + 1
        at = np.arange(length)
        pairs = zip(trial[:length].T, known[:length].T, strict=True)
        filled = np.column_stack([np.interp(at, at[there], values[there]) for values, there in pairs])
        centred = filled - filled.mean(axis=0)
        centred = centred / np.maximum(centred.std(axis=0), 1e-12)
        power = (np.abs(np.fft.rfft(centred * np.hanning(len(filled))[:, None], axis=0)) ** 2).sum(axis=1)
        frequency = np.fft.rfftfreq(len(filled), 1 / rate)
        power[0] = 0.0
        power = np.maximum(power - NOISE_FACTOR * np.median(power), 0.0)
        periods.append(1 / max(float((frequency * power).sum() / max(power.sum(), 1e-300)), 1 / (len(filled) / rate)))
    return Rhythm(float(np.median(periods)), observed.shape[1] / rate, rate)


def grid(kind: str, along: Values, rhythm: Rhythm) -> Values:
    """Return where the search for one constant begins.

    kind: as in the catalogue: `quantiles of x` (`low` and `high`: of either half), `half widths of x`, `delays`,
        `frequencies`, `phases`, `phase widths`
    """
    if kind.endswith("quantiles of x"):
        return np.quantile(along, QUANTILES[kind.removesuffix("quantiles of x")])
    if kind == "half widths of x":
        return np.quantile(np.abs(along), HALF_WIDTHS)
    if kind == "delays":
        return delays(rhythm)
    if kind == "frequencies":
        spacing = np.pi / rhythm.duration
        most = min(MOST_FREQUENCIES, int(10 * np.pi / rhythm.period / spacing) + 8)
        return spacing * np.arange(2, most + 2, dtype=np.float64)
    return PHASES if kind == "phases" else PHASE_WIDTHS


def delays(rhythm: Rhythm, either_way: bool = False) -> Values:
    """Return the delays at which a search begins [s], to half a period; either way for a signal recorded late.

    >>> late = delays(Rhythm(1.0, 10.0, 100.0))
    >>> both = delays(Rhythm(1.0, 10.0, 100.0), either_way=True)
    >>> bool(late.min() > 0), sorted(both) == sorted([*late, *-late])
    (True, True)
    """
    late = np.maximum(DELAYS_PER_PERIOD * rhythm.period, 0.5 / rhythm.rate)
    return np.concatenate([late, -late]) if either_way else late


def cells(constants: dict[str, str], along: Values, rhythm: Rhythm) -> list[dict[str, float]]:
    """Return every combination of the constants' beginnings, for x along the run (sample,)."""
    axes = [grid(kind, along, rhythm) for kind in constants.values()]
    return [dict(zip(constants, (float(value) for value in cell), strict=True)) for cell in product(*axes)]
