"""Stock PySINDy as a tool that finds a missing effect: it reads a simulation and a table, and names terms.

    python benchmarks/stock_pysindy.py SIMULATION.toml MEASURED.csv --out DIR --how sweep|ensemble|weak

The target is what the simulation leaves of the measured rate of each equation with a port. The library is the
catalogue of gaitdisc, thresholds, delays and phases on a grid, and the slope by each parameter: more than PySINDy
brings of its own. Columns have unit size; the threshold is swept and the Bayesian criterion takes one. Errors of
sensors are out of its reach by construction. It writes discovery.json and augmented.toml as `gaitdisc discover` does.
"""

from __future__ import annotations

import sys
from pathlib import Path

sys.path.insert(0, str(Path(__file__).parents[1] / "studies"))
from command_line import argument, command_line

GIVEN = command_line(
    __name__,
    __doc__,
    argument("simulation", "the simulation, TOML", type=Path),
    argument("measured", "the trials, CSV", type=Path),
    argument("--out", "folder that gets the answer", type=Path, required=True),
    argument("--how", "way of choosing terms", "sweep", choices=("sweep", "ensemble", "weak")),
)  # before the slow imports

import json
from dataclasses import dataclass
from typing import Any

import numpy as np
import pysindy as ps
from numpy.typing import NDArray

from gaitdisc.discovery.candidate import Candidate, candidates_of
from gaitdisc.discovery.catalogue import known_shapes
from gaitdisc.discovery.places import Place, driven_state, kinematic_rates, places_of
from gaitdisc.simulation.evaluating import Points, evaluate
from gaitdisc.simulation.measured import Measured
from gaitdisc.simulation.measured_table import read_measured
from gaitdisc.simulation.parts import Term
from gaitdisc.simulation.running import compile_simulation
from gaitdisc.simulation.simulation import Simulation
from gaitdisc.simulation.simulation_file import read_simulation
from gaitdisc.simulation.writing import write_simulation

THRESHOLDS = np.logspace(-2, 0, 20)
QUANTILES, DELAYS_S, PHASES, WIDTH = (0.2, 0.35, 0.5, 0.65, 0.8), (0.02, 0.05, 0.1, 0.2), np.arange(0.0, 1.0, 0.1), 0.08
BAGS, WINDOWS, ALIKE, SLOPE = 20, 100, 0.9999, 1e-4
Values = NDArray[np.float64]


@dataclass(frozen=True, eq=False)
class Trial:
    """Smoothed states, their rates and the inputs of one trial."""

    time: Values
    states: Values
    rates: Values
    points: Points


@dataclass(frozen=True, eq=False)
class Column:
    """One column of the library: whose it is, how it is written, its values trial by trial."""

    candidate: Candidate
    term: str
    values: list[Values]


def trials_of(simulation: Simulation, measured: Measured) -> list[Trial]:
    """States by smoothed finite differences, PySINDy's own; an unmeasured rate is the slope of its position."""
    names = [state.name for state in simulation.states]
    rate_of = kinematic_rates(simulation, compile_simulation(simulation))
    slope: Any = ps.SmoothedFiniteDifference()
    found = []
    for number in range(len(measured.trials)):
        time, count = measured.time(number), int(measured.samples[number])
        states = np.zeros((count, len(names)))
        for channel, (_, text) in enumerate(simulation.observations):
            if text.strip() in names:
                states[:, names.index(text.strip())] = measured.observed[number, :count, channel]
        seen = {text.strip() for _, text in simulation.observations}
        for position, rate in rate_of.items():
            if rate not in seen:
                states[:, names.index(rate)] = slope(states[:, [names.index(position)]], time)[:, 0]
        rates = slope(states, time)
        smooth = np.asarray(slope.smoothed_x_)
        points = Points(time, smooth, measured.drive.inputs[number, :count], rate=measured.rate)
        found.append(Trial(time, states, rates, points))
    return found


def columns_at(simulation: Simulation, place: Place, trials: list[Trial]) -> list[Column]:
    """Library of one place, in the unit of its equation; of columns that are alike, the simplest statement stays."""
    row, found = row_of(simulation, place), []
    still = rates_at(simulation, row, trials)
    pushed = rates_at(simulation.with_effect(Term(place.name, place.kind, "push", "1")), row, trials)
    gains = [one - other for one, other in zip(pushed, still, strict=True)]
    pooled = np.concatenate([trial.points.x for trial in trials])
    everywhere = Points(np.zeros(len(pooled)), pooled, np.concatenate([trial.points.u for trial in trials]))
    for candidate in candidates_of(simulation, (place,), known_shapes()):
        if candidate.verdict == "wrong_parameter":
            step = SLOPE * max(abs(candidate.value), 1e-3)
            moved = rates_at(simulation.with_values({candidate.place: candidate.value + step}), row, trials)
            slopes = [(one - other) / step for one, other in zip(moved, still, strict=True)]
            found.append(Column(candidate, "", slopes))
        if candidate.verdict != "missing_physics" or "frequencies" in (candidate.constants or {}).values():
            continue
        for numbers in grid(candidate, simulation, everywhere):
            for piece in candidate.pieces_at(numbers):
                values = [
                    gain * evaluate(simulation, piece, one.points) for gain, one in zip(gains, trials, strict=True)
                ]
                found.append(Column(candidate, piece, values))
    kept: list[Column] = []
    for column in found:
        values = np.concatenate(column.values)
        if np.isfinite(values).all() and values.any() and not any(like(values, np.concatenate(k.values)) for k in kept):
            kept.append(column)
    return kept


def like(one: Values, other: Values) -> bool:
    """Whether two columns are the same but for a factor."""
    return bool(abs(one @ other) > ALIKE * np.linalg.norm(one) * np.linalg.norm(other))


def grid(candidate: Candidate, simulation: Simulation, everywhere: Points) -> list[dict[str, str]]:
    """Numbers inside a shape, on a grid."""
    kinds = candidate.constants or {}
    if not kinds:
        return [{}]
    if "c" in kinds:
        return [{"c": f"{phase:.2f}", "w": f"{WIDTH}"} for phase in PHASES]
    (slot, kind), *_ = kinds.items()
    if kind == "delays":
        return [{slot: f"{seconds}"} for seconds in DELAYS_S]
    x = evaluate(simulation, candidate.role, everywhere)
    return [{slot: f"{np.quantile(np.abs(x) if 'half' in kind else x, share):.6g}"} for share in QUANTILES]


def rates_at(simulation: Simulation, row: int, trials: list[Trial]) -> list[Values]:
    """Rate of one state as the simulation has it along the measured states, trial by trial."""
    machine = compile_simulation(simulation)
    return [machine.rates(one.time, one.points.x, one.points.u, machine.defaults)[:, row] for one in trials]


def row_of(simulation: Simulation, place: Place) -> int:
    """Number of the state whose equation a place moves."""
    machine = compile_simulation(simulation)
    target = driven_state(simulation, machine, place.name) if place.kind == "port" else place.name
    return [state.name for state in simulation.states].index(target)


def selected(library: Values, target: Values, how: str) -> Values:
    """Coefficients of the library (column,): the threshold is the Bayesian criterion's."""
    sizes, size = np.sqrt((library**2).mean(axis=0)), np.sqrt((target**2).mean())
    columns, aim = library / sizes, target / size
    best, least = np.zeros(library.shape[1]), len(aim) * np.log((aim**2).mean())
    for threshold in THRESHOLDS:
        optimizer: Any = ps.STLSQ(threshold=threshold, alpha=1e-6)
        if how == "ensemble":
            optimizer = ps.EnsembleOptimizer(optimizer, bagging=True, n_models=BAGS)
        optimizer.fit(columns, aim[:, None])
        found = np.asarray(optimizer.coef_)[0]
        if how == "ensemble":
            bags = np.asarray(optimizer.coef_list)[:, 0]
            found = np.where((bags != 0).mean(axis=0) > 0.5, np.median(bags, axis=0), 0.0)
        rest = aim - columns @ found
        criterion = len(aim) * np.log(max((rest**2).mean(), 1e-300)) + np.count_nonzero(found) * np.log(len(aim))
        if criterion < least:
            best, least = found, criterion
    return best * size / sizes


def strongly(columns: list[Column], row: int, still: list[Values], trials: list[Trial]) -> tuple[Values, Values]:
    """Library (sample, column) and what the simulation leaves of the measured rate (sample,)."""
    target = np.concatenate([one.rates[:, row] - rate for one, rate in zip(trials, still, strict=True)])
    return np.column_stack([np.concatenate(column.values) for column in columns]), target


def weakly(columns: list[Column], row: int, still: list[Values], trials: list[Trial]) -> tuple[Values, Values]:
    """The same, integrated against PySINDy's test functions, which moves the derivative from the data to them."""
    libraries, targets = [], []
    for number, trial in enumerate(trials):
        np.random.seed(number)  # noqa: NPY002  PySINDy draws its windows from the global state
        weak = ps.WeakPDELibrary(ps.IdentityLibrary(), spatiotemporal_grid=trial.time, K=WINDOWS)
        signals = np.column_stack([still[number], *(column.values[number] for column in columns)])
        integrals = np.asarray(weak.fit_transform([signals])[0])
        rate = np.asarray(weak.convert_u_dot_integral(trial.states[:, [row]]))[:, 0]
        libraries.append(integrals[:, 1:])
        targets.append(rate - integrals[:, 0])
    return np.vstack(libraries), np.concatenate(targets)


def named(simulation: Simulation, measured: Measured, how: str) -> list[tuple[Column, float]]:
    """Columns that stay, with their coefficients."""
    trials = trials_of(simulation, measured)
    found = []
    for place in places_of(simulation, compile_simulation(simulation)):
        columns, row = columns_at(simulation, place, trials), row_of(simulation, place)
        still = rates_at(simulation, row, trials)
        library, target = (weakly if how == "weak" else strongly)(columns, row, still, trials)
        factors = selected(library, target, how)
        found += [(column, factor) for column, factor in zip(columns, factors, strict=True) if factor]
    return found


def write(simulation: Simulation, terms: list[tuple[Column, float]], out: Path) -> None:
    """Write discovery.json and augmented.toml."""
    effects = {}
    for column, factor in terms:
        candidate = column.candidate
        effects[(candidate.kind, candidate.place, candidate.name)] = candidate.verdict
        if candidate.verdict == "wrong_parameter":
            simulation = simulation.with_values({candidate.place: simulation.values()[candidate.place] + factor})
        else:
            term = Term(candidate.place, candidate.kind, candidate.name, f"{factor:.6g}*({column.term})")
            simulation = simulation.with_effect(term)
    verdict = next(iter(effects.values()), "no_gap")
    listed = [{kind: place, "name": name} for kind, place, name in effects]
    out.mkdir(parents=True, exist_ok=True)
    (out / "discovery.json").write_text(json.dumps({"verdict": verdict, "effects": listed}), encoding="utf-8")
    write_simulation(simulation, out / "augmented.toml")


if __name__ == "__main__":
    model = read_simulation(GIVEN.simulation)
    write(model, named(model, read_measured(GIVEN.measured, model), GIVEN.how), GIVEN.out)
