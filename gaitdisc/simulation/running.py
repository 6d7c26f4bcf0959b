"""A simulation made ready to run, of equations or of a Python object; and where one that blows up does so."""

from collections.abc import Callable
from dataclasses import dataclass, replace
from functools import lru_cache
from types import FunctionType
from typing import Any

import numpy as np
from numpy.typing import NDArray

from gaitdisc.errors import SimulationError
from gaitdisc.recording.arrays import Values, read_only
from gaitdisc.simulation.compiled_simulation import Compiled, Drive, Rows
from gaitdisc.simulation.expression import Number, Operation, Tree, parse
from gaitdisc.simulation.program import compile_program
from gaitdisc.simulation.python_simulation import PythonSimulation, call
from gaitdisc.simulation.simulation import Simulation

SLOW_HZ = 2.0  # samples a second, below which a time in milliseconds is likelier than a record so coarse
_NUDGE = 1e-2  # of a parameter, to see what drives the rate


@lru_cache(maxsize=64)
def compile_simulation(simulation: Simulation | PythonSimulation, still: frozenset[str] = frozenset()) -> Compiled:
    """Simulation made ready to run; the same one again costs nothing.

    still: parameters that keep their values in all its runs, which are quicker for it

    >>> from gaitdisc.simulation.parts import State
    >>> compile_simulation(Simulation("decay", (State("x"),), equations=(("x", "-x"),))).states
    ('x',)
    """
    if isinstance(simulation, PythonSimulation):
        parts = simulation.parts
        base, feeds = (compile_simulation(replace(part, model="")) for part in (parts, simulation.feeds))
        return PythonCompiled(
            **{**vars(base), "simulation": parts, "right_hand_side": feeds.observation}, model=simulation
        )
    if simulation.model:
        raise SimulationError(
            "a simulation must have its own equations to be run",
            f"the equations of {simulation.title!r} are in {simulation.model}",
            "Give the path of this model to `gaitdisc discover`, which uses the engine.",
        )
    states = tuple(state.name for state in simulation.states)
    inputs = tuple(signal.name for signal in simulation.inputs)
    parameters = tuple(parameter.name for parameter in simulation.parameters)
    defaults = read_only([parameter.value for parameter in simulation.parameters])
    leaves = ("t", *states, *inputs, *parameters)
    defined, values = simulation_scope(simulation), {name: simulation.values()[name] for name in still}
    equations = dict(simulation.equations)
    rates = [_with_effects(parse(equations[name]), simulation, "equation", name) for name in states]
    seen = [parse(text) for _, text in simulation.observations]
    observed = tuple(name for name, _ in simulation.observations)
    return Compiled(
        simulation,
        states,
        inputs,
        parameters=parameters,
        observed=observed,
        defaults=defaults,
        right_hand_side=compile_program(rates, leaves, parameters, defined, values),
        observation=compile_program(seen, leaves, parameters, defined, values),
    )


def simulation_scope(simulation: Simulation) -> dict[str, Tree]:
    """Ports, as the sum of the effects on them, then definitions."""
    scope = {}
    for port in simulation.ports:
        scope[port.name] = _with_effects(Number(0.0), simulation, "port", port.name)
    return scope | {name: parse(text) for name, text in simulation.definitions}


def _with_effects(tree: Tree, simulation: Simulation, kind: str, place: str) -> Tree:
    terms = [parse(effect.term) for effect in simulation.effects if (effect.kind, effect.place) == (kind, place)]
    if terms and tree == Number(0.0):
        tree = terms.pop(0)
    for term in terms:
        tree = Operation("+", (tree, term))
    return tree


@dataclass(frozen=True, eq=False)
class PythonCompiled(Compiled):
    """A `PythonSimulation` ready to run, as a `Compiled` whose right-hand side gives what the function is fed."""

    model: PythonSimulation

    def _integrator(self, values: Values) -> tuple[int, Callable[..., None]]:
        """All rows as one block, whose derivatives the function gives."""
        from gaitdisc.simulation import machine

        lanes, n = len(values), len(self.states)
        feeds = np.empty((self.right_hand_side.outputs, lanes))

        def derive(code: NDArray[np.uint64], registers: Any, rates: Any, width: np.uint64) -> None:
            machine.execute(code, registers, feeds.reshape(-1), width)
            x = registers.reshape(-1, lanes)[1 : 1 + n].T
            x = np.where(np.abs(x) < machine.BOUND, x, np.nan)  # nobody's function is made for what has run away
            rates.reshape(n, lanes)[:] = call(self.model, x, feeds.T, values).T

        block = machine.integrate_block.py_func
        return lanes, FunctionType(block.__code__, {**vars(machine), "derive": derive})

    def _derivatives(self, x: Values, outputs: Values, values: Values) -> Values:
        """Derivatives by the function, which is fed with what the right-hand side gives."""
        return call(self.model, x, outputs, np.broadcast_to(values, (len(x), len(self.parameters))))


def refuse_divergence(compiled: Compiled, drive: Drive, rows: Rows, states: Values, ok: NDArray[np.bool_]) -> None:
    """Refuse a run of which a row did not stay finite, with what is last known of the first such row.

    states (row, step, state): from `Compiled.run`
    ok (row,): from `Compiled.run`
    """
    if np.all(ok):
        return
    row, *others = np.flatnonzero(~ok).tolist()
    finite = np.isfinite(states[row]).all(axis=1)
    last = max(int(np.argmin([*finite, False])) - 1, 0)
    trial, sample = int(rows.trial[row]), int(rows.begin[row]) + last
    time = drive.time0[trial] + sample / drive.rate
    u = drive.inputs[trial, min(sample, int(drive.samples[trial]) - 1)]
    given = compiled.defaults if rows.values is None else rows.values
    values = np.broadcast_to(given, (len(ok), len(compiled.parameters)))[row]
    fastest, parameter = _find_cause(compiled, time, states[row, last], u, values)
    more = f"; so do {len(others)} more of {len(ok)} runs" if others else ""
    driven = f"{parameter!r}, which affects this state most, and " if parameter else ""
    late = " (the time must be in seconds, not in milliseconds)" if drive.rate < SLOW_HZ else ""
    raise SimulationError(
        "every state of a simulation must stay within 1e6",
        f"{compiled.simulation.title!r} diverges in trial {trial + 1} after t = {time:.4g} s, first in "
        f"{compiled.states[fastest]!r} (last value {np.nan_to_num(states[row, last, fastest]):.3g}){more}",
        f"Check {driven}the initial state. Samples {1 / drive.rate:.4g} s apart may also be too coarse for this "
        f"motion{late}.",
    )


def _find_cause(compiled: Compiled, time: float, last: Values, u: Values, values: Values) -> tuple[int, str]:
    """State that changes fastest, relative to its size, and the parameter that its rate depends on most, if any."""
    x, t, u = np.nan_to_num(last), np.array([time]), u[None]
    # signals without their delay, which is near enough to say what is fast
    now = dict(zip(compiled.inputs, u[0], strict=True)) | dict(zip(compiled.states, x, strict=True))
    late = np.array([[float(now[signal]) for signal, _ in compiled.right_hand_side.delays]])
    with np.errstate(all="ignore"):
        rates = compiled.rates(t, x[None], u, values, late)[0]
        speed = np.abs(np.nan_to_num(rates, nan=np.inf, posinf=np.inf)) / (1e-6 + np.abs(x))
    fastest = int(np.argmax(speed if speed.max() > 0 else ~np.isfinite(last)))
    if not len(values):
        return fastest, ""
    moved = values * (1 + _NUDGE * np.eye(len(values)))
    times, here, inputs, delayed = (np.repeat(array, len(values), axis=0) for array in (t, x[None], u, late))
    with np.errstate(all="ignore"):
        change = compiled.rates(times, here, inputs, moved, delayed)[:, fastest] - rates[fastest]
    change = np.nan_to_num(np.abs(change), nan=0.0, posinf=0.0)
    return fastest, compiled.parameters[int(np.argmax(change))] if change.max() > 0 else ""
