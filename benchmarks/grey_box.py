"""A plain grey-box fit as a tool that answers for a gap: every number of the model refitted, nothing added.

    python benchmarks/grey_box.py SIMULATION.toml MEASURED.csv --out DIR

The free run of each trial is fitted to the measured channels over all parameters and all start states at once, by
`scipy.optimize.least_squares` (trust region, within the file's bounds where it has them), as a modeller would do by
hand. A parameter is named where its bound stops it, or, without bounds, where it moved by more than three standard
errors. It writes discovery.json and augmented.toml as `gaitdisc discover` does.
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
)  # before the slow imports

import json
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray
from scipy.optimize import OptimizeResult, least_squares

from gaitdisc.discovery.first_states import guess_states
from gaitdisc.discovery.grids import rhythm_of
from gaitdisc.discovery.places import kinematic_rates
from gaitdisc.simulation.drive import Rows
from gaitdisc.simulation.measured import Measured
from gaitdisc.simulation.measured_table import read_measured
from gaitdisc.simulation.running import compile_simulation
from gaitdisc.simulation.simulation import Simulation
from gaitdisc.simulation.simulation_file import read_simulation
from gaitdisc.simulation.writing import write_simulation

STEP, DIVERGED = 1e-6, 10.0  # of finite differences, of a unit's size; a lost sample's residual, in standard deviations
STANDARD_ERRORS, AT_BOUND = 3.0, 1e-3
Values = NDArray[np.float64]


@dataclass(frozen=True, eq=False)
class GreyBox:
    """Residuals of free runs as a function of parameters and start states, in units of their size."""

    simulation: Simulation
    measured: Measured
    first: Values  # numbers that the fit begins with (parameter + trial x state,)
    size: Values  # of each number

    def residuals(self, numbers: Values) -> Values:
        """Free runs minus measurement, over each channel's standard deviation (value,)."""
        return self._many(numbers[None])[0]

    def slopes(self, numbers: Values) -> Values:
        """Finite differences of the residuals in one run; a start moves its own trial alone (value, number)."""
        count, states = len(self.simulation.parameters), len(self.simulation.states)
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
        given, trials, count = numbers * self.size + self.first, len(data.trials), len(machine.defaults)
        values, starts = given[:, :count], given[:, count:].reshape(-1, len(machine.states))
        which = np.tile(np.arange(trials), len(numbers))
        rows = Rows(which, np.zeros(len(which), int), starts, np.repeat(values, trials, axis=0))
        states, _ = machine.run(data.drive, rows, int(data.samples.max()) - 1)
        spread = np.nanstd(data.observed, axis=(0, 1))
        error = (machine.observe(data.drive, rows, states) - data.observed[which]) / spread
        error = np.clip(np.nan_to_num(error, nan=DIVERGED, posinf=DIVERGED, neginf=-DIVERGED), -DIVERGED, DIVERGED)
        seen = np.isfinite(data.observed)
        return error.reshape(len(numbers), *data.observed.shape)[:, seen]


def grey_box(simulation: Simulation, measured: Measured) -> GreyBox:
    """The fit before it begins: the file's numbers, and starts from the smoothed channels."""
    machine = compile_simulation(simulation)
    period = rhythm_of(measured.observed, measured.drive.rate).period
    guess = guess_states(simulation, measured, period, kinematic_rates(simulation, machine)).states
    starts = np.nan_to_num(guess[:, 0])
    spread = np.broadcast_to(np.maximum(np.nanstd(guess, axis=(0, 1)), 1e-9), starts.shape)
    scale = np.where(machine.defaults == 0, 1.0, np.abs(machine.defaults))
    return GreyBox(
        simulation,
        measured,
        np.r_[machine.defaults, starts.ravel()],
        np.r_[scale, np.ascontiguousarray(spread).ravel()],
    )


def fitted(box: GreyBox) -> OptimizeResult:
    """Every number of the model and every start at its best."""
    parameters = box.simulation.parameters
    low, high = np.full((2, len(box.first)), np.inf) * [[-1], [1]]
    for k, each in enumerate(parameters):
        low[k] = -np.inf if each.low is None else (each.low - box.first[k]) / box.size[k]
        high[k] = np.inf if each.high is None else (each.high - box.first[k]) / box.size[k]
    begin = np.clip(np.zeros(len(box.first)), low, high)
    slopes: Any = box.slopes  # scipy declares a name here alone, and documents a function
    return least_squares(box.residuals, begin, slopes, bounds=(low, high), max_nfev=100)


def named(box: GreyBox, fit: OptimizeResult) -> list[str]:
    """Parameters that leave their bounds, or without bounds, the file's value."""
    count = len(box.simulation.parameters)
    variance = 2 * fit.cost / max(len(fit.fun) - len(fit.x), 1)
    errors = np.sqrt(np.diag(np.linalg.pinv(fit.jac.T @ fit.jac)) * variance)[:count]
    found = []
    for k, each in enumerate(box.simulation.parameters):
        value = box.first[k] + fit.x[k] * box.size[k]
        if each.low is None or each.high is None:
            out = abs(fit.x[k]) > STANDARD_ERRORS * errors[k]
        else:
            out = min(value - each.low, each.high - value) < AT_BOUND * (each.high - each.low)
        if out:
            found.append(each.name)
    return found


if __name__ == "__main__":
    model = read_simulation(GIVEN.simulation)
    problem = grey_box(model, read_measured(GIVEN.measured, model))
    answer = fitted(problem)
    effects = [{"parameter": name, "name": "wrong_parameter"} for name in named(problem, answer)]
    numbers = problem.first + answer.x * problem.size
    moved = {each.name: float(numbers[k]) for k, each in enumerate(model.parameters)}
    GIVEN.out.mkdir(parents=True, exist_ok=True)
    said = {"verdict": "wrong_parameter" if effects else "no_gap", "effects": effects}
    (GIVEN.out / "discovery.json").write_text(json.dumps(said), encoding="utf-8")
    write_simulation(model.with_values(moved), GIVEN.out / "augmented.toml")
