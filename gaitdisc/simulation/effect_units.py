"""Units of an effect's numbers, written as a person writes them: `N m s/rad` from a moment and a speed."""

from __future__ import annotations

import math
import re
from collections.abc import Mapping

from gaitdisc.simulation.expression import parsed
from gaitdisc.simulation.simulation import Simulation
from gaitdisc.simulation.unit_check import factor_of, multiplied, powers_in, unit_of_powers, unit_powers

_ANGLE = re.compile(r"^rad(?=$|/s)")
IN_DEGREES = 1e-3  # off 180/pi, as people round it


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
    return unit_of_powers(multiplied(unit_powers(unit), unit_powers(by), -1))


def unit_of(expression: str, units: Mapping[str, str]) -> str:
    """Return the unit of an expression.

    units: unit by name; a name that is not there is a pure number

    >>> unit_of("v*abs(v)", {"v": "rad/s"}), unit_of("max(0, x - x0)", {"x": "m"})
    ('rad^2/s^2', 'm')
    """
    return unit_of_powers(
        powers_in(parsed(expression), {name: unit_powers(unit) for name, unit in units.items()}, {}) or {}
    )


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
    unit, scale = unit_of(expression, units), abs(factor_of(parsed(expression))[0])
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
