"""Trials of a system driven by sums of sines, observed with noise: what studies let `discover` work on."""

from __future__ import annotations

from collections.abc import Sequence
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray
from scipy.signal import butter, sosfiltfilt

import gaitdisc as gd
from gaitdisc.simulation.drive import Drive, Rows
from gaitdisc.simulation.measured import Measured
from gaitdisc.simulation.running import compile_simulation

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


def recorded(truth: gd.Simulation, driven: Driven, sensed: Sensed, rng: np.random.Generator) -> Measured:
    """Trials of the true system as they come from a laboratory; all channels where none is named."""
    t, machine = np.arange(int(driven.seconds * RATE_HZ)) / RATE_HZ, compile_simulation(truth)
    drive = Drive.of(
        [np.column_stack([_sines(rng, t, size, driven) for size in driven.sizes]) for _ in range(TRIALS)], RATE_HZ
    )
    half, states = driven.starts
    starts = np.zeros((TRIALS, len(machine.states)))
    if states:
        starts[:, :states] = rng.uniform(-half, half, (TRIALS, states))
    rows = Rows(np.arange(TRIALS), np.zeros(TRIALS, int), starts)
    seen, channels = machine.observe(drive, rows, machine.run(drive, rows, len(t) - 1)[0]), tuple(machine.observed)
    if sensed.channels:
        channels = tuple(sensed.channels)
        seen = seen[..., [machine.observed.index(name) for name in channels]]
    seen = seen + sensed.noise * seen.std(axis=(0, 1)) * rng.normal(size=seen.shape)
    if sensed.lowpass_hz:
        seen = sosfiltfilt(butter(2, sensed.lowpass_hz, fs=RATE_HZ, output="sos"), seen, axis=1)
    return Measured(drive, seen, tuple(str(trial + 1) for trial in range(TRIALS)), channels)


def _sines(rng: np.random.Generator, t: NDArray[np.float64], size: float, driven: Driven) -> NDArray[np.float64]:
    frequencies = rng.uniform(driven.slowest_hz, driven.fastest_hz, WAVES)
    waves = np.sin(2 * np.pi * np.outer(t, frequencies) + rng.uniform(0, 2 * np.pi, WAVES))
    return (size * rng.uniform(0.3, 1.0, WAVES) * waves).sum(axis=1)
