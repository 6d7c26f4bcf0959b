"""What a field lacks at a point, learned from the field there: one function for all points of a ring."""

from __future__ import annotations

import time as clock
from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from gaitdisc.compiled import compiled
from gaitdisc.errors import GaitdiscError
from gaitdisc.recording import Samples

from .burgers import slope_and_bend, smoothed_in_space
from .cell import part, terms_of
from .discrepancy_cell import PARTS, DiscrepancyCell
from .error_signal import error_samples
from .learned_rates import learned_rate
from .learned_term import LearnedTerm, learned_term
from .methods import Method, MethodSettings, fitted
from .record import Conditions, Record, recorded
from .system import System

LOCAL = ("u", "slope", "bend")  # of the field at a point
MOST_SAMPLES = 3000  # of all points at all times


@dataclass(frozen=True, eq=False)
class LocalField:
    """A learned function of value, slope and bend at a point, at every point; a `gaitdisc.model.Model`."""

    inputs: tuple[str, ...]  # values of the field; what is learned of each
    outputs: tuple[str, ...]  # values of the field; what is learned of each
    term: LearnedTerm
    said: str = ""  # terms of the learned function, where the method says any

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


def local_cell(record: Record, method: Method, settings: MethodSettings | None = None) -> DiscrepancyCell:
    """Learn the missing rate of a field as a function of the field at a point, and test the augmented model."""
    made, begun = record.conditions, clock.process_time()
    head = (record.system.name, method, "dynamics", "at each point", made.noise, made.seed, record.system.channels)
    try:
        samples = error_samples(record, "dynamics")
        learned = fit_local_field(samples, method, settings or MethodSettings(), made.seed)
    except GaitdiscError as error:
        return DiscrepancyCell(*head, {}, clock.process_time() - begun, 0.0, refused=str(error))
    fit_s, begun = clock.process_time() - begun, clock.process_time()
    with np.errstate(all="ignore"):
        parts = {name: part(record, learned, "dynamics", name) for name in PARTS}
    return DiscrepancyCell(*head, parts, fit_s, clock.process_time() - begun, learned.said)


def _points(fields: NDArray[np.float64]) -> NDArray[np.float64]:
    slope, bend = slope_and_bend(fields)
    return np.column_stack([each.ravel() for each in (fields, slope, bend)])


@compiled
def _at_every_point(kind, tables, points, found):
    for k in range(points.shape[0]):
        learned_rate(kind, tables, 0, points[k], found[k])
