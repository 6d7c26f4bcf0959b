"""A signal some seconds ago; whether the seconds of a delay have a meaning."""

from __future__ import annotations

import numpy as np

from gaitdisc.errors import SimulationError
from gaitdisc.recording.arrays import Values
from gaitdisc.simulation.expression import Name, Tree, delays, names, parse, written
from gaitdisc.simulation.program import at_points, compile_program
from gaitdisc.simulation.python_simulation import PythonSimulation
from gaitdisc.simulation.simulation import Simulation

LONGEST_S = 86_400.0  # of a delay, where no trial says how long: no trial lasts a day


def delay_series(signal: Values, seconds: Values, rate: float, wraps: bool = False) -> Values:
    """Signal some seconds ago, one number or one a sample, linear between samples and held at the first.

    wraps: whether it goes from just below 1 to 0 without passing what lies between

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
    inputs = tuple(each.name for each in simulation.inputs)
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
            seconds = float(at_points(program, [np.array(one) for one in values.values()], None, 1)[0, 0])
        said = f"{written(call)[:60]!r} is {seconds:g} s" + (f" ({written(ago)[:40]})" if set(names(ago)) else "")
        if not np.isfinite(seconds):
            raise SimulationError("a delay must be a number of seconds", said, "Write a number that is not negative.")
        if seconds < 0 and not (isinstance(signal, Name) and signal.name in inputs):
            raise SimulationError(
                "the delay of a state must not be negative, because its future is unknown",
                said,
                "Write the delay without the minus sign.",
            )
        if abs(seconds) >= shortest_s:
            raise SimulationError(
                f"a delay must be shorter than every trial; the shortest, {trial!r}, lasts {shortest_s:.4g} s"
                if trial
                else f"a delay must be shorter than a day ({shortest_s:g} s)",
                said,
                "Write the delay in seconds, or remove the trial." if trial else "Write the delay in seconds.",
            )
