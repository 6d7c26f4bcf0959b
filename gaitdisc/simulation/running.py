"""Running a simulation: many trials, many starts and many parameters at once."""

from __future__ import annotations

from dataclasses import dataclass
from functools import lru_cache

import numpy as np
from numpy.typing import ArrayLike, NDArray

from gaitdisc.errors import ShapeError
from gaitdisc.recording.arrays import read_only
from gaitdisc.simulation.at_points import at_points, leaf_columns
from gaitdisc.simulation.delays import delayed_in_rows
from gaitdisc.simulation.drive import Drive, Rows
from gaitdisc.simulation.expression import Number, Operation, Tree, parsed
from gaitdisc.simulation.program import Program, compiled_program
from gaitdisc.simulation.python_simulation import PythonSimulation
from gaitdisc.simulation.simulation import Simulation

SUBSTEPS = 5  # Runge-Kutta steps for each sample


@dataclass(frozen=True, eq=False)
class Compiled:
    """A simulation that is ready to run.

    Parameters
    ----------
    simulation : Simulation
        What it was made from.
    states, inputs, parameters, observed : tuple of str
        Names, in order.
    defaults : ndarray (parameter,)
        The parameters' own values.
    right_hand_side, observation : Program
        Derivatives of the states, and the observed channels.
    """

    simulation: Simulation
    states: tuple[str, ...]
    inputs: tuple[str, ...]
    parameters: tuple[str, ...]
    observed: tuple[str, ...]
    defaults: NDArray[np.float64]
    right_hand_side: Program
    observation: Program

    def run(
        self,
        drive: Drive,
        rows: Rows,
        steps: int,
        *,
        substeps: int = SUBSTEPS,
        past: NDArray[np.float64] | None = None,
    ) -> tuple[NDArray[np.float64], NDArray[np.bool_]]:
        """States along each row, by Runge-Kutta of order 4.

        Parameters
        ----------
        drive : Drive
            Inputs of all trials.
        rows : Rows
            Where each row starts, and with which parameters.
        steps : int
            Samples to go.
        substeps : int
            Steps for each sample.
        past : ndarray (trial, sample, state), optional
            Measured states, for delays that reach before a row's start; held at the start where absent or NaN.

        Returns
        -------
        states : ndarray (row, steps + 1, state)
            NaN beyond the trial's end, and from where a row diverged (a state beyond 1e6, or not a number).
        ok : ndarray of bool (row,)
            False where a row diverged.
        """
        from gaitdisc.simulation.machine import BLOCK, integrate

        place, starts, values = self._rows(drive, rows)
        seconds = self._seconds(self.right_hand_side, values)
        found = np.full((len(starts), steps + 1, len(self.states)), np.nan)
        found[:, 0] = starts
        ok = np.asarray(np.isfinite(starts).all(axis=1))
        program = self._instructions(BLOCK)
        wraps = np.array([each.wraps for each in self.simulation.inputs], bool)
        driven = (drive.rate, drive.time0, drive.inputs, drive.samples, wraps)
        before = read_only(np.empty((0, 0, 0)) if past is None else np.ascontiguousarray(past, float))
        integrate(program, driven, (place, starts, values, seconds), (steps, substeps), before, (found, ok))
        return found, ok

    def rates(
        self,
        t: ArrayLike,
        x: NDArray[np.float64],
        u: NDArray[np.float64],
        values: NDArray[np.float64] | None = None,
        late: NDArray[np.float64] | None = None,
    ) -> NDArray[np.float64]:
        """Right-hand side at many points.

        Parameters
        ----------
        t : ndarray (point,)
            Time [s].
        x : ndarray (point, state)
            States.
        u : ndarray (point, input)
            Inputs.
        values : ndarray (parameter,) or (point, parameter), optional
            Parameters; the simulation's own where absent.
        late : ndarray (point, delay), optional
            Delayed signals, in the order of `right_hand_side.delays`.

        Raises
        ------
        SimulationError
            If the simulation has delays and `late` is absent.
        """
        values = self.defaults if values is None else np.asarray(values, float)
        return at_points(self.right_hand_side, leaf_columns(t, x, u, values), late).T

    def observe(
        self,
        drive: Drive,
        rows: Rows,
        states: NDArray[np.float64],
        past: NDArray[np.float64] | None = None,
    ) -> NDArray[np.float64]:
        """Observed channels along rows that were run.

        Parameters
        ----------
        drive : Drive
            Inputs of all trials.
        rows : Rows
            The rows that were run.
        states : ndarray (row, step, state)
            From `run`.
        past : ndarray (trial, sample, state), optional
            As for `run`.

        Returns
        -------
        ndarray (row, step, observed)
        """
        place, _, values = self._rows(drive, rows)
        count, steps, n = states.shape
        sample = place[:, 1, None] + np.arange(steps)
        held = np.minimum(sample, drive.samples[place[:, 0], None] - 1)
        u = drive.inputs[place[:, 0, None], held]
        t = drive.time0[place[:, 0], None] + sample / drive.rate
        seconds = self._seconds(self.observation, values)
        late = delayed_in_rows(self, (drive, place, past), states, seconds)
        points = count * steps
        columns = leaf_columns(t.ravel(), states.reshape(points, n), u.reshape(points, -1), values[0])
        first, used = 1 + n + len(self.inputs), self.observation.used()
        for column in range(len(self.parameters)):
            if used[first + column]:
                columns[first + column] = np.repeat(values[:, column], steps)
        found = at_points(self.observation, columns, late.reshape(points, -1), points)
        return np.ascontiguousarray(found.T).reshape(count, steps, len(self.observed))

    def _rows(self, drive: Drive, rows: Rows) -> tuple[NDArray[np.int64], NDArray[np.float64], NDArray[np.float64]]:
        starts = np.array(rows.starts, float, order="C", ndmin=2)
        count = len(starts)
        values = self.defaults if rows.values is None else np.asarray(rows.values, float)
        fits = starts.shape[1] == len(self.states) and drive.inputs.shape[2] == len(self.inputs)
        if not fits or values.shape not in ((len(self.parameters),), (count, len(self.parameters))):
            raise ShapeError(
                f"rows have starts (row, {len(self.states)}), values (row, {len(self.parameters)}) and "
                f"{len(self.inputs)} inputs",
                f"found starts {starts.shape}, values {values.shape}, {drive.inputs.shape[2]} inputs",
                "Follow the order of the simulation's states, parameters and inputs.",
            )
        place = np.empty((count, 2), np.int64)
        place[:, 0], place[:, 1] = rows.trial, rows.begin
        inside = (place[:, 0] >= 0) & (place[:, 0] < len(drive.samples)) & (place[:, 1] >= 0)
        if not inside.all() or np.any(place[:, 1] >= drive.samples[place[:, 0]]):
            raise ShapeError(
                f"rows begin inside one of {len(drive.samples)} trials",
                f"found trials {place[:, 0].min()} to {place[:, 0].max()}, first samples from {place[:, 1].min()} "
                f"to {place[:, 1].max()}",
                "Count trials and samples from 0.",
            )
        return place, starts, np.array(np.broadcast_to(values, (count, len(self.parameters))), order="C")

    def _seconds(self, program: Program, values: NDArray[np.float64]) -> NDArray[np.float64]:
        """Seconds of each delay of a program, (row, delay)."""
        if not program.delays:
            return np.empty((len(values), 0))
        wanted = compiled_program([seconds for _, seconds in program.delays], self.parameters)
        return np.ascontiguousarray(at_points(wanted, list(values.T), None, len(values)).T)

    def _instructions(self, rows: int) -> tuple:
        program = self.right_hand_side
        kinds = [
            (1, self.states.index(signal)) if signal in self.states else (0, self.inputs.index(signal))
            for signal, _ in program.delays
        ]
        delayed = np.array(kinds, np.int64).reshape(-1, 2)
        return program.placed(rows), program.setup, program.constants, delayed, program.registers


@lru_cache(maxsize=64)
def compile_simulation(simulation: Simulation | PythonSimulation) -> Compiled:
    """Simulation made ready to run; the same one again costs nothing.

    Parameters
    ----------
    simulation : Simulation or PythonSimulation
        With its effects, which are part of the right-hand side.

    Examples
    --------
    >>> from gaitdisc.simulation.parts import State
    >>> compile_simulation(Simulation("decay", (State("x"),), equations=(("x", "-x"),))).states
    ('x',)
    """
    if not isinstance(simulation, Simulation):
        from gaitdisc.simulation.python_running import compile_python_simulation

        return compile_python_simulation(simulation)
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


def simulation_scope(simulation: Simulation) -> dict[str, Tree]:
    """Ports, as the sum of the effects on them, then definitions.

    Parameters
    ----------
    simulation : Simulation
        Whose names they are.
    """
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
