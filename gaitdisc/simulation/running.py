"""A simulation made ready to run, whether a file holds its equations or a Python object its right-hand side."""

from __future__ import annotations

from dataclasses import dataclass, replace
from functools import lru_cache

import numpy as np
from numpy.typing import ArrayLike, NDArray

from gaitdisc.recording.arrays import read_only
from gaitdisc.simulation.compiled_simulation import SUBSTEPS, Compiled
from gaitdisc.simulation.delays import before_rows, linear_in_rows
from gaitdisc.simulation.drive import Drive, Rows
from gaitdisc.simulation.expression import Number, Operation, Tree, parsed
from gaitdisc.simulation.program import BOUND, PointTable, at_points, compiled_program, leaf_columns
from gaitdisc.simulation.python_simulation import PythonSimulation, called
from gaitdisc.simulation.refusal import SimulationError
from gaitdisc.simulation.simulation import Simulation


@lru_cache(maxsize=64)
def compile_simulation(simulation: Simulation | PythonSimulation) -> Compiled:
    """Simulation made ready to run; the same one again costs nothing.

    simulation: with its effects, which are part of the right-hand side

    >>> from gaitdisc.simulation.parts import State
    >>> compile_simulation(Simulation("decay", (State("x"),), equations=(("x", "-x"),))).states
    ('x',)
    """
    if not isinstance(simulation, Simulation):
        return _of_python(simulation)
    if simulation.model:
        raise SimulationError(
            "a simulation must have its own equations to be run",
            f"the equations of {simulation.title!r} are in {simulation.model}",
            "Give its path to gaitdisc discover, which uses the engine.",
        )
    states = tuple(state.name for state in simulation.states)
    inputs = tuple(each.name for each in simulation.inputs)
    parameters = tuple(parameter.name for parameter in simulation.parameters)
    defaults = read_only([parameter.value for parameter in simulation.parameters])
    leaves = ("t", *states, *inputs, *parameters)
    defined = simulation_scope(simulation)
    equations = dict(simulation.equations)
    wanted = [_with_effects(parsed(equations[name]), simulation, "equation", name) for name in states]
    seen = [parsed(text) for _, text in simulation.observations]
    observed = tuple(name for name, _ in simulation.observations)
    return Compiled(
        simulation,
        states,
        inputs,
        parameters,
        observed,
        defaults,
        compiled_program(wanted, leaves, parameters, defined),
        compiled_program(seen, leaves, parameters, defined),
    )


def _of_python(model: PythonSimulation) -> Compiled:
    own, feeds = (compile_simulation(replace(one, model="")) for one in (model.parts, model.feeds))
    return PythonCompiled(
        model.parts,
        own.states,
        own.inputs,
        own.parameters,
        own.observed,
        own.defaults,
        feeds.observation,
        own.observation,
        model,
    )


def simulation_scope(simulation: Simulation) -> dict[str, Tree]:
    """Ports, as the sum of the effects on them, then definitions."""
    scope = {}
    for port in simulation.ports:
        scope[port.name] = _with_effects(Number(0.0), simulation, "port", port.name)
    return scope | {name: parsed(text) for name, text in simulation.definitions}


def _with_effects(tree: Tree, simulation: Simulation, kind: str, place: str) -> Tree:
    terms = [parsed(each.term) for each in simulation.effects if (each.kind, each.place) == (kind, place)]
    if terms and tree == Number(0.0):
        tree = terms.pop(0)
    for term in terms:
        tree = Operation("+", (tree, term))
    return tree


@dataclass(frozen=True, eq=False)
class PythonCompiled(Compiled):
    """A `PythonSimulation` that is ready to run; it runs and observes as `Compiled` does.

    simulation, states, inputs, parameters, observed, defaults, right_hand_side, observation: the right-hand side gives
        what the function is fed with
    """

    model: PythonSimulation

    def run(
        self, drive: Drive, rows: Rows, steps: int, *, substeps: int = SUBSTEPS, past: NDArray[np.float64] | None = None
    ) -> tuple[NDArray[np.float64], NDArray[np.bool_]]:
        """States along each row, as `Compiled.run`."""
        place, starts, values = self._rows(drive, rows)
        walk = _Walk(self, drive, (place, starts, values), past, substeps)
        found = np.full((len(starts), steps + 1, len(self.states)), np.nan)
        found[:, 0] = starts
        ok = np.asarray(np.isfinite(starts).all(axis=1))
        x = starts
        last = drive.samples[place[:, 0]] - 1
        for sample in range(steps):
            x = walk.sample(x, sample)
            there = place[:, 1] + sample + 1 <= last
            ok &= ~there | np.all(np.abs(x) < BOUND, axis=1)
            found[ok & there, sample + 1] = x[ok & there]
            x[~ok] = np.nan
        return found, ok

    def rates(
        self,
        t: ArrayLike,
        x: NDArray[np.float64],
        u: NDArray[np.float64],
        values: NDArray[np.float64] | None = None,
        late: NDArray[np.float64] | None = None,
    ) -> NDArray[np.float64]:
        """Right-hand side at many points, as `Compiled.rates`."""
        x = np.asarray(x, float)
        given = self.defaults if values is None else np.asarray(values, float)
        columns = leaf_columns(np.broadcast_to(np.asarray(t, float), len(x)), x, u, given)
        fed = at_points(self.right_hand_side, columns, late, len(x)).T
        return called(self.model, columns[0], x, fed, np.broadcast_to(given, (len(x), len(self.parameters))))


class _Walk:
    """Rows that are stepped together, and the history that their delays need."""

    def __init__(
        self,
        compiled: PythonCompiled,
        drive: Drive,
        rows: tuple[NDArray[np.int64], NDArray[np.float64], NDArray[np.float64]],
        past: NDArray[np.float64] | None,
        substeps: int,
    ) -> None:
        self._compiled, self._drive, self._past, self._substeps = compiled, drive, past, substeps
        self._place, starts, self._values = rows
        self._seconds = compiled._seconds(compiled.right_hand_side, self._values)
        self._history = [starts]
        self._feeds = PointTable(compiled.right_hand_side, len(starts))
        self._feeds.fill(1 + len(compiled.states) + len(compiled.inputs), list(self._values.T))

    def sample(self, x: NDArray[np.float64], sample: int) -> NDArray[np.float64]:
        """One sample further, in its steps of Runge-Kutta."""
        h = 1.0 / (self._drive.rate * self._substeps)
        halves = np.arange(2 * self._substeps + 1)
        at = np.broadcast_to(sample + halves / (2 * self._substeps), (len(x), len(halves)))
        inputs = [self._input(k, at) for k in range(len(self._compiled.inputs))]
        with np.errstate(all="ignore"):  # a row that leaves every bound is reported, not warned of
            for half in halves[:-1:2]:
                start, middle, end = ((at[0, half + k], [each[:, half + k] for each in inputs]) for k in range(3))
                k1 = self._rates(x, *start)
                k2 = self._rates(x + h / 2 * k1, *middle)
                k3 = self._rates(x + h / 2 * k2, *middle)
                k4 = self._rates(x + h * k3, *end)
                x = x + h / 6 * (k1 + 2 * k2 + 2 * k3 + k4)
                if self._compiled.right_hand_side.delays:
                    self._history.append(x)
        return x

    def _rates(self, x: NDArray[np.float64], at: float, inputs: list[NDArray[np.float64]]) -> NDArray[np.float64]:
        t = self._drive.time0[self._place[:, 0]] + (self._place[:, 1] + at) / self._drive.rate
        self._feeds.fill(0, [t, *x.T, *inputs])
        late = [
            self._delayed(signal, at - self._seconds[:, k, None] * self._drive.rate)[:, 0]
            for k, (signal, _) in enumerate(self._compiled.right_hand_side.delays)
        ]
        self._feeds.fill(1 + x.shape[1] + len(inputs) + self._values.shape[1], late)
        return called(self._compiled.model, t, x, self._feeds.outputs().T, self._values)

    def _input(self, column: int, at: NDArray[np.float64]) -> NDArray[np.float64]:
        """Input at places (row, place) counted from each row's start."""
        wraps = self._compiled.simulation.inputs[column].wraps
        trial, begin = self._place[:, 0], self._place[:, 1, None]
        at = np.clip(begin + at, 0, self._drive.samples[trial, None] - 1)
        return linear_in_rows(self._drive.inputs[:, :, column], trial, at, wraps)

    def _delayed(self, signal: str, at: NDArray[np.float64]) -> NDArray[np.float64]:
        if signal in self._compiled.inputs:
            return self._input(self._compiled.inputs.index(signal), at)
        column = self._compiled.states.index(signal)
        steps = np.clip(at * self._substeps, 0, len(self._history) - 1)
        first = int(steps.min())
        history = np.stack([each[:, column] for each in self._history[first : int(steps.max()) + 2]], axis=1)
        value = linear_in_rows(history, np.arange(len(at)), steps - first, False)
        if self._past is None or not np.any(at < 0):
            return value
        start = self._history[0][:, column]
        measured = before_rows(self._past[:, :, column], self._place, at, start)
        return np.where((at < 0) & (self._place[:, 1, None] > 0), measured, value)
