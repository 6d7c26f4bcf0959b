"""One cell: error signal, fit, augmented model, how well that does; method, approach and system are its arguments."""

from __future__ import annotations

import time as clock
from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace

import numpy as np
import pandas as pd
from numpy.typing import NDArray
from threadpoolctl import threadpool_limits

from gaitdisc.errors import GaitdiscError, TrainingError
from gaitdisc.model import Model

from .augmented_run import BOUND, on_states, with_learned_rates
from .methods import OF_TIME, Method, MethodSettings, fitted
from .record import (
    APPROACHES,
    Approach,
    Conditions,
    Record,
    System,
    error_samples,
    known_rates_samples,
    one_after_another,
    recorded,
    refined_samples,
)
from .sindy import Sindy
from .starts import forecast_start

METHODS = ("sindy", "esindy", "wsindy", "dmd", "exactdmd", "bopdmd", "gp", "gpm", "nn")
RECONSTRUCTION, ORACLE, FORECAST = PARTS = ("reconstruction", "oracle forecast", "forecast")
PART_WORDS = {RECONSTRUCTION: "reconstruction", ORACLE: "forecast, oracle start", FORECAST: "forecast, estimated start"}


@dataclass(frozen=True, eq=False)
class PartAccuracy:
    """Known and augmented model against the truth over one part of a record."""

    time: NDArray[np.float64]  # (sample,) [s], since the part's start
    truth: NDArray[np.float64]  # (sample, channel), Noise-free; NaN from where a model diverged
    known: NDArray[np.float64]  # (sample, channel), Noise-free; NaN from where a model diverged
    augmented: NDArray[np.float64]  # (sample, channel), Noise-free; NaN from where a model diverged
    diverged_s: float | None  # when the augmented model left every bound [s since the part's start]
    begins_s: float = 0.0  # when the part begins in its record [s]

    def rmse(self, model: str, until_s: float | None = None) -> NDArray[np.float64]:
        """Root mean square error, (channel,) [channel's unit]; NaN if the model diverged before."""
        last = len(self.time) if until_s is None else int(np.searchsorted(self.time, until_s + 1e-9, side="right"))
        return np.sqrt(np.mean((getattr(self, model)[:last] - self.truth[:last]) ** 2, axis=0))

    def accuracy(self, clipped: bool = False, until_s: float | None = None) -> NDArray[np.float64]:
        """100 (1 - RMSE augmented / RMSE known), (channel,) [%]; NaN if the augmented model diverged."""
        known, augmented = self.rmse("known", until_s), self.rmse("augmented", until_s)
        with np.errstate(all="ignore"):
            found = 100 * (1 - augmented / np.where(known > 0, known, np.nan))
        return np.clip(found, -100, 100) if clipped else found

    def change(self, horizons_s: Sequence[float]) -> NDArray[np.float64]:
        """Median over channels of the percent change in RMSE within each horizon (Fig. 3.9), (horizon,) [%]."""
        return np.array([np.median(self.accuracy(until_s=each)) for each in horizons_s])

    def valid_s(self, model: str, tolerance: float = 0.4) -> float:
        """Time until the error first exceeds a share of the truth's standard deviation [s]."""
        error = (getattr(self, model) - self.truth) / self.truth.std(axis=0)
        beyond = ~(np.sqrt(np.mean(error**2, axis=1)) <= tolerance)
        return float(self.time[int(np.argmax(beyond))] if beyond.any() else self.time[-1])

    def first_jump_s(self, channel: int = 0) -> float:
        """Time at which the truth first changes its sign, where an attractor's lobe is left [s]."""
        turned = np.sign(self.truth[:, channel]) != np.sign(self.truth[0, channel])
        return float(self.time[int(np.argmax(turned))] if turned.any() else self.time[-1])


@dataclass(frozen=True, eq=False)
class DiscrepancyCell:
    """What one method made of one error signal."""

    system: str
    method: str
    approach: str
    variant: str
    noise: float  # share of each channel's standard deviation, or its unit in the published variant
    seed: int
    channels: tuple[str, ...]
    # `reconstruction`: the training part, from the true first state. `oracle forecast`: from the noise-free true state
    # at the end of the training part, which no user has. `forecast`: from that state as it is estimated from the noisy
    # measurement. Empty where nothing was fitted
    parts: dict[str, PartAccuracy]
    fit_s: float  # [s], of a core, to fit, and to estimate the start and run the augmented model over all parts
    run_s: float  # [s], of a core, to fit, and to estimate the start and run the augmented model over all parts
    terms: str = ""  # what was found, for a method that says so
    refused: str = ""
    units: tuple[str, ...] = ()  # of the states, of which the channels are the first; empty where they have none

    @property
    def samples(self) -> int:
        """Length of the training part; 0 where nothing was fitted."""
        return len(self.parts["reconstruction"].time) if "reconstruction" in self.parts else 0

    @property
    def dt_s(self) -> float:
        """Step between samples [s]; NaN where nothing was fitted."""
        part = self.parts.get("reconstruction")
        return round(float(np.diff(part.time[:2])[0]), 9) if part else float("nan")


def cells_table(cells: Sequence[DiscrepancyCell]) -> pd.DataFrame:
    """Return the numbers of all cells, one row a cell, part and channel."""
    rows = []
    for cell in cells:
        names = ("system", "method", "approach", "variant", "noise", "seed", "dt_s", "samples")
        head = {name: getattr(cell, name) for name in names}
        tail = {name: getattr(cell, name) for name in ("fit_s", "run_s", "terms", "refused")}
        if not cell.parts:
            rows.append(head | tail)
        for part, found in cell.parts.items():
            known, augmented = found.rmse("known"), found.rmse("augmented")
            accuracy, clipped = found.accuracy(), found.accuracy(clipped=True)
            for k, channel in enumerate(cell.channels):
                row = {"part": part, "channel": channel, "rmse_known": known[k], "rmse_augmented": augmented[k]}
                row |= {"accuracy": accuracy[k], "clipped": clipped[k], "diverged_s": found.diverged_s}
                row |= {"valid_s": found.valid_s("augmented"), "valid_known_s": found.valid_s("known")}
                rows.append(head | row | tail)
    return pd.DataFrame(rows)


PUBLISHED_THRESHOLDS = {"dynamics": 0.0095, "state": 0.046}
NOISES = (0.0, 0.001, 0.01, 0.1)
WARMING = 600  # samples
ALL_METHODS: tuple[Method, ...] = ("sindy", "dmd", "bopdmd", "gp", "nn")
FOUR_METHODS: tuple[Method, ...] = ("sindy", "dmd", "gp", "nn")


def cell_of(
    record: Record, method: Method, approach: Approach, settings: MethodSettings | None = None
) -> DiscrepancyCell:
    """Learn one error signal of a record by one method, and test the augmented model."""
    settings, published = settings or MethodSettings(), record.conditions.published
    if published and settings.threshold is None:
        settings = replace(settings, threshold=PUBLISHED_THRESHOLDS[approach])
    variant = "as published" if published else "right"
    return cell_by(record, method, approach, variant, lambda: learned_model(record, method, approach, settings))


def cell_by(
    record: Record, method: Method, approach: Approach, variant: str, fit: Callable[[], Model]
) -> DiscrepancyCell:
    """Fit, and test the augmented model."""
    made, system, begun = record.conditions, record.system, clock.process_time()
    head = (system.name, method, approach, variant, made.noise, made.seed, system.channels)
    try:
        with threadpool_limits(1):  # on matrices of this size, and beside other work, threads wait for each other
            learned = fit()
    except GaitdiscError as error:
        fit_s = clock.process_time() - begun
        return DiscrepancyCell(*head, {}, fit_s, 0.0, refused=str(error), units=system.units)
    fit_s, begun = clock.process_time() - begun, clock.process_time()
    with np.errstate(all="ignore"):
        parts = {name: part(record, learned, approach, name) for name in PARTS}
    run_s = clock.process_time() - begun
    return DiscrepancyCell(*head, parts, fit_s, run_s, terms_of(learned), units=system.units)


def learned_model(record: Record, method: Method, approach: Approach, settings: MethodSettings) -> Model:
    """Fit a method to an error signal; the dynamical error is measured a second time with what was learned first."""
    records, seed = [record, *record.others], record.conditions.seed
    if record.conditions.sacrificed_s:
        records.append(record.beginning_of_forecast(forecast_start(record, None, approach)))
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
    values, diverged = np.array(found.values), found.diverged_s
    lost = ~np.all(np.abs(values) < BOUND, axis=1)
    if lost.any():  # a correction that left every bound counts as diverged from there on, too
        first = int(np.argmax(lost))
        values[first:], diverged = np.nan, float(time[max(first - 1, 0)])
    since = None if diverged is None else diverged - float(time[0])
    return PartAccuracy(time - time[0], truth, known, values, since, float(time[0]))


def terms_of(learned: Model) -> str:
    """Terms of a learned model with their coefficients, by output; empty for a method without terms."""
    if not isinstance(learned, Sindy):
        return getattr(learned, "said", "")
    every = {output: learned.terms(output) for output in learned.outputs}
    sums = {
        output: " + ".join(f"{value:.3g}*{term}" for term, value in terms.items()) for output, terms in every.items()
    }
    return "; ".join(f"{output}: {said}" for output, said in sums.items() if said) or "nothing"


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
    short = recorded(system, replace(conditions, noise=0.0, duration_s=WARMING * conditions.dt_s))
    for method in chosen[0]:
        cell_of(short, method, chosen[1][0], settings)
    found = []
    for noise in noises:
        for seed in seeds if noise else seeds[:1]:
            record = recorded(system, replace(conditions, noise=noise, seed=seed))
            for approach in chosen[1]:
                for method in chosen[0]:
                    found.append(cell_of(record, method, approach, settings))
                    computed(found[-1])
    return tuple(found)
