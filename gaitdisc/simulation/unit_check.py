"""Whether units of a simulation fit together, which is reported, and those of observations, which is refused."""

from __future__ import annotations

import math

from gaitdisc.recording import Finding
from gaitdisc.simulation.expression import Name, Number, Operation, Tree, parsed, written
from gaitdisc.simulation.parts import Sensor
from gaitdisc.simulation.refusal import SimulationError
from gaitdisc.simulation.simulation import Simulation
from gaitdisc.units import Dimension, dimension_of, unit_factor

_SAME = frozenset(["+", "-", "max", "min"])
_OF_PURE = frozenset({"sin", "cos", "tan", "atan", "tanh", "exp", "log"})
_PURE = _OF_PURE | {"sign", "step"}
ROUNDED = 2e-3  # of a factor between units, as people write it: 57.3


def unit_findings(simulation: Simulation) -> tuple[Finding, ...]:
    r"""Warnings where unlike units are added, a port's unit does not fit its place, or a unit is unknown.

    A number without a name may carry any unit, and so does what it multiplies; an angle counts as a pure number. Of a
    simulation in which nothing but 1 is given as a unit (a plain function, say) there is nothing to report.

    >>> from gaitdisc.simulation.simulation_file import simulation_of
    >>> text = '[states.x]\nunit = "m"\n[parameters.f]\nvalue = 1\nunit = "N"\n[equations]\nx = "f"\n'
    >>> print(unit_findings(simulation_of(text))[0].what)
    [equations] x: 'f' must have the unit m/s
    """
    parts = (*simulation.states, *simulation.inputs, *simulation.parameters, *simulation.ports)
    if all(part.unit == "1" for part in parts):
        return ()
    check = _Check(simulation)
    for name, text in simulation.definitions:
        check.known[name] = check.unit(parsed(text), f"[definitions] {name}")
    for name, text in simulation.equations:
        check.expect(text, check.rate(name), f"[equations] {name}", f"{_unit_of(simulation, name)}/s")
    ports = {port.name: port.unit for port in simulation.ports}
    for number, term in enumerate(simulation.effects, 1):
        where = f"[effects] {number}"
        if term.kind == "port":
            check.expect(term.term, check.known[term.place], where, ports[term.place])
        else:
            check.expect(term.term, check.rate(term.place), where, f"{_unit_of(simulation, term.place)}/s")
    return tuple(check.findings)


def dimension_in(simulation: Simulation, text: str) -> Dimension | None:
    """Dimension of an expression in a simulation's names; None where it may be any."""
    check = _Check(simulation)
    for name, definition in simulation.definitions:
        check.known[name] = check.unit(parsed(definition), name)
    return check.unit(parsed(text), text)


def _unit_of(simulation: Simulation, state: str) -> str:
    return next(each.unit for each in simulation.states if each.name == state)


class _Check:
    def __init__(self, simulation: Simulation) -> None:
        self.findings: list[Finding] = []
        self._file = simulation.source.name if simulation.source else simulation.title
        self.known: dict[str, Dimension | None] = {"t": dimension_of("s")}
        self.known |= {part.name: None for part in simulation.inputs if part.computed}  # of any unit that fits
        for part in (*simulation.states, *simulation.driving, *simulation.parameters, *simulation.ports):
            self.known[part.name] = dimension_of(part.unit)
            if self.known[part.name] is None:
                what = f"{part.unit!r} is not a known unit"
                self.findings.append(Finding("note", "unit", self._file, what, "the check of units in sums", part.name))

    def rate(self, state: str) -> Dimension | None:
        """Dimension of a state's derivative."""
        own, second = self.known[state], dimension_of("s")
        return None if own is None or second is None else tuple(a - b for a, b in zip(own, second, strict=True))

    def expect(self, text: str, wanted: Dimension | None, where: str, unit: str) -> None:
        """Report where an expression has another dimension than its place."""
        found = self.unit(parsed(text), where)
        if found is not None and wanted is not None and found != wanted:
            self._report(f"{where}: {_short(parsed(text))} must have the unit {unit}")

    def unit(self, tree: Tree, where: str) -> Dimension | None:
        """Dimension of an expression; None where it may be any."""
        if not isinstance(tree, Operation):
            return self.known.get(tree.name) if isinstance(tree, Name) else None
        parts = [self.unit(argument, where) for argument in tree.arguments]
        if tree.symbol in _SAME:
            return self._alike(tree, parts, where)
        if tree.symbol in _PURE:
            if tree.symbol in _OF_PURE and parts[0] is not None and any(parts[0]):
                self._report(f"{where}: the argument of {_short(tree)} must be a pure number or an angle")
            return dimension_of("1")
        if tree.symbol == "where":
            return parts[1]
        return parts[0] if tree.symbol in ("neg", "abs", "delay") else self._product(tree, parts)

    def _product(self, tree: Operation, parts: list[Dimension | None]) -> Dimension | None:
        one, other = parts[0], parts[-1]
        if tree.symbol in ("sqrt", "**"):
            exponent = Number(0.5) if tree.symbol == "sqrt" else tree.arguments[1]
            if one is None or not isinstance(exponent, Number):
                return None
            return tuple(exponent.value * power for power in one)
        if one is None or other is None:
            return None
        sign = 1 if tree.symbol == "*" else -1
        return tuple(a + sign * b for a, b in zip(one, other, strict=True))

    def _alike(self, tree: Operation, parts: list[Dimension | None], where: str) -> Dimension | None:
        there = [(part, argument) for part, argument in zip(parts, tree.arguments, strict=True) if part is not None]
        for part, argument in there[1:]:
            if part != there[0][0]:
                word = "compared" if tree.symbol in ("max", "min") else "added"
                self._report(f"{where}: {_short(there[0][1])} and {_short(argument)} are {word} but differ in unit")
                return None
        return there[0][0] if there else None

    def _report(self, what: str) -> None:
        self.findings.append(Finding("warning", "unit", self._file, what, "the numbers there, if the units are right"))


def _short(tree: Tree) -> str:
    text = written(tree)
    return repr(text if len(text) <= 40 else text[:37] + "...")


def refuse_units(simulation: Simulation) -> None:
    """Refuse an observation whose unit is not that of its expression; one of unknown units is passed over.

    >>> from gaitdisc.simulation.parts import State
    >>> ankle = Simulation("ankle", (State("theta", "rad"),), equations=(("theta", "-theta"),))
    >>> refuse_units(ankle.with_sensor(Sensor("theta", "deg")))  # doctest: +ELLIPSIS
    Traceback (most recent call last):
    ...
    gaitdisc.simulation.refusal.SimulationError: [observations] theta: an observation must ... Write 57.2958*theta.
    """
    for name, text in simulation.observations:
        sensor = simulation.sensor(name)
        wanted = dimension_of(sensor.unit) if sensor.unit else None
        if wanted is None:
            continue
        tree = parsed(text)
        found = dimension_in(simulation, text)
        if found is not None and found != wanted:
            raise _unlike(sensor, f"{text!r} has another kind of unit", "Correct the unit or expression.")
        _refuse_factor(simulation, sensor, tree)


def _refuse_factor(simulation: Simulation, sensor: Sensor, tree: Tree) -> None:
    """Refuse a state or input, bare or times a number, that is not what the unit makes of it."""
    units = {part.name: part.unit for part in (*simulation.states, *simulation.inputs)}
    number, name = _scaled(tree)
    factor = unit_factor(units[name], sensor.unit) if name in units else None
    if factor is None:
        return
    if math.isnan(factor):
        raise _unlike(sensor, f"{name!r} has another kind of unit, {units[name]}", "Correct the unit or expression.")
    if abs(abs(number) / factor - 1) > ROUNDED and (abs(number) == 1.0 or _is_of_units(abs(number), units[name])):
        raise _unlike(sensor, f"{name!r} is in {units[name]}", f"Write {math.copysign(factor, number):.6g}*{name}.")


def _scaled(tree: Tree) -> tuple[float, str]:
    """Number and name of a name, bare or times a number; no name where it is something else."""
    if isinstance(tree, Name):
        return 1.0, tree.name
    if isinstance(tree, Operation) and tree.symbol == "neg":
        number, name = _scaled(tree.arguments[0])
        return -number, name
    if isinstance(tree, Operation) and tree.symbol == "*":
        one, other = tree.arguments
        one, other = (other, one) if isinstance(other, Number) else (one, other)
        if isinstance(one, Number) and isinstance(other, Name):
            return one.value, other.name
    return 1.0, ""


def _is_of_units(number: float, unit: str) -> bool:
    """Whether a number is a factor between units, and not a gain of the sensor's own."""
    angle, length = dimension_of("rad"), dimension_of("m")
    others = {angle: ("rad", "deg"), length: ("m", "cm", "mm")}.get(dimension_of(unit), ())
    return any(abs(number / factor - 1) < ROUNDED for other in others if (factor := unit_factor(unit, other)))


def _unlike(sensor: Sensor, found: str, remedy: str) -> SimulationError:
    needed = f"an observation must have the unit of its column, {sensor.unit!r}"
    return SimulationError(needed, found, remedy, ("observations", sensor.channel))
