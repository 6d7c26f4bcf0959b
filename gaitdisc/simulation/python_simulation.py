"""A simulation whose right-hand side is a Python object: a musculoskeletal model, say."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, field, replace
from functools import cached_property
from pathlib import Path

import numpy as np
from numpy.typing import ArrayLike, NDArray

from gaitdisc.simulation.parts import Input, Parameter, Port, Sensor, State, Term
from gaitdisc.simulation.refusal import SimulationError
from gaitdisc.simulation.simulation import Lines, Simulation

RightHandSide = Callable[..., NDArray[np.float64]]


@dataclass(frozen=True)
class PythonSimulation:
    """States, inputs, parameters and ports like a `Simulation`, and equations that are a function.

    It goes wherever a `Simulation` goes: `compile_simulation` gives what runs it, rows side by side in NumPy.

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
    # tuple of (str, str), inputs that are replaced by an expression of the measured ones
    replaced: Lines = field(default=())
    # how the function is called and why so, for a person; nothing where there is nothing to say
    manner: str = field(default="", compare=False)

    @property
    def title(self) -> str:
        """One line for a person."""
        return self.parts.title

    @property
    def states(self) -> tuple[State, ...]:
        """In the order of the state vector."""
        return self.parts.states

    @property
    def inputs(self) -> tuple[Input, ...]:
        """Measured signals that drive it."""
        return self.parts.inputs

    @property
    def parameters(self) -> tuple[Parameter, ...]:
        """Numbers of the model."""
        return self.parts.parameters

    @property
    def ports(self) -> tuple[Port, ...]:
        """Places where a missing effect may enter."""
        return self.parts.ports

    @property
    def definitions(self) -> Lines:
        """None: they are inside the function."""
        return ()

    @property
    def equations(self) -> Lines:
        """Which names the derivatives may depend on; what they are, the function knows."""
        return self.parts.equations

    @property
    def observations(self) -> Lines:
        """Measured column and expression."""
        return self.parts.observations

    @property
    def sensors(self) -> tuple[Sensor, ...]:
        """How observed channels were recorded."""
        return self.parts.sensors

    def sensor(self, channel: str) -> Sensor:
        """How an observed channel was recorded."""
        return self.parts.sensor(channel)

    def with_sensor(self, sensor: Sensor) -> PythonSimulation:
        """Simulation in which an observed channel was recorded in another way."""
        return replace(self, parts=self.parts.with_sensor(sensor))

    @property
    def driving(self) -> tuple[Input, ...]:
        """The inputs that were measured."""
        return self.parts.driving

    @property
    def effects(self) -> tuple[Term, ...]:
        """What was added, and where."""
        return self.parts.effects

    @property
    def source(self) -> Path | None:
        """None: it was read from no file."""
        return None

    @property
    def inexact(self) -> float:
        """Share of a channel's spread by which runs may err without anything being missing."""
        return self.parts.inexact

    @property
    def signals(self) -> tuple[str, ...]:
        """Names of the states and inputs."""
        return self.parts.signals

    @cached_property
    def feeds(self) -> Simulation:
        """What the function is fed with, as observations: ports, what is added to each equation, inputs."""
        sums = {port.name: port.name for port in self.ports}
        for state in self.states:
            own = [f"({each.term})" for each in self.effects if (each.kind, each.place) == ("equation", state.name)]
            sums[f"d/dt {state.name}"] = " + ".join(own) or "0"
        given = dict(self.replaced)
        sums |= {f"input {each.name}": given.get(each.name, each.name) for each in self.inputs}
        return replace(self.parts, observations=tuple(sums.items()), sensors=())

    def values(self) -> dict[str, float]:
        """Parameters by name."""
        return self.parts.values()

    def with_effect(self, term: Term) -> PythonSimulation:
        """Simulation with one effect more."""
        return replace(self, parts=self.parts.with_effect(term))

    def without_effects(self) -> PythonSimulation:
        """Simulation without anything added."""
        return replace(self, parts=self.parts.without_effects())

    def with_values(self, values: Mapping[str, float]) -> PythonSimulation:
        """Simulation with other values of some parameters."""
        return replace(self, parts=self.parts.with_values(values))

    def with_starts(self, starts: Mapping[str, float]) -> PythonSimulation:
        """Simulation of which some states have another `initial`."""
        return replace(self, parts=self.parts.with_starts(starts))

    def with_parameter(self, parameter: Parameter) -> PythonSimulation:
        """Simulation with a further parameter, for effects to use."""
        return replace(self, parts=self.parts.with_parameter(parameter))

    def with_observation(self, name: str, expression: str) -> PythonSimulation:
        """Simulation with a further observed channel, or another expression for one that it has."""
        return replace(self, parts=self.parts.with_observation(name, expression))

    def observing(self, names: Sequence[str]) -> PythonSimulation:
        """Simulation with some of its observations only."""
        return replace(self, parts=self.parts.observing(names))

    def with_input(self, name: str, expression: str) -> PythonSimulation:
        """Simulation in which an input is replaced by an expression of itself."""
        seen = self.parts.with_observation("replaced", dict(self.replaced).get(name, name)).with_input(name, expression)
        kept = dict(self.replaced) | {name: dict(seen.observations)["replaced"]}
        rest = tuple(line for line in seen.observations if line[0] != "replaced")
        parts = replace(seen, observations=rest, equations=self.equations)
        return replace(self, parts=parts, replaced=tuple(kept.items()))


def python_simulation(
    title: str,
    rates: RightHandSide,
    states: Sequence[State],
    inputs: Sequence[Input] = (),
    parameters: Sequence[Parameter] = (),
    ports: Sequence[Port] = (),
    observations: Sequence[tuple[str, str]] = (),
) -> PythonSimulation:
    """Simulation of a Python function.

    observations sequence of (str, str): measured column and expression; by default each state under its own name
    """
    equations = any_equations(states, (*inputs, *parameters, *ports))
    parts = Simulation(
        title, tuple(states), tuple(inputs), tuple(parameters), tuple(ports), (), equations, tuple(observations)
    )
    return PythonSimulation(rates, parts)


def any_equations(states: Sequence[State], parts: Sequence[Input | Parameter | Port]) -> Lines:
    """Lines that stand where another program has the equations: each may depend on every part."""
    named = " + ".join(part.name for part in parts) or "0"
    return tuple((state.name, named) for state in states)


def called(
    simulation: PythonSimulation,
    t: ArrayLike,
    x: NDArray[np.float64],
    fed: NDArray[np.float64],
    values: NDArray[np.float64],
) -> NDArray[np.float64]:
    """Derivatives by the function, with what was added to the equations.

    t (row,): time [s]
    x (row, state): states
    fed (row, feed): ports, sums of the equations' effects, inputs: the observations of `PythonSimulation.feeds`
    values (row, parameter): parameters
    """
    ports, states = len(simulation.ports), len(simulation.states)
    own = np.asarray(simulation.rates(np.asarray(t, float), x, fed[:, ports + states :], values, fed[:, :ports]))
    if own.shape != x.shape or own.dtype.kind not in "fiu":
        raise SimulationError(
            f"the right-hand side of {simulation.title!r} must return one number per row and state, shape {x.shape}",
            f"it returned {own.dtype} of shape {own.shape}",
            "Return an array (row, state), for example np.column_stack of the derivatives.",
        )
    return own + fed[:, ports : ports + states]
