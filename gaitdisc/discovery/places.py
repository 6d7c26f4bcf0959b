"""Places: where in a simulation an effect may enter, and which states it would see there."""

import re
from dataclasses import dataclass, replace
from itertools import combinations, permutations

import numpy as np

from gaitdisc.recording.arrays import Values
from gaitdisc.simulation.compiled_simulation import Compiled
from gaitdisc.simulation.parts import Term
from gaitdisc.simulation.running import compile_simulation
from gaitdisc.simulation.simulation import Simulation

ANGLES = ("rad", "deg")
SPEEDS = re.compile(r"(m|cm|mm|km|rad|deg|rev)/(s|h|min)|rpm")
FORCES = re.compile(r"[kmM]?N( ?c?m)?")
INERTIAS = re.compile(r"k?g( ?c?m(2|\^2|\*\*2))?")


@dataclass(frozen=True)
class Place:
    """A port, or an equation of a model without ports."""

    kind: str
    name: str
    # position-like state and its rate, the place's own first, then its differences with others,
    # then (at a port) the others; the rate is empty for a state that has none (first-order systems), and a speed whose
    # position is no state is its own rate and nothing else
    motions: tuple[tuple[str, str], ...]
    others: tuple[str, ...]  # states that would act here as a coupling
    products: tuple[tuple[str, str], ...]  # pairs of states whose product may act here
    angle: bool  # whether the place's own position is an angle
    power: float = 1.0  # of a positive push: 1 where it drives its own state, -1 where it holds it back


def kinematic_rates(simulation: Simulation) -> dict[str, str]:
    """Find the states whose derivative is plainly another state: position-like state -> its rate."""
    states = [state.name for state in simulation.states]
    rng = np.random.default_rng(0)
    x, u = rng.uniform(0.1, 1.0, (16, len(states))), rng.uniform(0.1, 0.9, (16, len(simulation.inputs)))
    rates = _rates(compile_simulation(simulation), x, u)
    return {
        name: other
        for (position, name), (rate, other) in permutations(enumerate(states), 2)
        if np.array_equal(rates[:, position], x[:, rate])
    }


def list_places(simulation: Simulation) -> tuple[Place, ...]:
    """List where a missing effect may enter: the ports, or else every equation that is not mere kinematics."""
    rate_of, states = kinematic_rates(simulation), tuple(state.name for state in simulation.states)
    if not simulation.ports:
        named = (name for name in states if name not in rate_of)
        return tuple(_place(simulation, "equation", name, name, rate_of) for name in named)
    places = []
    for port in (part.name for part in simulation.ports):
        moved = moved_by(simulation, port)
        driven = find_driven_state(states, port, moved)
        power = float(np.sign(moved[:, states.index(rate_of.get(driven, driven))].sum()))
        places.append(replace(_place(simulation, "port", port, driven, rate_of), power=power))
    return tuple(places)


def find_driven_state(states: tuple[str, ...], port: str, moved: Values) -> str:
    """Name the state that a port drives: the one it is named after, or else the one whose derivative it moves most.

    In a chain of bodies a moment at one joint may move another joint's angle more than its own.
    """
    namesakes = [name for name in states if name in port.split("_")]
    begins = max((name for name in states if port.startswith(f"{name}_")), key=len, default="")
    if begins or len(namesakes) == 1:
        return begins or namesakes[0]
    return states[int(np.argmax(np.abs(moved).mean(axis=0)))]


def moved_by(simulation: Simulation, port: str) -> Values:
    """Return by how much a push of 1 at a port raises each state's derivative (point, state)."""
    rng = np.random.default_rng(0)
    x = rng.uniform(-0.3, 0.3, (16, len(simulation.states)))
    u = rng.uniform(0.1, 0.9, (16, len(simulation.inputs)))
    pushed = simulation.with_effect(Term(port, "port", "push", "1"))
    return _rates(compile_simulation(pushed), x, u) - _rates(compile_simulation(simulation), x, u)


def _rates(machine: Compiled, x: Values, u: Values) -> Values:
    """Rates at points, with nothing coming late."""
    late = np.zeros((len(x), len(machine.right_hand_side.delays)))
    return machine.rates(np.zeros(len(x)), x, u, machine.defaults, late)


def is_speed(simulation: Simulation, kind: str, name: str, state: str) -> bool:
    """Whether a state that no other has as its rate is a speed: by its unit, or as a force moves an inertia there."""
    unit = next(part.unit for part in simulation.states if part.name == state)
    if unit and unit != "1":
        return SPEEDS.fullmatch(unit) is not None
    inertias = [parameter.name for parameter in simulation.parameters if INERTIAS.fullmatch(parameter.unit or "")]
    equation = dict(simulation.equations).get(state, "")
    forces = [port.name for port in simulation.ports if FORCES.fullmatch(port.unit or "")]
    return kind == "port" and name in forces and any(re.search(rf"/ *\(?{inertia}\b", equation) for inertia in inertias)


def _place(simulation: Simulation, kind: str, name: str, driven: str, rate_of: dict[str, str]) -> Place:
    position_of = {rate: position for position, rate in rate_of.items()}
    units = {state.name: state.unit for state in simulation.states}
    position = position_of.get(driven, driven)
    motions = [(position, rate_of.get(position, position if is_speed(simulation, kind, name, position) else ""))]
    if position in rate_of:
        motions += [
            (f"{position} - {other}", f"{rate_of[position]} - {rate_of[other]}")
            for other in rate_of
            if other != position and units[other] == units[position]
        ]
        if kind == "port":
            motions += [(other, rate) for other, rate in rate_of.items() if other != position]
    others = tuple(state.name for state in simulation.states if state.name not in motions[0])
    products = tuple(combinations([state.name for state in simulation.states], 2))
    return Place(kind, name, tuple(motions), others, products, position in rate_of and units[position] in ANGLES)
