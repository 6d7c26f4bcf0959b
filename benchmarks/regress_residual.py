"""Three regressions of the residual that look for a missing effect: PySINDy's weak form, SINDy-PI, and forward BIC.

    python benchmarks/regress_residual.py SIMULATION.toml MEASURED.csv --out DIR --how weak|implicit|forward

The target is what the simulation leaves of the measured rates, all equations together. Each is given gaitdisc's
catalogue on the grids where its own search begins (effects with states of their own apart), the slope by each number,
inputs delayed or rescaled, and states smoothed, solved and differentiated as discover's first guess has them; samples
in gaps are left out. Errors of sensors are out of reach. The Bayesian criterion counts windows side by side as samples.
A parameter that stays within its bounds is no effect. It writes what `gaitdisc discover` writes.
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
    argument("--how", "regression", "forward", choices=("weak", "implicit", "forward")),
)  # before the slow imports

import json
from collections.abc import Iterator
from dataclasses import dataclass, replace
from typing import Any

import numpy as np
import pysindy as ps
from numpy.typing import NDArray

from gaitdisc.discovery.candidate import Candidate, list_candidates
from gaitdisc.discovery.catalogue import read_shapes
from gaitdisc.discovery.first_states import SHARE_OF_PERIOD, guess_states
from gaitdisc.discovery.grids import Rhythm, cells, delays, find_rhythm
from gaitdisc.discovery.places import Place, kinematic_rates, list_places
from gaitdisc.simulation.evaluating import Points, evaluate
from gaitdisc.simulation.measured import Measured
from gaitdisc.simulation.measured_table import read_measured
from gaitdisc.simulation.parts import Term
from gaitdisc.simulation.running import compile_simulation
from gaitdisc.simulation.simulation import Simulation
from gaitdisc.simulation.simulation_file import read_simulation
from gaitdisc.simulation.writing import write_simulation

THRESHOLDS, MOST = np.logspace(-3, 0, 10), 8  # of columns of unit size; terms of a forward path
EVERY = {"weak": 1, "forward": 1, "implicit": 3}  # of the grids' numbers: thresholds fail where columns are alike
WINDOWS, HALF_WINDOW = 100, 0.5  # PySINDy's, of each trial; half a window as a share of the main period
ALIKE, SLOPE, LEAST = 0.9999, 1e-4, 1e-9  # columns that are one; step of a slope; what is nothing
Values = NDArray[np.float64]


@dataclass(frozen=True, eq=False)
class Trial:
    """Smoothed states, their rates, the inputs, and which samples were measured, of one trial."""

    rates: Values
    points: Points
    known: NDArray[np.bool_]


@dataclass(frozen=True, eq=False)
class Column:
    """One column of the library: whose it is, the number inside an input's error, how it is written, its values."""

    candidate: Candidate
    number: float
    term: str
    values: Values


@dataclass(frozen=True, eq=False)
class Record:
    """What is regressed: the equations that an effect can enter, over all trials, one after the other."""

    simulation: Simulation
    places: tuple[Place, ...]
    rows: list[int]  # numbers of the states whose equations are more than kinematics
    rhythm: Rhythm
    trials: list[Trial]

    def rates(self, simulation: Simulation) -> Values:
        """Rates as a simulation has them along the measured states, row by row and trial by trial."""
        machine = compile_simulation(simulation)
        found = [machine.rates(one.points.t, one.points.x, one.points.u, machine.defaults) for one in self.trials]
        return np.concatenate([rates[:, row] for row in self.rows for rates in found])

    def with_input(self, name: str, gain: float, seconds: float) -> Record:
        """The same with one input rescaled and delayed."""
        which = [one.name for one in self.simulation.inputs].index(name)
        trials = []
        for one in self.trials:
            time, u = np.asarray(one.points.t), one.points.u.copy()
            u[:, which] = gain * np.interp(time - seconds, time, u[:, which])
            trials.append(replace(one, points=replace(one.points, u=u)))
        return replace(self, trials=trials)


def record_of(simulation: Simulation, measured: Measured) -> Record:
    """States as discover first guesses them; rates by PySINDy's smoothed differences over the same window."""
    rhythm, machine = find_rhythm(measured.observed, measured.rate), compile_simulation(simulation)
    window = max(int(SHARE_OF_PERIOD * rhythm.samples) // 2 * 2 + 1, 5)
    slope: Any = ps.SmoothedFiniteDifference(smoother_kws={"window_length": window, "polyorder": 3})
    rate_of = kinematic_rates(simulation, machine)
    guess = np.nan_to_num(guess_states(simulation, measured, rhythm.period, rate_of))
    trials = []
    for number, count in enumerate(measured.samples.astype(int)):
        time, states = measured.time(number), guess[number, :count]
        points = Points(time, states, measured.drive.inputs[number, :count], rate=measured.rate)
        known = np.asarray(np.isfinite(measured.observed[number, :count]).all(axis=1))
        trials.append(Trial(np.asarray(slope(states, time)), points, known))
    rows = [k for k, state in enumerate(simulation.states) if state.name not in rate_of]
    return Record(simulation, list_places(simulation, machine), rows, rhythm, trials)


def drawn(record: Record, every: int) -> Iterator[Column]:
    """Columns of the library over all samples, in the units of the equations."""
    simulation, still = record.simulation, record.rates(record.simulation)
    trials = record.trials
    pooled = np.concatenate([one.points.x for one in trials])
    everywhere = Points(np.zeros(len(pooled)), pooled, np.concatenate([one.points.u for one in trials]))
    gains = {
        one.name: record.rates(simulation.with_effect(Term(one.name, one.kind, "push", "1"))) - still
        for one in record.places
    }
    for candidate in list_candidates(simulation, record.places, read_shapes()):
        place = candidate.place
        if candidate.verdict == "wrong_parameter":
            step = SLOPE * max(abs(candidate.value), 1e-3)
            moved = record.rates(simulation.with_values({place: candidate.value + step}))
            yield Column(candidate, 0.0, "", (moved - still) / step)
        elif candidate.name == "input_gain":
            yield Column(candidate, 0.0, "", record.with_input(place, 2.0, 0.0).rates(simulation) - still)
        elif candidate.name == "input_delay":
            for seconds in delays(record.rhythm)[::every]:
                late = record.with_input(place, 1.0, seconds).rates(simulation) - still
                yield Column(candidate, float(seconds), "", late)
        elif candidate.verdict == "missing_physics" and not candidate.states:
            along = evaluate(simulation, candidate.role, everywhere) if candidate.role else np.zeros(1)
            for cell in cells(dict(candidate.constants or {}), along, record.rhythm)[::every]:
                for term in candidate.pieces_at({slot: f"{number:.6g}" for slot, number in cell.items()}):
                    values = np.concatenate([evaluate(simulation, term, one.points) for one in trials])
                    yield Column(candidate, 0.0, term, gains[place] * np.tile(values, len(record.rows)))


def seen_by(record: Record, how: str) -> tuple[list[Values], list[Values]]:
    """For each trial, what takes values to the rows of a regression, and states to rates there, outside gaps.

    Weakly, these are PySINDy's windows, which take the derivative from the data; else some samples of each window
    """
    apart = max(int(SHARE_OF_PERIOD * record.rhythm.samples / 4), 1)
    values, rates, made = [], [], {}
    for trial in record.trials:
        whole = np.eye(len(trial.known))
        if how == "weak" and len(whole) not in made:
            np.random.seed(0)  # noqa: NPY002  PySINDy draws its windows from the global state
            half = HALF_WINDOW * record.rhythm.period
            weak = ps.WeakPDELibrary(ps.IdentityLibrary(), spatiotemporal_grid=trial.points.t, K=WINDOWS, H_xt=half)
            made[len(whole)] = (
                np.asarray(weak.fit_transform([whole])[0]),
                np.asarray(weak.convert_u_dot_integral(whole)),
            )
        value, rate = made[len(whole)] if how == "weak" else (whole[::apart], whole[::apart])
        inside = ~(value[:, ~trial.known] != 0).any(axis=1)
        values.append(value[inside])
        rates.append(rate[inside])
    return values, rates


def regressed(record: Record, how: str) -> tuple[list[Column], Values, Values, float]:
    """Columns that differ, the library (sample, column), what is to be explained (sample,), windows side by side."""
    values, rates = seen_by(record, how)
    ends = np.cumsum([len(one.known) for _ in record.rows for one in record.trials])[:-1]

    def reduced(full: Values, taken: list[Values]) -> list[Values]:
        blocks = np.split(full, ends)
        each = [taken[k % len(taken)] @ block for k, block in enumerate(blocks)]
        return [np.concatenate(each[k : k + len(taken)]) for k in range(0, len(each), len(taken))]

    measured = [one.points.x if how == "weak" else one.rates for one in record.trials]
    rate = reduced(np.concatenate([one[:, row] for row in record.rows for one in measured]), rates)
    still = reduced(record.rates(record.simulation), values)
    left = [one - other for one, other in zip(rate, still, strict=True)]
    sizes = [np.sqrt((one**2).mean()) for one in left]
    columns: list[Column] = []
    kept = np.empty((0, sum(map(len, left))))
    for column in drawn(record, EVERY[how]):
        if np.isfinite(column.values).all():
            one = np.concatenate([x / size for x, size in zip(reduced(column.values, values), sizes, strict=True)])
            norm = np.linalg.norm(one)
            if norm > LEAST and (np.abs(kept @ one) < ALIKE * norm).all():
                columns.append(replace(column, values=one))
                kept = np.vstack([kept, one / norm])
    target = np.concatenate([x / size for x, size in zip(left, sizes, strict=True)])
    seconds = len(record.rows) * sum(one.known.sum() for one in record.trials) / record.rhythm.rate
    window = (2 * HALF_WINDOW if how == "weak" else SHARE_OF_PERIOD) * record.rhythm.period
    return columns, np.column_stack([one.values for one in columns]), target, seconds / window


def criterion(rest: Values, terms: int, samples: float) -> float:
    """Bayesian criterion over effective samples."""
    return samples * np.log(max((rest**2).mean(), LEAST)) + terms * np.log(samples)


def forward(library: Values, target: Values, samples: float) -> Values:
    """Coefficients: the column that explains most joins, until the criterion says stop."""
    best, chosen = np.zeros(library.shape[1]), []
    free, rest = library.copy(), target
    least = criterion(target, 0, samples)
    norms = np.linalg.norm(library, axis=0)
    for _ in range(MOST):
        size = np.linalg.norm(free, axis=0)
        gain = np.where(size > np.sqrt(1 - ALIKE) * norms, np.abs(rest @ free) / np.maximum(size, LEAST), 0.0)
        chosen.append(int(np.argmax(gain)))
        axis = free[:, chosen[-1]] / size[chosen[-1]]
        free, rest = free - np.outer(axis, axis @ free), rest - axis * (axis @ rest)
        now = criterion(rest, len(chosen), samples)
        if now >= least:
            break
        least, best = now, np.zeros(library.shape[1])
        best[chosen] = np.linalg.lstsq(library[:, chosen], target)[0]
    return best


def swept(columns: Values, aim: Values, samples: float) -> Values:
    """Coefficients by PySINDy's sequential thresholds, of columns of unit size; the threshold is the criterion's."""
    sizes, size = np.linalg.norm(columns, axis=0), np.linalg.norm(aim)
    best, least = np.zeros(len(sizes)), 0.0
    for threshold in THRESHOLDS:
        optimizer: Any = ps.STLSQ(threshold=threshold, alpha=1e-6)
        found = np.asarray(optimizer.fit(columns / sizes, aim[:, None] / size).coef_)[0]
        rest = (aim / size - columns / sizes @ found) * np.sqrt(len(aim))
        now = criterion(rest, int(np.count_nonzero(found)), samples)
        if now < least:
            best, least = found, now
    return best * size / sizes


def implicit(columns: list[Column], library: Values, target: Values, samples: float) -> tuple[Values, Values]:
    """SINDy-PI (Kaheman, Kutz and Brunton 2020): each column that holds the residual is the left-hand side in turn.

    PySINDy's own solver needs cvxpy and an l1 penalty; this is the published one, by sequential thresholds. The column
    whose equation tells the residual best wins. Returns the coefficients of its numerator and of its denominator
    """
    plain = [
        k for k, one in enumerate(columns) if one.candidate.verdict == "missing_physics" and not one.candidate.constants
    ]
    least, count = criterion(target, 0, samples), library.shape[1]
    above, below = np.zeros(count), np.zeros(count)
    every = np.column_stack([library, target, target[:, None] * library[:, plain]])
    small: Values = np.asarray(np.linalg.qr(every, mode="r"))  # its triangle has the same least squares
    for left in range(count, every.shape[1]):
        found = np.insert(swept(np.delete(small, left, axis=1), small[:, left], samples), left, -1.0)
        over = found[count] + library[:, plain] @ found[count + 1 :]
        with np.errstate(divide="ignore", invalid="ignore"):
            told = np.nan_to_num(-(library @ found[:count]) / over, posinf=0.0, neginf=0.0)
        now = criterion(target - told, int(np.count_nonzero(found)) - 1, samples)
        if now < least and found[count]:
            least, above = now, -found[:count] / found[count]
            below[plain] = found[count + 1 :] / found[count]
    return above, below


def write(record: Record, columns: list[Column], above: Values, below: Values, out: Path) -> None:
    """Write discovery.json and augmented.toml: a sum of terms, over one plus a sum of terms."""
    simulation, effects = record.simulation, {}
    over = " + ".join(f"{below[k]:.6g}*({columns[k].term})" for k in np.flatnonzero(below))
    for k in np.flatnonzero((above != 0) | (below != 0)):
        one, candidate, factor = columns[k], columns[k].candidate, above[k]
        inside = False
        if candidate.verdict == "wrong_parameter":
            value = simulation.values()[candidate.place] + factor
            inside = candidate.beyond_bounds(value) <= 0
            simulation = simulation.with_values({candidate.place: value})
        elif candidate.verdict == "input_error":
            numbers = {"gain": f"{1 + factor:.6g}", "seconds": f"{max(one.number * factor, 0.0):.6g}"}
            simulation = candidate.written(simulation, numbers)
        elif factor:
            text = f"{factor:.6g}*({one.term})" + (f"/(1 + {over})" if over else "")
            simulation = simulation.with_effect(Term(candidate.place, candidate.kind, candidate.name, text))
        if not inside:
            effects[(candidate.kind, candidate.place, candidate.name)] = candidate.verdict
    said = {"verdict": next(iter(effects.values()), "no_gap")}
    said["effects"] = [{kind: place, "name": name} for kind, place, name in effects]
    out.mkdir(parents=True, exist_ok=True)
    (out / "discovery.json").write_text(json.dumps(said), encoding="utf-8")
    write_simulation(simulation, out / "augmented.toml")


if __name__ == "__main__":
    model = read_simulation(GIVEN.simulation)
    given = record_of(model, read_measured(GIVEN.measured, model))
    found, library, target, samples = regressed(given, GIVEN.how)
    if GIVEN.how == "implicit":
        factors = implicit(found, library, target, samples)
    else:
        factors = forward(library, target, samples), np.zeros(len(found))
    write(given, found, *factors, GIVEN.out)
