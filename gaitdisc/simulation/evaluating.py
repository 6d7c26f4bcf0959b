"""Values of any expression of a simulation's names at many points: effects are scored along trajectories by it."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from functools import lru_cache

import numpy as np
from numpy.typing import ArrayLike

from gaitdisc.errors import SimulationError
from gaitdisc.recording.arrays import Values
from gaitdisc.simulation.checking import check_expression
from gaitdisc.simulation.delays import delay_series
from gaitdisc.simulation.expression import names as names_in
from gaitdisc.simulation.program import Program, at_points, compile_program, leaf_columns
from gaitdisc.simulation.running import compile_simulation, simulation_scope
from gaitdisc.simulation.simulation import Simulation


@dataclass(frozen=True, eq=False)
class Points:
    """Where expressions are evaluated."""

    t: ArrayLike  # (point,), time [s]
    x: Values  # (point, state), states
    u: Values  # (point, input), inputs
    # (parameter,) or (point, parameter), parameters; the simulation's own where absent
    values: Values | None = None
    # mapping of str to float or (point,), further names, and their values
    extras: Mapping[str, float | Values] = field(default_factory=dict)
    # samples a second [Hz] where the points are consecutive samples of one trial, so that delays have a value; 0 where
    # they are not
    rate: float = 0.0


def evaluate(simulation: Simulation, expression: str, points: Points) -> Values:
    """Value (point,) of one expression of a simulation's names and the points' extras at each point.

    >>> from gaitdisc.simulation.parts import State
    >>> decay = Simulation("decay", (State("x"),), equations=(("x", "-x"),))
    >>> points = Points(np.zeros(2), np.array([[1.0], [3.0]]), np.empty((2, 0)), extras={"gain": 2})
    >>> evaluate(decay, "gain*x**2", points)
    array([ 2., 18.])
    """
    return evaluate_many(simulation, [expression], points)[0]


def evaluate_many(simulation: Simulation, expressions: Sequence[str], points: Points) -> Values:
    """Value of many expressions at each point, (expression, point); what they share is computed once."""
    compiled = compile_simulation(simulation)
    program = _program_of(simulation, tuple(expressions), tuple(points.extras))
    values = compiled.defaults if points.values is None else np.asarray(points.values, float)
    columns = leaf_columns(points.t, points.x, points.u, values)
    columns += [np.asarray(extra, float) for extra in points.extras.values()]
    count = len(np.atleast_1d(columns[0]))
    if not program.delays:
        return at_points(program, columns, None, count)
    if points.rate <= 0:
        raise SimulationError(
            "delay(signal, seconds) needs consecutive samples of one trial",
            "the points have no rate",
            "Give Points(..., rate=...) with the samples of a single trial.",
        )
    ago = compile_program([seconds for _, seconds in program.delays], program.leaves)
    seconds = at_points(ago, columns, None, count)
    late = np.empty((count, len(program.delays)))
    for k, (signal, _) in enumerate(program.delays):
        wraps = any(each.wraps for each in simulation.inputs if each.name == signal)
        late[:, k] = delay_series(columns[program.leaves.index(signal)], seconds[k], points.rate, wraps)
    return at_points(program, columns, late, count)


@lru_cache(maxsize=16)  # trial after trial, and turn after turn, the same expressions are evaluated
def _program_of(simulation: Simulation, expressions: tuple[str, ...], extras: tuple[str, ...]) -> Program:
    compiled = compile_simulation(simulation)
    names = ("t", *compiled.states, *compiled.inputs, *compiled.parameters, *extras)
    scope = simulation_scope(simulation)
    known = dict.fromkeys((*names, *scope))
    trees = [check_expression(text, known, simulation) for text in expressions]
    needed = {name for tree in trees for name in names_in(tree)}
    for name in reversed([*scope]):  # definitions that stand in these, one in another: no other's delays matter
        if name in needed:
            needed.update(names_in(scope[name]))
    return compile_program(trees, names, (), {name: tree for name, tree in scope.items() if name in needed})
