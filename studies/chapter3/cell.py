"""One cell: error signal, fit, augmented model, judgement; method, approach and system are its arguments."""

from __future__ import annotations

import time as clock
from collections.abc import Callable, Sequence
from dataclasses import replace

import numpy as np
from threadpoolctl import threadpool_limits

from gaitdisc.errors import GaitdiscError, TrainingError
from gaitdisc.model import Model

from .augmented_run import AugmentedRun, on_states, with_learned_rates
from .discrepancy_cell import (
    FORECAST,
    PARTS,
    RECONSTRUCTION,
    DiscrepancyCell,
    PartAccuracy,
)
from .error_signal import (
    APPROACHES,
    Approach,
    error_samples,
    known_rates_samples,
    one_after_another,
    refined_samples,
)
from .methods import OF_TIME, Method, MethodSettings, fitted
from .record import Conditions, Record, recorded
from .sindy import Sindy
from .starts import forecast_start
from .system import System

PUBLISHED_THRESHOLDS = {"dynamics": 0.0095, "state": 0.046}
NOISES = (0.0, 0.001, 0.01, 0.1)
WARMING = 600  # samples
ALL_METHODS: tuple[Method, ...] = ("sindy", "dmd", "bopdmd", "gp", "nn")


def cell_of(
    record: Record, method: Method, approach: Approach, settings: MethodSettings | None = None
) -> DiscrepancyCell:
    """Learn one error signal of a record by one method, and test the augmented model."""
    made, settings = record.conditions, settings or MethodSettings()
    if made.published and settings.threshold is None:
        settings = replace(settings, threshold=PUBLISHED_THRESHOLDS[approach])
    variant, system = "as published" if made.published else "right", record.system
    head = (system.name, method, approach, variant, made.noise, made.seed, system.channels)
    begun = clock.process_time()
    try:
        with threadpool_limits(1):  # on matrices of this size, and beside other work, threads wait for each other
            learned = learned_model(record, method, approach, settings)
    except GaitdiscError as error:
        fit_s = clock.process_time() - begun
        return DiscrepancyCell(*head, {}, fit_s, 0.0, refused=str(error), units=system.units)
    fit_s, begun = clock.process_time() - begun, clock.process_time()
    parts = {name: part(record, learned, approach, name) for name in PARTS}
    run_s = clock.process_time() - begun
    return DiscrepancyCell(*head, parts, fit_s, run_s, terms_of(learned), units=system.units)


def learned_model(record: Record, method: Method, approach: Approach, settings: MethodSettings) -> Model:
    """Fit a method to an error signal; the dynamical error is measured a second time with what was learned first."""
    records, seed = learned_from(record, approach), record.conditions.seed
    if len(records) > 1 and method in (*OF_TIME, "wsindy"):
        raise TrainingError(
            "several records are learned from by methods that take samples in any order",
            f"{method} was given {len(records)}",
            "Take sindy, gp or nn, or one record.",
        )
    if method == "wsindy":
        if approach == "state":
            raise TrainingError(
                "the weak form of SINDy learns rates",
                "the residual of the states was given",
                "Take the approach `dynamics`, or `sindy`.",
            )
        return fitted(known_rates_samples(record), method, settings, seed)
    samples = [error_samples(each, approach, method in OF_TIME) for each in records]
    learned = fitted(one_after_another(samples), method, settings, seed)
    if approach == "state" or method in OF_TIME or record.conditions.published:
        return learned
    with np.errstate(all="ignore"):
        refined = [refined_samples(each, some, learned) for each, some in zip(records, samples, strict=True)]
    if not all(np.isfinite(some.y).all() for some in refined):
        return learned  # it drives the states out of every bound within a sample; the run will say when
    return fitted(one_after_another(refined), method, settings, seed)


def learned_from(record: Record, approach: Approach) -> tuple[Record, ...]:
    """The record, those from other starts, and the forecast's beginning where it is sacrificed."""
    if not record.conditions.sacrificed_s:
        return record, *record.others
    return record, *record.others, record.beginning_of_forecast(forecast_start(record, None, approach))


def part(record: Record, learned: Model, approach: Approach, name: str) -> PartAccuracy:
    """Accuracy of a learned model over the training part or the forecast.

    In the forecast as a user has it the known and the augmented model each begin where they fit the end of the noisy
    training part best; in the oracle forecast both begin at the noise-free true state.
    """
    system, made, forecast = record.system, record.conditions, name != RECONSTRUCTION
    time = record.time[record.split - 1 :] if forecast else record.time[: record.split]
    if name == FORECAST:
        known_start, start = forecast_start(record, None, approach), forecast_start(record, learned, approach)
        truth = record.truth[record.split - 1 :] @ system.observation.T
    else:
        known_start = start = record.start(forecast)
        truth = record.target(forecast)
    known = system.known.run(known_start[None], made.dt_s, len(time) - 1)[0][:, : len(system.channels)]
    if approach == "dynamics":
        found = with_learned_rates(system.known, learned, start, time)
    else:
        found = on_states(system, learned, start, time, summed=made.published and isinstance(learned, Sindy))
    bounded = _bounded(found, time)
    diverged = None if bounded.diverged_s is None else bounded.diverged_s - float(time[0])
    return PartAccuracy(time - time[0], truth, known, bounded.values, diverged, float(time[0]))


def _bounded(run: AugmentedRun, time: np.ndarray) -> AugmentedRun:
    """Let a correction that left every bound count as diverged from there on, too."""
    lost = ~np.all(np.abs(run.values) < 1e6, axis=1)
    if not lost.any():
        return run
    first = int(np.argmax(lost))
    values = np.array(run.values)
    values[first:] = np.nan
    return AugmentedRun(values, float(time[max(first - 1, 0)]))


def terms_of(learned: Model) -> str:
    """Terms of a learned model with their coefficients, by output; empty for a method without terms."""
    if not isinstance(learned, Sindy):
        return ""
    said = []
    for output in learned.outputs:
        terms = learned.terms(output)
        if terms:
            said.append(f"{output}: " + " + ".join(f"{value:.3g}*{term}" for term, value in terms.items()))
    return "; ".join(said) or "nothing"


def grid(
    system: System,
    conditions: Conditions,
    noises: Sequence[float] = NOISES,
    seeds: Sequence[int] = (0,),
    chosen: tuple[Sequence[Method], Sequence[Approach]] = (ALL_METHODS, APPROACHES),
    settings: MethodSettings | None = None,
    computed: Callable[[DiscrepancyCell], None] = lambda _: None,
) -> tuple[DiscrepancyCell, ...]:
    """Compute the cells; without noise one seed is enough.

    Before the first, each method is fitted to a short record, so that no cell's seconds hold importing and compiling.
    """
    _warmed(system, conditions, chosen, settings)
    found = []
    for noise in noises:
        for seed in seeds if noise else seeds[:1]:
            record = recorded(system, replace(conditions, noise=noise, seed=seed))
            for approach in chosen[1]:
                for method in chosen[0]:
                    found.append(cell_of(record, method, approach, settings))
                    computed(found[-1])
    return tuple(found)


def _warmed(
    system: System,
    conditions: Conditions,
    chosen: tuple[Sequence[Method], Sequence[Approach]],
    settings: MethodSettings | None,
) -> None:
    short = recorded(system, replace(conditions, noise=0.0, duration_s=WARMING * conditions.dt_s))
    for method in chosen[0]:
        cell_of(short, method, chosen[1][0], settings)
