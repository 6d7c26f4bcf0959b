"""Simulations that are their equations, where units, titles and bounds do not matter."""

from gaitdisc.simulation.parts import Input, Parameter, State, Term
from gaitdisc.simulation.simulation import Simulation


def system(equations, inputs=(), parameters=None, observations=()) -> Simulation:
    """Simulation with a state for each equation; numbers and expressions by name."""
    states, driven = map(State, equations), map(Input, inputs)
    numbers = (Parameter(name, float(value)) for name, value in (parameters or {}).items())
    return Simulation("a system", states, driven, numbers, equations=equations, observations=observations)  # type: ignore[arg-type]


def effect_text(effect: Term) -> str:
    """Entry of a simulation file that adds an effect at a port."""
    return f'\n[[effects]]\nport = "{effect.place}"\nname = "{effect.name}"\nterm = "{effect.term}"\n'
