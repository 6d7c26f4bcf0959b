"""Burgers' equation on a ring of points: a system with as many states as points (Eqs. 3.11, 3.12)."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from .system import System

POINTS, LENGTH = 256, 16.0  # of the text, and of the published code
LONGEST_STEP_S = 5e-3  # of Runge-Kutta order 4: the fastest wave decays with 253 /s at a viscosity of 0.1
BOUND = 1e6
HIGH_WAVES, ABOVE, MARGIN = 0.75, 5.0, 1.5  # as `smoothing`, over space: share of the waves that is noise alone


@dataclass(frozen=True)
class BurgersRates:
    """Du/dt = -u du/dx + viscosity d2u/dx2 - cubic u^3, periodic, by Fourier derivatives; a `system.Rates`."""

    viscosity: float = 0.1
    cubic: float = 0.0

    def __call__(self, x: NDArray[np.float64]) -> NDArray[np.float64]:
        """Rates (point, state) of fields (point, state)."""
        slope, bend = slope_and_bend(x)
        return -x * slope + self.viscosity * bend - self.cubic * x**3

    def run(self, starts: NDArray[np.float64], dt_s: float, steps: int) -> NDArray[np.float64]:
        """Fields (start, steps + 1, state); NaN from where one diverged."""
        found = np.full((len(starts), steps + 1, POINTS), np.nan)
        substeps = max(1, int(np.ceil(dt_s / LONGEST_STEP_S)))
        h, x = dt_s / substeps, np.array(starts, float)
        for sample in range(steps + 1):
            found[:, sample] = np.where(np.all(np.abs(x) < BOUND, axis=1)[:, None], x, np.nan)
            if not np.isfinite(found[:, sample]).any():
                return found
            for _ in range(substeps):
                one = self(x)
                two = self(x + 0.5 * h * one)
                three = self(x + 0.5 * h * two)
                x = x + h / 6 * (one + 2 * two + 2 * three + self(x + h * three))
        return found


def slope_and_bend(x: NDArray[np.float64]) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
    """First and second derivative in space of fields, by Fourier, (point, state) each."""
    waves = 2j * np.pi / LENGTH * np.arange(POINTS // 2 + 1)
    spectrum = np.fft.rfft(x, axis=1)
    return np.fft.irfft(waves * spectrum, POINTS, axis=1), np.fft.irfft(waves**2 * spectrum, POINTS, axis=1)


def smoothed_in_space(fields: NDArray[np.float64]) -> NDArray[np.float64]:
    """Fields without the waves that are noise alone, (sample, state).

    The noise's power is the median of that of the shortest quarter of the waves; waves up to half as many again as
    stand five times above it, over all samples, are kept.
    """
    spectrum = np.fft.rfft(fields, axis=1)
    power = np.mean(np.abs(spectrum) ** 2, axis=0)
    floor = np.median(power[int(HIGH_WAVES * len(power)) :])
    loud = np.flatnonzero(power > ABOVE * floor)
    spectrum[:, int(MARGIN * (loud[-1] if loud.size else 0)) + 1 :] = 0.0
    return np.fft.irfft(spectrum, POINTS, axis=1)


def places() -> NDArray[np.float64]:
    """Places of the points, (point,)."""
    return LENGTH * (np.arange(POINTS) / POINTS - 0.5)


def burgers(cubic: float, sign: float = -1.0) -> System:
    """System of Eqs. 3.11 and 3.12."""
    names = tuple(f"u{k:03d}" for k in range(POINTS))
    start = np.exp(sign * (places() + 2) ** 2)
    return System("Burgers' equation", names, BurgersRates(), BurgersRates(cubic=cubic), start, np.eye(POINTS))
