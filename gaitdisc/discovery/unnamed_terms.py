"""Plain terms without a name in the catalogue: an input, a state times an input, the acceleration of another body."""

from __future__ import annotations

from collections.abc import Iterator

from gaitdisc.discovery.candidate import Candidate
from gaitdisc.discovery.places import Place, kinematic_rates
from gaitdisc.simulation.expression import Tree, parsed, substituted, written
from gaitdisc.simulation.running import compile_simulation
from gaitdisc.simulation.simulation import Simulation

NAME = "unnamed"
MEANS = "an effect that is not in the catalogue"


def unnamed_terms(simulation: Simulation, places: tuple[Place, ...]) -> tuple[Candidate, ...]:
    """List them at every place."""
    rate_of = kinematic_rates(simulation, compile_simulation(simulation))
    inputs = [one.name for one in simulation.driving if one.name != "phase"]
    return tuple(
        Candidate("missing_physics", place.kind, place.name, NAME, (term,), None, place.motions[0][0], MEANS)
        for place in places
        for term in _terms(simulation, place, inputs, rate_of)
    )


def _terms(simulation: Simulation, place: Place, inputs: list[str], rate_of: dict[str, str]) -> Iterator[str]:
    own, rate = place.motions[0]
    for name in inputs:
        yield name
        yield f"{own}*{name}"
    if rate and isinstance(simulation, Simulation):
        for other, speed in rate_of.items():
            if other != own:
                yield _acceleration(simulation, speed)


def _acceleration(simulation: Simulation, speed: str) -> str:
    """The right-hand side of a rate, definitions written out and nothing at the ports."""
    by: dict[str, Tree] = {port.name: parsed("0") for port in simulation.ports}
    for name, text in simulation.definitions:
        by[name] = substituted(parsed(text), by, simulation.signals)
    return written(substituted(parsed(dict(simulation.equations)[speed]), by, simulation.signals))
