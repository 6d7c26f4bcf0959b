"""One trial solved with an adaptive step: the reference that fixed steps are checked by."""

from collections.abc import Callable, Mapping

import numpy as np
from numpy.typing import ArrayLike, NDArray

from gaitdisc.errors import SamplingError, SimulationError
from gaitdisc.simulation.compiled_simulation import Compiled
from gaitdisc.simulation.machine import BOUND
from gaitdisc.simulation.running import compile_simulation
from gaitdisc.simulation.simulation import Simulation

TOLERANCE = 1e-12  # relative and absolute
Rates = Callable[[float, NDArray[np.float64]], NDArray[np.float64]]


def solve(
    simulation: Simulation,
    time: ArrayLike,
    inputs: Mapping[str, ArrayLike],
    initial: Mapping[str, float],
    tolerance: float = TOLERANCE,
) -> NDArray[np.float64]:
    """States of one trial by an adaptive Runge-Kutta method of order 8, (sample, state).

    time (sample,): increasing [s]
    inputs each (sample,): linear between the samples; each sample is a corner that a step ends at
    Source: Hairer, Norsett, Wanner 1993, Solving Ordinary Differential Equations I: DOP853, as scipy has it.

    >>> from gaitdisc.simulation.parts import State
    >>> decay = Simulation("decay", (State("x"),), equations=(("x", "-x"),))
    >>> round(float(solve(decay, [0.0, 1.0], {}, {"x": 1.0})[-1, 0]), 9)
    0.367879441
    """
    compiled = compile_simulation(simulation)
    if compiled.right_hand_side.delays:
        raise SimulationError(
            "an adaptive step needs a simulation without delays",
            f"{simulation.title!r} delays {compiled.right_hand_side.delays[0][0]!r}",
            "Run it with a fixed step: compile_simulation(...).run(...).",
        )
    times = np.asarray(time, float)
    if times.ndim != 1 or not np.all(np.diff(times) > 0):
        raise SamplingError("times increase from sample to sample", "these do not", "Sort them.")
    rates = _driven(compiled, times, inputs)
    found = np.empty((len(times), len(compiled.states)))
    found[0] = [initial[name] for name in compiled.states]
    first = 0
    for corner in range(1, len(times)) if compiled.inputs else [len(times) - 1]:
        found[first : corner + 1] = _solved(compiled, rates, times[first : corner + 1], found[first], tolerance)
        first = corner
    return found


def _driven(compiled: Compiled, times: NDArray[np.float64], inputs: Mapping[str, ArrayLike]) -> Rates:
    """Derivatives of the states at any time, under inputs that are linear between their samples."""
    drive = np.column_stack(
        [np.asarray(inputs[name], float) for name in compiled.inputs] or [np.empty((len(times), 0))]
    )
    wraps = [each.wraps for each in compiled.simulation.inputs]
    drive[:, wraps] = np.unwrap(drive[:, wraps], period=1.0, axis=0)

    def rates(t: float, x: NDArray[np.float64]) -> NDArray[np.float64]:
        u = np.array([[np.interp(t, times, column) for column in drive.T]]).reshape(1, -1)
        u[:, wraps] %= 1.0
        return compiled.rates(np.array([t]), x[None], u)[0]

    return rates


def _solved(
    compiled: Compiled, rates: Rates, span: NDArray[np.float64], x0: NDArray[np.float64], tolerance: float
) -> NDArray[np.float64]:
    """States at the times of a span without a corner, (time, state)."""
    from scipy.integrate import solve_ivp

    part = solve_ivp(
        rates, (span[0], span[-1]), x0, method="DOP853", t_eval=span, rtol=tolerance, atol=tolerance, events=_beyond
    )
    if not part.success or part.status == 1:
        worst = compiled.states[int(np.argmax(np.abs(part.y[:, -1])))] if part.y.size else compiled.states[0]
        raise SimulationError(
            "a solution stays finite",
            f"{compiled.simulation.title!r} leaves every bound after t = {part.t[-1] if part.t.size else span[0]:.6g} "
            f"s in {worst!r}",
            "Check the parameters and the start, or whether an effect pushes without limit.",
        )
    return part.y.T


def _beyond(_t: float, x: NDArray[np.float64]) -> float:
    """Fall through zero where a state passes the bound."""
    return float(BOUND - np.max(np.abs(x))) if np.all(np.isfinite(x)) else -1.0


setattr(_beyond, "terminal", True)  # noqa: B010 the way in which solve_ivp takes it
