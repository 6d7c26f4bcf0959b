"""A grey-box fit over the catalogue as a tool that answers for a gap: numbers refitted, at most one effect added.

    python benchmarks/grey_box.py SIMULATION.toml MEASURED.csv --out DIR [--seconds 5]

The free run of each trial is fitted to the measured channels over all start states and every parameter with bounds, by
`scipy.optimize.least_squares` (trust region), as a modeller would do by hand; then so with each effect of gaitdisc's
catalogue, in the order of what the first step closes, until the time is up. Akaike's criterion, over one sample a
window of the smoothing, picks one or none; without one, a parameter at its bound is named. It writes what
`gaitdisc discover` writes.
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
    argument("--seconds", "of the processor for the fits with an effect", 5.0),
)  # before the slow imports

import json
import time
from collections.abc import Container, Iterator
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray
from scipy.optimize import OptimizeResult, least_squares

from gaitdisc.discovery.candidate import Candidate, list_candidates
from gaitdisc.discovery.catalogue import read_shapes
from gaitdisc.discovery.first_states import SHARE_OF_PERIOD, guess_states
from gaitdisc.discovery.fitted import find_bounds
from gaitdisc.discovery.grids import Rhythm, cells, delays, find_rhythm
from gaitdisc.discovery.places import kinematic_rates, list_places
from gaitdisc.simulation.compiled_simulation import Rows
from gaitdisc.simulation.evaluating import Points, evaluate
from gaitdisc.simulation.measured import Measured
from gaitdisc.simulation.measured_table import read_measured
from gaitdisc.simulation.running import compile_simulation
from gaitdisc.simulation.simulation import Simulation
from gaitdisc.simulation.simulation_file import read_simulation
from gaitdisc.simulation.writing import write_simulation

STEP, LEAST, DIVERGED = (
    1e-6,
    1e-9,
    10.0,
)  # of finite differences, of a unit's size; what is nothing; a lost sample's residual, in standard deviations
AT_BOUND, EVERY, MOST_RUNS = 1e-3, 4, 30  # share of the bounds; of the grids' numbers; runs of a fit
Values = NDArray[np.float64]


@dataclass(frozen=True, eq=False)
class GreyBox:
    """Residuals of free runs as a function of free parameters and start states, in units of their size."""

    simulation: Simulation
    measured: Measured
    first: Values  # numbers that the fit begins with (parameter + trial x state,)
    size: Values  # of each number
    free: tuple[int, ...]  # numbers of the parameters that are fitted

    @property
    def fitted(self) -> NDArray[np.int64]:
        """Which of the numbers are fitted: free parameters, then every start."""
        return np.r_[np.array(self.free, int), len(self.simulation.parameters) : len(self.first)]

    def residuals(self, numbers: Values) -> Values:
        """Free runs minus measurement, over each channel's standard deviation (value,)."""
        return self._many(numbers[None])[0]

    def slopes(self, numbers: Values) -> Values:
        """Finite differences of the residuals in one run; a start moves its own trial alone (value, number)."""
        count, states = len(self.free), len(self.simulation.states)
        seen = np.isfinite(self.measured.observed)
        trial = np.broadcast_to(np.arange(len(seen))[:, None, None], seen.shape)[seen]
        every = np.zeros((states, len(numbers)))
        for state in range(states):
            every[state, count + state :: states] = STEP
        moved = self._many(numbers + np.vstack([np.zeros(len(numbers)), STEP * np.eye(len(numbers))[:count], every]))
        found = np.zeros((len(trial), len(numbers)))
        found[:, :count] = ((moved[1 : count + 1] - moved[0]) / STEP).T
        for state in range(states):
            found[np.arange(len(trial)), count + trial * states + state] = (moved[count + 1 + state] - moved[0]) / STEP
        return found

    def _many(self, numbers: Values) -> Values:
        """Residuals of many sets of numbers (set, value)."""
        machine, data = compile_simulation(self.simulation), self.measured
        given, which = np.tile(self.first, (len(numbers), 1)), self.fitted
        given[:, which] += numbers * self.size[which]
        trials, count = len(data.trials), len(machine.defaults)
        values, starts = given[:, :count], given[:, count:].reshape(-1, len(machine.states))
        which = np.tile(np.arange(trials), len(numbers))
        rows = Rows(which, np.zeros(len(which), int), starts, np.repeat(values, trials, axis=0))
        states, _ = machine.run(data.drive, rows, int(data.samples.max()) - 1)
        spread = np.nanstd(data.observed, axis=(0, 1))
        error = (machine.observe(data.drive, rows, states) - data.observed[which]) / spread
        error = np.clip(np.nan_to_num(error, nan=DIVERGED, posinf=DIVERGED, neginf=-DIVERGED), -DIVERGED, DIVERGED)
        seen = np.isfinite(data.observed)
        return error.reshape(len(numbers), *data.observed.shape)[:, seen]

    def fit(self, begin: Values) -> OptimizeResult:
        """Every free number and every start at its best."""
        low, high = np.full((2, len(begin)), np.inf) * [[-1], [1]]
        for k, number in enumerate(self.free):
            each = self.simulation.parameters[number]
            low[k] = -np.inf if each.low is None else (each.low - self.first[number]) / self.size[number]
            high[k] = np.inf if each.high is None else (each.high - self.first[number]) / self.size[number]
        slopes: Any = self.slopes  # scipy declares a name here alone, and documents a function
        return least_squares(
            self.residuals, np.clip(begin, low, high), slopes, bounds=(low, high), x_scale="jac", max_nfev=MOST_RUNS
        )

    def values(self, numbers: Values) -> dict[str, float]:
        """The parameters by name."""
        now = self.first.copy()
        now[self.fitted] += numbers * self.size[self.fitted]
        return {each.name: float(now[k]) for k, each in enumerate(self.simulation.parameters)}


@dataclass(frozen=True, eq=False)
class Tried:
    """One effect, where its fit begins, and what the first step closes."""

    candidate: Candidate
    names: dict[str, str]  # the parameter that stands for each of its numbers
    box: GreyBox
    begin: Values
    closed: float


def box_of(simulation: Simulation, measured: Measured, guess: Values, added: Container[str] = ()) -> GreyBox:
    """The fit before it begins: the file's numbers, and starts; those of states that an effect brings along at 0.

    guess (trial, sample, state): states of the base
    """
    more = len(simulation.states) - guess.shape[2]
    starts = np.pad(np.nan_to_num(guess[:, 0]), ((0, 0), (0, more)))
    spread = np.pad(np.maximum(np.nanstd(guess, axis=(0, 1)), LEAST), (0, more), constant_values=1.0)
    values = compile_simulation(simulation).defaults
    size = np.r_[np.where(values == 0, 1.0, np.abs(values)), np.tile(spread, len(starts))]
    free = [k for k, each in enumerate(simulation.parameters) if find_bounds(each) or each.name in added]
    return GreyBox(simulation, measured, np.r_[values, starts.ravel()], size, tuple(free))


def beginnings(simulation: Simulation, measured: Measured, guess: Values, rhythm: Rhythm) -> Iterator[Tried]:
    """Every effect of the catalogue at its best beginning: one step of Gauss and Newton from each cell of its grid."""
    count = measured.samples.astype(int)
    u = np.concatenate([measured.drive.inputs[k, :n] for k, n in enumerate(count)])
    x = np.nan_to_num(np.concatenate([guess[k, :n] for k, n in enumerate(count)]))
    for candidate in list_candidates(simulation, list_places(simulation), read_shapes()):
        if candidate.bounds:
            continue  # that is fitted anyway
        along = evaluate(simulation, candidate.role, Points(np.zeros(len(x)), x, u)) if candidate.role else np.zeros(1)
        tried = []
        for cell in cells(dict(candidate.constants or {}), along, rhythm)[::EVERY]:
            late = {"seconds": float(delays(rhythm)[0])} if candidate.name == "input_lag" else {}
            names = candidate.named("added")
            model = candidate.in_fit(simulation, names, candidate.idle | cell | late)
            box = box_of(model, measured, guess, names.values())
            still = np.zeros(len(box.fitted))
            slopes, error = box.slopes(still), box.residuals(still)
            step = np.asarray(np.linalg.lstsq(slopes, -error)[0], float)
            tried.append(
                Tried(candidate, names, box, step, float(error @ error - np.sum((error + slopes @ step) ** 2)))
            )
        yield max(tried, key=lambda one: one.closed)


def criterion(fit: OptimizeResult, terms: int, samples: float) -> float:
    """Akaike's criterion over effective samples."""
    return samples * np.log(max(2 * fit.cost / len(fit.fun), LEAST)) + 2 * terms


def picked(simulation: Simulation, measured: Measured, seconds: float) -> tuple[GreyBox, OptimizeResult, Tried | None]:
    """The fit that the criterion picks, and its effect."""
    rhythm = find_rhythm(measured.observed, measured.rate)
    guess = guess_states(simulation, measured, rhythm.period, kinematic_rates(simulation))
    samples = np.isfinite(measured.observed).sum() / (SHARE_OF_PERIOD * rhythm.samples)
    box = box_of(simulation, measured, guess)
    fit = box.fit(np.zeros(len(box.fitted)))
    best, least = (box, fit, None), criterion(fit, 0, samples)
    starts = box.first[len(simulation.parameters) :] + (fit.x * box.size[box.fitted])[len(box.free) :]
    guess[:, 0] = starts.reshape(len(guess), -1)
    began = time.process_time()
    order = sorted(
        beginnings(simulation.with_values(box.values(fit.x)), measured, guess, rhythm), key=lambda one: -one.closed
    )
    for one in order:
        if time.process_time() - began > seconds:
            break
        fit = one.box.fit(one.begin)
        now = criterion(fit, len(one.names), samples)
        if now < least:
            best, least = (one.box, fit, one), now
    return best


if __name__ == "__main__":
    model = read_simulation(GIVEN.simulation)
    box, answer, effect = picked(model, read_measured(GIVEN.measured, model), GIVEN.seconds)
    values = box.values(answer.x)
    effects, verdict, fitted = [], "no_gap", model
    for each in model.parameters:
        if bounds := find_bounds(each):
            fitted = fitted.with_values({each.name: values[each.name]})
            apart = min(values[each.name] - bounds[0], bounds[1] - values[each.name])
            if not effect and apart < AT_BOUND * (bounds[1] - bounds[0]):
                effects.append({"parameter": each.name, "name": "wrong_parameter"})
                verdict = "wrong_parameter"
    if effect:
        candidate, verdict = effect.candidate, effect.candidate.verdict
        fitted = candidate.written(fitted, {slot: f"{values[name]:.8g}" for slot, name in effect.names.items()})
        effects.append({candidate.kind: candidate.place, "name": candidate.name})
    GIVEN.out.mkdir(parents=True, exist_ok=True)
    (GIVEN.out / "discovery.json").write_text(json.dumps({"verdict": verdict, "effects": effects}), encoding="utf-8")
    write_simulation(fitted, GIVEN.out / "augmented.toml")
