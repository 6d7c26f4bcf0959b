"""Values of any expression of a simulation's names at many points, of delayed signals too; which delays have a meaning.

Effects are scored along trajectories by these values.
"""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from functools import lru_cache

import numpy as np
from numpy.typing import ArrayLike

from gaitdisc.errors import SimulationError
from gaitdisc.recording.arrays import Values
from gaitdisc.simulation.checking import check_expression
from gaitdisc.simulation.expression import Name, Tree, delays, names, parse, written
from gaitdisc.simulation.program import Program, at_points, compile_program, leaf_columns
from gaitdisc.simulation.python_simulation import PythonSimulation
from gaitdisc.simulation.running import compile_simulation, simulation_scope
from gaitdisc.simulation.simulation import Simulation

LONGEST_S = 86_400.0  # of a delay, where no trial says how long: no trial lasts a day


@dataclass(frozen=True, eq=False)
class Points:
    """Where expressions are evaluated."""

    t: ArrayLike  # (point,), time [s]
    x: Values  # (point, state), states
    u: Values  # (point, input), inputs
    # (parameter,) or (point, parameter), parameters; the simulation's own where absent
    values: Values | None = None
    extras: Mapping[str, float | Values] = field(default_factory=dict)  # values of further names
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
            "delay(signal, seconds) must have consecutive samples of one trial",
            "the points have no rate",
            "Give Points(..., rate=...) with the samples of a single trial.",
        )
    ago = compile_program([seconds for _, seconds in program.delays], program.leaves)
    seconds = at_points(ago, columns, None, count)
    late = np.empty((count, len(program.delays)))
    for k, (signal, _) in enumerate(program.delays):
        wraps = any(driver.wraps for driver in simulation.inputs if driver.name == signal)
        late[:, k] = delay_series(columns[program.leaves.index(signal)], seconds[k], points.rate, wraps)
    return at_points(program, columns, late, count)


@lru_cache(maxsize=16)  # trial after trial, and turn after turn, the same expressions are evaluated
def _program_of(simulation: Simulation, expressions: tuple[str, ...], extras: tuple[str, ...]) -> Program:
    compiled = compile_simulation(simulation)
    leaves = ("t", *compiled.states, *compiled.inputs, *compiled.parameters, *extras)
    scope = simulation_scope(simulation)
    known = dict.fromkeys((*leaves, *scope))
    trees = [check_expression(text, known, simulation) for text in expressions]
    needed = {name for tree in trees for name in names(tree)}
    for name in reversed([*scope]):  # definitions that stand in these, one in another: no other's delays matter
        if name in needed:
            needed.update(names(scope[name]))
    return compile_program(trees, leaves, (), {name: tree for name, tree in scope.items() if name in needed})


def delay_series(signal: Values, seconds: Values, rate: float, wraps: bool = False) -> Values:
    """Signal some seconds ago, one number or one a sample, linear between samples and held at the first.

    >>> delay_series(np.arange(4.0), np.array(0.15), 10.0).tolist()
    [0.0, 0.0, 0.5, 1.5]
    """
    at = np.clip(np.arange(len(signal)) - seconds * rate, 0, len(signal) - 1)
    k = at.astype(int)
    slope = signal[np.minimum(k + 1, len(signal) - 1)] - signal[k]
    if wraps:
        slope -= np.round(slope)
    value = np.where(at > k, signal[k] + (at - k) * slope, signal[k])
    return value % 1.0 if wraps else value


def refuse_delays(simulation: Simulation | PythonSimulation, shortest_s: float = LONGEST_S, trial: str = "") -> None:
    """Refuse delays that are no number, that reach into the future of a state, or beyond a trial.

    An input is known in full, so that a negative delay of one is a signal that was recorded late.
    """
    values = simulation.values()
    inputs = tuple(signal.name for signal in simulation.inputs)
    lines = [*simulation.expressions()]
    if isinstance(simulation, PythonSimulation):
        lines += [(("inputs", name), text) for name, text in simulation.replaced]
    for place, text in lines:
        try:
            refuse_own_delays(parse(text), values, inputs, shortest_s, trial)
        except SimulationError as error:
            raise error.at(*place) from None


def refuse_own_delays(
    tree: Tree, values: dict[str, float], inputs: tuple[str, ...], shortest_s: float = LONGEST_S, trial: str = ""
) -> None:
    """Refuse such delays of one expression; those whose seconds have names without a value are passed over."""
    for call in delays(tree):
        signal, ago = call.arguments
        if not set(names(ago)) <= set(values):
            continue
        program = compile_program([ago], tuple(values))
        with np.errstate(all="ignore"):
            seconds = float(at_points(program, [np.array(value) for value in values.values()], None, 1)[0, 0])
        fault = f"{written(call)[:60]!r} is {seconds:g} s" + (f" ({written(ago)[:40]})" if set(names(ago)) else "")
        if not np.isfinite(seconds):
            raise SimulationError("a delay must be a number of seconds", fault, "Write a number that is not negative.")
        if seconds < 0 and not (isinstance(signal, Name) and signal.name in inputs):
            raise SimulationError(
                "the delay of a state must not be negative, because its future is unknown",
                fault,
                "Write the delay without the minus sign.",
            )
        if abs(seconds) >= shortest_s:
            raise SimulationError(
                f"a delay must be shorter than the shortest trial ({trial!r}, {shortest_s:.4g} s)"
                if trial
                else f"a delay must be shorter than a day ({shortest_s:g} s)",
                fault,
                "Write the delay in seconds, or remove the trial." if trial else "Write the delay in seconds.",
            )
