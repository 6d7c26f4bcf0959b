"""Whether units of a simulation fit together, which is reported or refused; and those of an effect's numbers."""

import math
import re
from collections.abc import Callable, Mapping

from gaitdisc.errors import SimulationError
from gaitdisc.recording import Finding
from gaitdisc.simulation.expression import Name, Number, Operation, Tree, parse, written
from gaitdisc.simulation.parts import Parameter, Sensor
from gaitdisc.simulation.simulation import Simulation
from gaitdisc.units import Powers, find_dimension, offset_words, unit_factor, unit_words

_SAME = frozenset(["+", "-", "max", "min"])
_CHOSEN = {"neg": 0, "abs": 0, "delay": 0, "where": 1}  # which argument's unit it has
_SUMMED = _SAME | {"abs", "delay"}
_OF_PURE = frozenset({"sin", "cos", "tan", "atan", "tanh", "exp", "log"})
_PURE = _OF_PURE | {"sign", "step"}
ROUNDED = 2e-3  # of a factor between units, as people write it: 57.3
_ANGLE = re.compile(r"^rad(?=$|/s)")
IN_DEGREES = 1e-3  # off 180/pi, as people round it
Report = Callable[[str], None]


def unit_findings(simulation: Simulation) -> tuple[Finding, ...]:
    r"""Warnings where unlike units are added, a port's unit does not fit its place, or a unit is unknown.

    A number or parameter without a unit may carry any, and so does what it multiplies; an angle is a pure number. Of a
    simulation in which nothing but 1 is given as a unit (a plain function, say) there is nothing to report.

    >>> from gaitdisc.simulation.simulation_file import parse_simulation
    >>> text = '[states.x]\nunit = "m"\n[parameters.f]\nvalue = 1\nunit = "N"\n[equations]\nx = "f"\n'
    >>> print(unit_findings(parse_simulation(text))[0].what)
    [equations] x: 'f' must have the unit m/s
    """
    parts = (*simulation.states, *simulation.inputs, *simulation.parameters, *simulation.ports)
    if all(part.unit == "1" for part in parts):
        return ()
    file = simulation.source.name if simulation.source else simulation.title
    findings = []
    for part in parts:
        if find_dimension(part.unit) is None and not getattr(part, "computed", False):
            what = f"{part.unit!r} is not a known unit{offset_words(part.unit)}"
            findings.append(Finding("note", "unit", file, what, "the check of units in sums", part.name))

    def report(what: str) -> None:
        findings.append(Finding("warning", "unit", file, what, "the numbers in this sum, if the units are right"))

    known = _list_units(simulation, report)
    units = {part.name: part.unit for part in parts}
    places = [(f"[equations] {name}", "equation", name, text) for name, text in simulation.equations]
    places += [(f"[effects] {n}", e.kind, e.place, e.term) for n, e in enumerate(simulation.effects, 1)]
    for where, kind, place, text in places:
        expected, unit = known[place], units[place]
        if kind == "equation":
            expected, unit = None if expected is None else multiply(expected, {"s": 1}, -1), f"{unit}/s"
        tree = parse(text)
        powers = powers_in(tree, known, None, _at(where, report))
        if powers is not None and expected is not None and find_dimension(powers) != find_dimension(expected):
            report(f"{where}: {_short(tree)} must have the unit {unit}")
    return tuple(findings)


def powers_in(
    tree: Tree, units: Mapping[str, Powers | None], bare: Powers | None, report: Report | None = None
) -> Powers | None:
    """Powers of an expression's unit; None where it may have any.

    units: of the names; None of one whose unit nobody knows
    bare: what a number without a name counts as where it multiplies; None where the product may then have any unit
    report: called with each sum of unlike units
    """
    if not isinstance(tree, Operation):
        return units.get(tree.name) if isinstance(tree, Name) else None
    powers = [powers_in(argument, units, bare, report) for argument in tree.arguments]
    if tree.symbol in _SAME:
        return _alike(tree, powers, report)
    if tree.symbol in _PURE:
        if report and tree.symbol in _OF_PURE and powers[0] is not None and any(find_dimension(powers[0]) or ()):
            report(f"the argument of {_short(tree)} must be a pure number or an angle")
        return {}
    if tree.symbol in _CHOSEN:
        return powers[_CHOSEN[tree.symbol]]
    first, second = (bare if part is None else part for part in (powers[0], powers[-1]))
    if tree.symbol in ("sqrt", "**"):
        exponent = Number(0.5) if tree.symbol == "sqrt" else tree.arguments[1]
        raised = exponent.value if isinstance(exponent, Number) else None
        return bare if first is None or raised is None else {word: raised * power for word, power in first.items()}
    return None if first is None or second is None else multiply(first, second, 1 if tree.symbol == "*" else -1)


def _alike(tree: Operation, powers: list[Powers | None], report: Report | None) -> Powers | None:
    """Unit of a sum or of the largest of several: of the first that has one, if the others have no other."""
    there = [(part, argument) for part, argument in zip(powers, tree.arguments, strict=True) if part is not None]
    unlike = (pair for pair in there[1:] if find_dimension(pair[0]) != find_dimension(there[0][0]))
    if report is not None:
        for _, argument in unlike:
            word = "compared" if tree.symbol in ("max", "min") else "added"
            report(f"{_short(there[0][1])} and {_short(argument)} are {word} but differ in unit")
            return None
    return there[0][0] if there else None


def unit_powers(unit: str) -> Powers:
    """Power of each word of a unit, known or not."""
    powers: Powers = {}
    for word, power in unit_words(unit):
        if word not in ("", "1"):
            powers = multiply(powers, {word: power})
    return powers


def multiply(powers: Powers, other: Powers, sign: int = 1) -> Powers:
    """Powers of a product; with the sign -1 of a quotient."""
    product = dict(powers)
    for word, power in other.items():
        product[word] = product.get(word, 0) + sign * power
    return {word: power for word, power in product.items() if power}


def unit_of_powers(powers: Powers) -> str:
    """Unit as a person writes it.

    >>> unit_of_powers({"N": 1, "m": 1, "s": 2, "rad": -1}), unit_of_powers({})
    ('N m s^2/rad', '1')
    """
    words = {word: word if abs(power) == 1 else f"{word}^{abs(power):g}" for word, power in powers.items()}
    above, below = ([words[word] for word in powers if sign * powers[word] > 0] for sign in (1, -1))
    under = below[0] if len(below) == 1 else f"({' '.join(below)})"
    return (" ".join(above) or "1") + (f"/{under}" if below else "")


def find_factor(tree: Tree) -> tuple[float, Tree]:
    """Number by which an expression is multiplied, of a sum that of its first signal; and what it multiplies.

    >>> find_factor(parse("-2*x")), find_factor(parse("3*x + 1"))[0]
    ((-2.0, Name(name='x')), 3.0)
    """
    if not isinstance(tree, Operation):
        return (tree.value if isinstance(tree, Number) else 1.0), tree
    if tree.symbol == "neg":
        number, rest = find_factor(tree.arguments[0])
        return -number, rest
    if tree.symbol in ("*", "/"):
        (factor, left), (other, right) = map(find_factor, tree.arguments)
        number = factor * other if tree.symbol == "*" else factor / (other or 1.0)
        if isinstance(right, Number):
            return number, left
        return number, right if isinstance(left, Number) and tree.symbol == "*" else tree
    signals = [part for part in tree.arguments if not isinstance(part, Number)] if tree.symbol in _SUMMED else []
    return (find_factor(signals[0])[0] if signals else 1.0), tree


def refuse_units(simulation: Simulation) -> None:
    """Refuse an observation whose unit is not that of its expression; one of unknown units is passed over.

    >>> from gaitdisc.simulation.parts import State
    >>> ankle = Simulation("ankle", (State("theta", "rad"),), equations=(("theta", "-theta"),))
    >>> refuse_units(ankle.with_sensor(Sensor("theta", "deg")))  # doctest: +ELLIPSIS
    Traceback (most recent call last):
    ...
    gaitdisc.errors.SimulationError: [observations] theta: an observation must ... Write 57.2958*theta.
    """
    for name, text in simulation.observations:
        sensor = simulation.sensor(name)
        dimension = find_dimension(sensor.unit) if sensor.unit else None
        if dimension is None:
            continue
        tree = parse(text)
        powers = powers_in(tree, _list_units(simulation), None)
        if powers is not None and find_dimension(powers) != dimension:
            raise _unlike(sensor, f"{text!r} has a unit of another dimension", "Correct the unit or the expression.")
        _refuse_factor(simulation, sensor, tree)


def _refuse_factor(simulation: Simulation, sensor: Sensor, tree: Tree) -> None:
    """Refuse a state or input, bare or times a number, that is not what the unit makes of it."""
    units = {part.name: part.unit for part in (*simulation.states, *simulation.inputs)}
    number, name = find_factor(tree)
    unit = units.get(name.name) if isinstance(name, Name) else None
    factor = None if unit is None else unit_factor(unit, sensor.unit)
    if factor is None or unit is None:
        return
    text = written(name)
    if math.isnan(factor):
        raise _unlike(sensor, f"{text!r} has a unit of another dimension, {unit}", "Correct unit or expression.")
    if abs(abs(number) / factor - 1) > ROUNDED and (abs(number) == 1.0 or _is_of_units(abs(number), unit)):
        raise _unlike(sensor, f"{text!r} is in {unit}", f"Write {math.copysign(factor, number):.6g}*{text}.")


def _is_of_units(number: float, unit: str) -> bool:
    """Whether a number is a factor between units, and not a gain of the sensor's own."""
    angle, length = find_dimension("rad"), find_dimension("m")
    others = {angle: ("rad", "deg"), length: ("m", "cm", "mm")}.get(find_dimension(unit), ())
    return any(abs(number / factor - 1) < ROUNDED for other in others if (factor := unit_factor(unit, other)))


def _unlike(sensor: Sensor, fault: str, remedy: str) -> SimulationError:
    needed = f"an observation must have the unit of its column, {sensor.unit!r}"
    return SimulationError(needed, fault, remedy, ("observations", sensor.channel))


def _list_units(simulation: Simulation, report: Report | None = None) -> dict[str, Powers | None]:
    """Units of all names; None of what may have any: an unknown one, a parameter without, what an engine computes."""
    known: dict[str, Powers | None] = {"t": {"s": 1}}
    for part in (*simulation.states, *simulation.inputs, *simulation.parameters, *simulation.ports):
        free = (isinstance(part, Parameter) and part.unit == "1") or getattr(part, "computed", False)
        known[part.name] = None if free or find_dimension(part.unit) is None else unit_powers(part.unit)
    for name, text in simulation.definitions:
        known[name] = powers_in(parse(text), known, None, report and _at(f"[definitions] {name}", report))
    return known


def _at(where: str, report: Report) -> Report:
    return lambda what: report(f"{where}: {what}")


def _short(tree: Tree) -> str:
    text = written(tree)
    return repr(text if len(text) <= 40 else text[:37] + "...")


def places_unit(simulation: Simulation, kind: str, place: str) -> str:
    """Return the unit of what is added at a port, or to the derivative of a state.

    >>> from gaitdisc.simulation.simulation_file import bundled
    >>> places_unit(bundled("ankle"), "port", "ankle_moment")
    'N m'
    """
    if kind == "port":
        return next(port.unit for port in simulation.ports if port.name == place)
    return divide(next(state.unit for state in simulation.states if state.name == place), "s")


def divide(unit: str, by: str) -> str:
    """Return one unit over another.

    >>> divide("N m", "rad/s"), divide("1", "s"), divide("N", "N")
    ('N m s/rad', '1/s', '1')
    """
    return unit_of_powers(multiply(unit_powers(unit), unit_powers(by), -1))


def find_unit(expression: str, units: Mapping[str, str]) -> str:
    """Return the unit of an expression by the units of its names; a name without one is a pure number.

    >>> find_unit("v*abs(v)", {"v": "rad/s"}), find_unit("max(0, x - x0)", {"x": "m"})
    ('rad^2/s^2', 'm')
    """
    return unit_of_powers(
        powers_in(parse(expression), {name: unit_powers(unit) for name, unit in units.items()}, {}) or {}
    )


def unit_of_state(simulation: Simulation, rate: str) -> str:
    """Return the unit of a state whose time derivative is an expression.

    >>> from gaitdisc.simulation.simulation_file import bundled
    >>> unit_of_state(bundled("ankle"), "omega - abs(omega)*z/0.1")
    'rad'
    """
    units = {part.name: part.unit for part in (*simulation.states, *simulation.inputs)}
    return divide(find_unit(rate, units), "1/s")


def channel_unit(expression: str, units: Mapping[str, str]) -> str:
    """Return the unit of an observed channel; of one in other units than its states', `1` where it is not known.

    >>> of = {"theta": "rad", "x": "m"}
    >>> [channel_unit(text, of) for text in ("theta", "57.2958*theta", "-1*theta", "1000*x", "x + 0.1")]
    ['rad', 'deg', 'rad', '1', 'm']
    """
    unit, scale = find_unit(expression, units), abs(find_factor(parse(expression))[0])
    if abs(scale - 1) < 1e-9:
        return unit
    if _ANGLE.match(unit) and abs(scale * math.pi / 180 - 1) < IN_DEGREES:
        return _ANGLE.sub("deg", unit)
    return "1"


def unit_of_channel(simulation: Simulation, channel: str) -> str:
    """Return the unit of an observed channel: the file's, or what follows from its expression.

    >>> from gaitdisc.simulation.simulation_file import bundled
    >>> unit_of_channel(bundled("ankle"), "theta")
    'rad'
    """
    units = {part.name: part.unit for part in (*simulation.states, *simulation.inputs, *simulation.parameters)}
    expression = dict(simulation.observations).get(channel, channel)
    return simulation.sensor(channel).unit or channel_unit(expression, units | {"t": "s"})
