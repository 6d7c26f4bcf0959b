"""A simulation whose right-hand side is a Python object: a musculoskeletal model, say."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, field, replace
from functools import cached_property
from typing import Any

import numpy as np

from gaitdisc.errors import SimulationError
from gaitdisc.recording.arrays import Values
from gaitdisc.simulation.parts import Input, Lines, Parameter, Port, State
from gaitdisc.simulation.simulation import Simulation

RightHandSide = Callable[..., Values]


@dataclass(frozen=True)
class PythonSimulation:
    """States, inputs, parameters and ports like a `Simulation`, and equations that are a function.

    It goes wherever a `Simulation` goes: `compile_simulation` gives what runs it, rows side by side in NumPy.

    >>> from gaitdisc.simulation.parts import Term
    >>> def falling(t, x, u, values, ports):
    ...     return -values[:, :1] + ports
    >>> ball = python_simulation("ball", falling, [State("v")], parameters=[Parameter("g", 9.81)], ports=[Port("drag")])
    >>> ball.with_effect(Term("drag", "port", "viscous_damping", "-0.4*v")).effects[0].place
    'drag'
    """

    # an object that computes may have no hash; takes t (row,), x (row, state), u (row, input), values (row, parameter),
    # ports (row, port) and gives the derivatives (row, state). Parameters that are added later follow the model's own
    rates: RightHandSide = field(hash=False)
    parts: Simulation
    replaced: Lines = ()  # inputs that are replaced by an expression of the measured ones
    # how the function is called and why so, for a person; nothing where there is nothing to say
    manner: str = field(default="", compare=False)

    def __getattr__(self, name: str) -> Any:
        """What a `Simulation` has: a part of it, or what gives another of this function with other parts."""
        if name.startswith("__"):  # copy and pickle look these up before there are parts
            raise AttributeError(name)
        attribute = getattr(self.parts, name)
        if not name.startswith(("with", "observing")):
            return attribute
        return lambda *arguments, **named: replace(self, parts=attribute(*arguments, **named))

    @cached_property
    def feeds(self) -> Simulation:
        """What the function is fed with, as observations: ports, what is added to each equation, inputs, the time."""
        sums = {port.name: port.name for port in self.ports}
        for state in self.states:
            terms = [f"({e.term})" for e in self.effects if (e.kind, e.place) == ("equation", state.name)]
            sums[f"d/dt {state.name}"] = " + ".join(terms) or "0"
        replaced = dict(self.replaced)
        sums |= {f"input {signal.name}": replaced.get(signal.name, signal.name) for signal in self.inputs}
        return replace(self.parts, observations=(*sums.items(), ("time", "t")), sensors=())

    def with_input(self, name: str, expression: str) -> PythonSimulation:
        """Simulation in which an input is replaced by an expression of itself."""
        seen = self.parts.with_observation("replaced", dict(self.replaced).get(name, name)).with_input(name, expression)
        replaced = dict(self.replaced) | {name: dict(seen.observations)["replaced"]}
        rest = tuple(line for line in seen.observations if line[0] != "replaced")
        parts = replace(seen, observations=rest, equations=self.equations)
        return replace(self, parts=parts, replaced=tuple(replaced.items()))


def python_simulation(
    title: str,
    rates: RightHandSide,
    states: Sequence[State],
    inputs: Sequence[Input] = (),
    parameters: Sequence[Parameter] = (),
    ports: Sequence[Port] = (),
    observations: Mapping[str, str] | None = None,
) -> PythonSimulation:
    """Simulation of a Python function, with the expression of each measured column; each state by default."""
    equations, seen = any_equations(states, (*inputs, *parameters, *ports)), tuple((observations or {}).items())
    parts = Simulation(title, tuple(states), tuple(inputs), tuple(parameters), tuple(ports), (), equations, seen)
    return PythonSimulation(rates, parts)


def any_equations(states: Sequence[State], parts: Sequence[Input | Parameter | Port]) -> Lines:
    """Lines that stand where another program has the equations: each may depend on every part."""
    named = " + ".join(part.name for part in parts) or "0"
    return tuple((state.name, named) for state in states)


def call(simulation: PythonSimulation, x: Values, fed: Values, values: Values) -> Values:
    """Derivatives by the function, with what was added to the equations.

    fed (row, feed): ports, sums of the equations' effects, inputs, time: the observations of `PythonSimulation.feeds`
    """
    ports, states = len(simulation.ports), len(simulation.states)
    rates = np.asarray(simulation.rates(fed[:, -1], x, fed[:, ports + states : -1], values, fed[:, :ports]))
    if rates.shape != x.shape or rates.dtype.kind not in "fiu":
        raise SimulationError(
            f"the right-hand side of {simulation.title!r} must return one number per row and state, shape {x.shape}",
            f"it returned {rates.dtype} of shape {rates.shape}",
            "Return an array (row, state), for example np.column_stack of the derivatives.",
        )
    return rates + fed[:, ports : ports + states]
