"""Trials of a system driven by sums of sines, observed with noise: what studies let `discover` work on."""

from __future__ import annotations

from collections.abc import Sequence
from typing import NamedTuple

import numpy as np
import pandas as pd
from numpy.typing import NDArray
from scipy.signal import butter, sosfiltfilt

import gaitdisc as gd

RATE_HZ, SECONDS, TRIALS = 100.0, 8.0, 4
WAVES = 5  # sines in what drives a system


class Driven(NamedTuple):
    """What drives a system for how long: an amplitude for each input, frequencies of the sines, its starts."""

    sizes: tuple[float, ...]
    slowest_hz: float
    fastest_hz: float
    starts: tuple[float, int] = (0.0, 0)  # half width from which the first so many states are drawn
    seconds: float = SECONDS


class Sensed(NamedTuple):
    """How a record comes: noise as a share of each channel's spread, cut-off [Hz], 0 for none, and its channels."""

    noise: float
    lowpass_hz: float = 0.0
    channels: Sequence[str] = ()


def recorded(truth: gd.Simulation, driven: Driven, sensed: Sensed, rng: np.random.Generator) -> pd.DataFrame:
    """Trials of the true system as they come from a laboratory, a table; all channels where none is named."""
    time, names = np.arange(int(driven.seconds * RATE_HZ)) / RATE_HZ, [each.name for each in truth.inputs]
    sizes = list(zip(names, driven.sizes, strict=True))
    drives = [{name: _sines(rng, time, size, driven) for name, size in sizes} for _ in range(TRIALS)]
    half, some = driven.starts
    starts = np.zeros((TRIALS, len(truth.states)))
    if some:
        starts[:, :some] = rng.uniform(-half, half, (TRIALS, some))
    channels = list(sensed.channels) or [name for name, _ in truth.observations]
    runs = [gd.simulate(truth, time, *each).selected(channels) for each in zip(drives, starts.tolist(), strict=True)]
    seen = np.stack([run.values for run in runs])
    seen = seen + sensed.noise * seen.std(axis=(0, 1)) * rng.normal(size=seen.shape)
    if sensed.lowpass_hz:
        seen = sosfiltfilt(butter(2, sensed.lowpass_hz, fs=RATE_HZ, output="sos"), seen, axis=1)
    tables = [
        pd.DataFrame({"trial": trial, "time": time, **drive} | dict(zip(channels, values.T, strict=True)))
        for trial, (drive, values) in enumerate(zip(drives, seen, strict=True), 1)
    ]
    return pd.concat(tables, ignore_index=True)


def _sines(rng: np.random.Generator, t: NDArray[np.float64], size: float, driven: Driven) -> NDArray[np.float64]:
    frequencies = rng.uniform(driven.slowest_hz, driven.fastest_hz, WAVES)
    waves = np.sin(2 * np.pi * np.outer(t, frequencies) + rng.uniform(0, 2 * np.pi, WAVES))
    return (size * rng.uniform(0.3, 1.0, WAVES) * waves).sum(axis=1)
