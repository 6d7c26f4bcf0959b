"""Burgers' equation on a ring of points (Eqs. 3.11, 3.12), and what it lacks, learned at each point."""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from gaitdisc.compiled import compiled
from gaitdisc.recording import Samples

from .augmented_run import BOUND, LearnedTerm, learned_rate, learned_term
from .cell import DiscrepancyCell, cell_by, terms_of
from .methods import Method, MethodSettings, fitted
from .record import LONGEST_STEP_S, Conditions, Record, System, error_samples, recorded, rk4_step

POINTS, LENGTH = 256, 16.0  # of the text, and of the published code
HIGH_WAVES, ABOVE, MARGIN = 0.75, 5.0, 1.5  # as `smoothing`, over space: share of the waves that is noise alone
LOCAL = ("u", "slope", "bend")  # of the field at a point
MOST_SAMPLES = 3000  # of all points at all times


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
                x = rk4_step(self, x, h)
        return found


def slope_and_bend(x: NDArray[np.float64]) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
    """First and second derivative in space of fields, by Fourier, (point, state) each."""
    waves, spectrum = 2j * np.pi / LENGTH * np.arange(POINTS // 2 + 1), np.fft.rfft(x, axis=1)
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


@dataclass(frozen=True, eq=False)
class LocalField:
    """A learned function of value, slope and bend at a point, at every point; a `gaitdisc.model.Model`."""

    inputs: tuple[str, ...]  # values of the field; what is learned of each
    outputs: tuple[str, ...]  # values of the field; what is learned of each
    term: LearnedTerm
    said: str  # terms of the learned function, where the method says any

    def __call__(self, x: NDArray[np.float64]) -> NDArray[np.float64]:
        """Outputs (sample, place) for fields (sample, place)."""
        points = _points(np.asarray(x, float))
        found = np.zeros((len(points), 1))
        _at_every_point(self.term.kind, self.term.tables, points, found)
        return found.reshape(np.shape(x))


def fit_local_field(samples: Samples, method: Method, settings: MethodSettings, seed: int = 0) -> LocalField:
    """Fit a method to value, slope and bend of fields.

    Of all points at all times 3,000 are drawn: neighbours in space and time hold the same.
    """
    points, error = _points(samples.x), samples.y.reshape(-1, 1)
    some = np.sort(np.random.default_rng(seed).choice(len(points), min(MOST_SAMPLES, len(points)), replace=False))
    when = samples.time[some // samples.x.shape[1]]
    drawn = Samples(points[some], error[some], LOCAL, ("error",), when, np.full(len(some), np.nan))
    learned = fitted(drawn, method, settings, seed)
    return LocalField(samples.inputs, samples.outputs, learned_term(learned, np.empty(0)), terms_of(learned))


def recorded_field(system: System, conditions: Conditions) -> Record:
    """Record of a field on a ring, its noise taken out over time and over space."""
    record = recorded(system, conditions)
    return replace(record, filtered=smoothed_in_space(record.filtered)) if conditions.noise else record


def local_cell(record: Record, method: Method) -> DiscrepancyCell:
    """Learn the missing rate of a field as a function of the field at a point, and test the augmented model."""

    def fit() -> LocalField:
        seed = record.conditions.seed
        return fit_local_field(error_samples(record, "dynamics"), method, MethodSettings(), seed)

    return cell_by(record, method, "dynamics", "at each point", fit)


def _points(fields: NDArray[np.float64]) -> NDArray[np.float64]:
    return np.column_stack([each.ravel() for each in (fields, *slope_and_bend(fields))])


@compiled
def _at_every_point(kind, tables, points, found):
    for k in range(points.shape[0]):
        learned_rate(kind, tables, 0, points[k], found[k])
