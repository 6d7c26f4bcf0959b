"""Units of an effect's numbers, written as a person writes them: `N m s/rad` from a moment and a speed."""

from __future__ import annotations

import math
import re
from collections.abc import Mapping

from gaitdisc.simulation.expression import Name, Number, Operation, Tree, parsed
from gaitdisc.simulation.simulation import Simulation

Powers = dict[str, float]
_SAME = frozenset(["+", "-", "max", "min", "neg", "abs", "delay"])
_ANGLE = re.compile(r"^rad(?=$|/s)")
IN_DEGREES = 1e-3  # off 180/pi, as people round it
_WORD = re.compile(r"(.*?)\^?(-?\d+)?")


def places_unit(simulation: Simulation, kind: str, place: str) -> str:
    """Return the unit of what is added at a port, or to the derivative of a state.

    >>> from gaitdisc.simulation.simulation_file import bundled
    >>> places_unit(bundled("ankle"), "port", "ankle_moment")
    'N m'
    """
    if kind == "port":
        return next(port.unit for port in simulation.ports if port.name == place)
    return divided(next(state.unit for state in simulation.states if state.name == place), "s")


def divided(unit: str, by: str) -> str:
    """Return one unit over another.

    >>> divided("N m", "rad/s"), divided("1", "s"), divided("N", "N")
    ('N m s/rad', '1/s', '1')
    """
    return _written(_product(_powers(unit), _powers(by), -1))


def unit_of(expression: str, units: Mapping[str, str]) -> str:
    """Return the unit of an expression.

    units: unit by name; a name that is not there is a pure number

    >>> unit_of("v*abs(v)", {"v": "rad/s"}), unit_of("max(0, x - x0)", {"x": "m"})
    ('rad^2/s^2', 'm')
    """
    return _written(_of(parsed(expression), {name: _powers(unit) for name, unit in units.items()}) or {})


def unit_of_state(simulation: Simulation, rate: str) -> str:
    """Return the unit of a state whose time derivative is an expression.

    >>> from gaitdisc.simulation.simulation_file import bundled
    >>> unit_of_state(bundled("ankle"), "omega - abs(omega)*z/0.1")
    'rad'
    """
    units = {part.name: part.unit for part in (*simulation.states, *simulation.inputs)}
    return divided(unit_of(rate, units), "1/s")


def channel_unit(expression: str, units: Mapping[str, str]) -> str:
    """Return the unit of an observed channel; of one in other units than its states', `1` where it is not known.

    >>> of = {"theta": "rad", "x": "m"}
    >>> [channel_unit(text, of) for text in ("theta", "57.2958*theta", "-1*theta", "1000*x", "x + 0.1")]
    ['rad', 'deg', 'rad', '1', 'm']
    """
    unit, factor = unit_of(expression, units), _factor(parsed(expression))
    if abs(abs(factor) - 1) < 1e-9:
        return unit
    if _ANGLE.match(unit) and abs(abs(factor) * math.pi / 180 - 1) < IN_DEGREES:
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


def _factor(tree: Tree) -> float:
    """Return the bare number by which an expression is multiplied; of a sum, that of its first signal."""
    if isinstance(tree, Number):
        return tree.value
    if isinstance(tree, Name):
        return 1.0
    if tree.symbol in ("*", "/"):
        first, second = (_factor(argument) for argument in tree.arguments)
        return first * second if tree.symbol == "*" else first / (second or 1.0)
    if tree.symbol in _SAME:
        signals = [argument for argument in tree.arguments if not isinstance(argument, Number)]
        return _factor(signals[0]) if signals else 1.0
    return 1.0


def _of(tree: Tree, units: Mapping[str, Powers]) -> Powers | None:
    """Powers of an expression's unit; None of a bare number, which may have any."""
    if not isinstance(tree, Operation):
        return units.get(tree.name) if isinstance(tree, Name) else None
    parts = [_of(argument, units) for argument in tree.arguments]
    if tree.symbol in _SAME:
        return next((part for part in parts if part is not None), None)
    if tree.symbol in ("*", "/"):
        return _product(parts[0] or {}, parts[1] or {}, 1 if tree.symbol == "*" else -1)
    exponent = Number(0.5) if tree.symbol == "sqrt" else tree.arguments[-1]
    if tree.symbol not in ("sqrt", "**") or not isinstance(exponent, Number):
        return {}
    return {name: power * exponent.value for name, power in (parts[0] or {}).items()}


def _product(one: Powers, other: Powers, sign: int) -> Powers:
    product = dict(one)
    for name, power in other.items():
        product[name] = product.get(name, 0.0) + sign * power
    return {name: power for name, power in product.items() if power}


def _powers(unit: str) -> Powers:
    powers: Powers = {}
    for number, group in enumerate(unit.split("/")):
        for word in re.split(r"[ .*·]+", group.strip("() ")):
            found = _WORD.fullmatch(word)
            if found and found[1] and word != "1":
                powers = _product(powers, {found[1]: float(found[2] or 1)}, -1 if number else 1)
    return powers


def _written(powers: Powers) -> str:
    above = [_word(name, power) for name, power in powers.items() if power > 0]
    below = [_word(name, -power) for name, power in powers.items() if power < 0]
    under = below[0] if len(below) == 1 else f"({' '.join(below)})"
    return (" ".join(above) or "1") + (f"/{under}" if below else "")


def _word(name: str, power: float) -> str:
    return name if power == 1 else f"{name}^{power:g}"
