"""Whether the parts of a simulation hold together."""

from __future__ import annotations

import keyword
import math
import re
from collections.abc import Collection, Iterable
from functools import lru_cache
from typing import TYPE_CHECKING

from gaitdisc.channel import did_you_mean
from gaitdisc.errors import SimulationError
from gaitdisc.simulation.expression import RESERVED, Operation, Tree, delays, names, parse, unknown_name
from gaitdisc.simulation.parts import Input, Sensor, Term

if TYPE_CHECKING:
    from gaitdisc.simulation.simulation import Simulation

MOST_PARTS = 500  # states, inputs, parameters, ports, definitions and effects together
MOST_CHARACTERS = 200_000  # of all expressions
_NAME = re.compile(r"[A-Za-z][A-Za-z0-9_]{0,63}\Z")
_KEYWORDS = frozenset(keyword.kwlist)
_NAMED = ("states", "inputs", "parameters", "ports")


def check(simulation: Simulation) -> None:
    """Refuse a simulation whose parts do not hold together."""
    _check_size(simulation)
    _check_names(simulation)
    _check_numbers(simulation)
    _check_inputs(simulation)
    _check_equations(simulation)
    _check_expressions(simulation)
    _check_ports(simulation)
    _check_sensors(simulation)


def _check_size(simulation: Simulation) -> None:
    if not simulation.states:
        raise SimulationError("a simulation must have at least one state", "there is none", "Add [states.<name>].")
    sections = ("states", "driving", "parameters", "ports", "definitions", "observations", "effects")
    n_parts = sum(len(getattr(simulation, section)) for section in sections)
    if n_parts > MOST_PARTS:
        raise SimulationError(
            f"a simulation file may have at most {MOST_PARTS} parts",
            f"this file has {n_parts}",
            "Write a model of this size as a PythonSimulation.",
        )
    characters = sum(len(text) for _, text in simulation.expressions())
    if characters > MOST_CHARACTERS:
        raise SimulationError(
            f"the expressions of a simulation may have at most {MOST_CHARACTERS} characters in total",
            f"they have {characters}",
            "Write a model of this size as a PythonSimulation.",
        )


def _check_names(simulation: Simulation) -> None:
    owner: dict[str, str] = {}
    parts = [(section, part.name) for section in _NAMED for part in getattr(simulation, section)]
    for section, name in [*parts, *(("definitions", name) for name, _ in simulation.definitions)]:
        if not _NAME.match(name) or name in _KEYWORDS:
            raise SimulationError(
                "a name must be a letter followed by letters, digits and _ (at most 64), and not a Python keyword",
                f"found {name[:80]!r}",
                "Rename it.",
                (section, name[:80]),
            )
        if name in RESERVED:
            raise SimulationError(
                "a name must not be t or that of a function", f"found {name!r}", "Rename it.", (section, name)
            )
        if name in owner:
            raise SimulationError(
                "each name must have one meaning",
                f"{name!r} is defined in [{owner[name]}] and in [{section}]",
                "Rename one of them.",
                (section, name),
            )
        owner[name] = section
    observed = [name for name, _ in simulation.observations]
    doubled = next((name for name in observed if observed.count(name) > 1), None)
    if doubled is not None:
        raise SimulationError(
            "observations must have different names",
            f"{doubled!r} occurs twice",
            "Rename one of them.",
            ("observations",),
        )


def _check_numbers(simulation: Simulation) -> None:
    for parameter in simulation.parameters:
        place = ("parameters", parameter.name)
        bounds = [bound for bound in (parameter.low, parameter.high) if bound is not None]
        for number in (parameter.value, *bounds):
            if not math.isfinite(number):
                raise SimulationError("parameters must be finite numbers", f"found {number}", "Write a number.", place)
        if len(bounds) == 2 and bounds[0] > bounds[1]:
            raise SimulationError(
                "low must not exceed high", f"low is {bounds[0]:g}, high {bounds[1]:g}", "Swap the two.", place
            )
    for state in simulation.states:
        if state.initial is not None and not math.isfinite(state.initial):
            fault = f"initial is {state.initial}"
            raise SimulationError(
                "the initial value of a state must be a finite number", fault, "Write a number.", ("states", state.name)
            )


def _check_equations(simulation: Simulation) -> None:
    states = [state.name for state in simulation.states]
    named = [name for name, _ in simulation.equations]
    for name in named:
        if name not in states:
            remedy = did_you_mean(name, states, f"The states are {', '.join(states)}.")
            raise SimulationError(
                "an equation must belong to a state", f"{name!r} is not a state", remedy, ("equations", name)
            )
    for name in states:
        if named.count(name) != 1:
            fault = "it has none" if name not in named else "it has several"
            raise SimulationError(
                f"state {name!r} must have one equation", fault, f'Write {name} = "..." in [equations].', ("equations",)
            )


def _check_expressions(simulation: Simulation) -> None:
    ports = tuple(port.name for port in simulation.ports)
    plain = dict.fromkeys((*simulation.signals, *(parameter.name for parameter in simulation.parameters), "t"))
    known = plain | dict.fromkeys(ports)
    for place, text in simulation.expressions():
        section, name = place
        term = simulation.effects[int(name)] if section == "effects" else None
        if term is not None:
            _check_place(term, ports, tuple(state.name for state in simulation.states), place)
        try:
            check_expression(text, plain if term is not None and term.kind == "port" else known, simulation)
        except SimulationError as error:
            raise error.at(*place) from None
        if section == "definitions":
            known[name] = None


def check_expression(text: str, known: Collection[str], simulation: Simulation) -> Tree:
    """Tree of an expression whose names all have values, some of them signals that may be delayed."""
    tree, named, late = _parse_parts(text)
    unknown = next((name for name in named if name not in known), None)
    if unknown is not None:
        raise unknown_name(text, unknown, tuple(known))
    if not late:
        return tree
    fixed = set(known) - set(simulation.signals) - {"t"} - {port.name for port in simulation.ports}
    fixed -= {name for name, _ in simulation.definitions}
    for call in late:
        signal, seconds = call.arguments
        if next(names(signal), None) not in simulation.signals or set(names(signal)) != {getattr(signal, "name", None)}:
            raise SimulationError(
                "the signal of delay(signal, seconds) must be a state or an input",
                f"in {text[:60]!r} it is neither",
                f"Delay one of: {', '.join(simulation.signals)}.",
            )
        moving = next((name for name in names(seconds) if name not in fixed), None)
        if moving is not None or next(delays(seconds), None) is not None:
            raise SimulationError(
                "the seconds of delay(signal, seconds) must consist of numbers and parameters",
                f"in {text[:60]!r} they use {moving or 'delay'!r}",
                "Write a number or a parameter.",
            )
    return tree


@lru_cache(maxsize=4096)  # a search checks the same equations with each explanation that it tries
def _parse_parts(text: str) -> tuple[Tree, tuple[str, ...], tuple[Operation, ...]]:
    """Tree of an expression, the names in it, each once, and its calls of delay."""
    tree = parse(text)
    return tree, tuple(dict.fromkeys(names(tree))), tuple(delays(tree))


def _check_place(term: Term, ports: Iterable[str], states: Iterable[str], place: tuple[str, ...]) -> None:
    if term.kind not in ("port", "equation"):
        raise SimulationError(
            "an effect must act at a port or in an equation", f"found {term.kind!r}", "Use one of these.", place
        )
    among = tuple(ports if term.kind == "port" else states)
    if term.place not in among:
        raise SimulationError(
            f"effect {term.name!r} must act at a {term.kind} of the simulation",
            f"{term.place!r} does not exist",
            f"Known: {', '.join(among) or 'none'}.",
            place,
        )


def _check_ports(simulation: Simulation) -> None:
    lines = (*simulation.definitions, *simulation.equations)
    used = {name for _, text in lines for name in _parse_parts(text)[1]}
    for port in simulation.ports:
        if port.name not in used:
            raise SimulationError(
                "a port must be used in an equation or a definition",
                f"{port.name!r} is not used, so an effect there would change nothing",
                "Add it to the equation in which it acts, or remove it.",
                ("ports", port.name),
            )


def _check_sensors(simulation: Simulation) -> None:
    observed = [name for name, _ in simulation.observations]
    for sensor in simulation.sensors:
        place = ("observations", sensor.channel)
        if sensor.channel not in observed:
            known = f"Known: {', '.join(observed)}."
            raise SimulationError(
                "a sensor must record an observation", f"{sensor.channel!r} is not an observation", known, place
            )
        _check_positive(sensor, {"sd": sensor.unit or "the column's unit", "lowpass": "Hz"}, place)


def _check_inputs(simulation: Simulation) -> None:
    for signal in simulation.inputs:
        place, errors = ("inputs", signal.name), signal.gain is not None or signal.sd is not None
        _check_positive(signal, {"gain": "1", "sd": signal.unit, "wander": "s"}, place)
        if signal.wander is not None and not errors:
            raise SimulationError("an input with wander must have gain or sd", "it has neither", "Add one.", place)
        if errors and signal.wraps:
            raise SimulationError("the phase of the stride must be exact", "it has gain or sd", "Remove both.", place)


def _check_positive(part: Input | Sensor, units: dict[str, str], place: tuple[str, ...]) -> None:
    for key, unit in units.items():
        number = getattr(part, key)
        if number is not None and not (math.isfinite(number) and number > 0):
            fault = f"found {key} = {number:g}"
            raise SimulationError(f"{key} must be a number above 0 [{unit}]", fault, f"Correct or remove {key}.", place)
