"""Whether the seconds of every delay have a meaning: not the future of a state, not more than a trial holds."""

from __future__ import annotations

from collections.abc import Iterator

import numpy as np

from gaitdisc.simulation.at_points import at_points
from gaitdisc.simulation.expression import Name, Tree, delays, names, parsed
from gaitdisc.simulation.program import compiled_program
from gaitdisc.simulation.python_simulation import PythonSimulation
from gaitdisc.simulation.refusal import SimulationError
from gaitdisc.simulation.rewriting import written
from gaitdisc.simulation.simulation import Simulation

LONGEST_S = 86_400.0  # of a delay, where no trial says how long: no trial lasts a day


def refuse_delays(simulation: Simulation | PythonSimulation, shortest_s: float = LONGEST_S, trial: str = "") -> None:
    """Refuse delays that are no number, that reach into the future of a state, or beyond a trial.

    An input is known in full, so that a negative delay of one is a signal that was recorded late.

    shortest_s: length of the shortest trial [s]
    """
    values = simulation.values()
    inputs = tuple(each.name for each in simulation.inputs)
    for place, text in _expressions(simulation):
        try:
            refuse_delays_of(parsed(text), values, inputs, shortest_s, trial)
        except SimulationError as error:
            raise error.at(*place) from None


def refuse_delays_of(
    tree: Tree, values: dict[str, float], inputs: tuple[str, ...], shortest_s: float = LONGEST_S, trial: str = ""
) -> None:
    """Refuse such delays of one expression; those whose seconds have names without a value are passed over.

    shortest_s: length of the shortest trial [s]
    """
    for call in delays(tree):
        signal, ago = call.arguments
        if not set(names(ago)) <= set(values):
            continue
        program = compiled_program([ago], tuple(values))
        with np.errstate(all="ignore"):
            seconds = float(at_points(program, [np.array(one) for one in values.values()], None, 1)[0, 0])
        said = f"{written(call)[:60]!r} is {seconds:g} s" + (f" ({written(ago)[:40]})" if set(names(ago)) else "")
        if not np.isfinite(seconds):
            raise SimulationError("a delay is a number of seconds", said, "Write a number of 0 or more.")
        if seconds < 0 and not (isinstance(signal, Name) and signal.name in inputs):
            raise SimulationError(
                "a delay of a state is 0 s or more: what it will be is not known yet",
                said,
                "Write it without the sign.",
            )
        if abs(seconds) >= shortest_s:
            raise SimulationError(
                f"a delay is shorter than every trial; the shortest, {trial!r}, lasts {shortest_s:.4g} s"
                if trial
                else f"a delay is shorter than a day ({shortest_s:g} s)",
                said,
                "Write seconds, or leave the trial out." if trial else "Write seconds.",
            )


def _expressions(simulation: Simulation | PythonSimulation) -> Iterator[tuple[tuple[str, str], str]]:
    for section in ("definitions", "equations", "observations"):
        for name, text in getattr(simulation, section):
            yield (section, name), text
    for number, effect in enumerate(simulation.effects):
        yield ("effects", str(number)), effect.term
    if isinstance(simulation, PythonSimulation):
        for name, text in simulation.replaced:
            yield ("inputs", name), text
