"""Whether an observation's column has a unit that its expression can have."""

from __future__ import annotations

import math

from gaitdisc.simulation.expression import Name, Number, Operation, Tree, parsed
from gaitdisc.simulation.parts import Sensor
from gaitdisc.simulation.refusal import SimulationError
from gaitdisc.simulation.simulation import Simulation
from gaitdisc.simulation.unit_check import dimension_in
from gaitdisc.simulation.unit_factor import dimension_of, unit_factor

ROUNDED = 2e-3  # of a factor between units, as people write it: 57.3


def refuse_units(simulation: Simulation) -> None:
    """Refuse an observation whose unit is not that of its expression; one of unknown units is passed over.

    >>> from gaitdisc.simulation.parts import State
    >>> ankle = Simulation("ankle", (State("theta", "rad"),), equations=(("theta", "-theta"),))
    >>> refuse_units(ankle.with_sensor(Sensor("theta", "deg")))  # doctest: +ELLIPSIS
    Traceback (most recent call last):
    ...
    gaitdisc.simulation.refusal.SimulationError: [observations] theta: an observation is in ... Write 57.2958*theta.
    """
    for name, text in simulation.observations:
        sensor = simulation.sensor(name)
        wanted = dimension_of(sensor.unit) if sensor.unit else None
        if wanted is None:
            continue
        tree = parsed(text)
        found = dimension_in(simulation, text)
        if found is not None and found != wanted:
            raise _unlike(sensor, f"{text!r} is of another kind", "Correct the unit, or the expression.")
        _refuse_factor(simulation, sensor, tree)


def _refuse_factor(simulation: Simulation, sensor: Sensor, tree: Tree) -> None:
    """Refuse a state or input, bare or times a number, that is not what the unit makes of it."""
    units = {part.name: part.unit for part in (*simulation.states, *simulation.inputs)}
    number, name = _scaled(tree)
    factor = unit_factor(units[name], sensor.unit) if name in units else None
    if factor is None:
        return
    if math.isnan(factor):
        raise _unlike(sensor, f"{name!r} is of another kind, {units[name]}", "Correct the unit, or the expression.")
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
    needed = f"an observation is in the unit of its column, {sensor.unit!r}"
    return SimulationError(needed, found, remedy, ("observations", sensor.channel))
