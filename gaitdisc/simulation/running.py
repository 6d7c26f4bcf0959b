"""A simulation made ready to run, whether a file holds its equations or a Python object its right-hand side."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, replace
from functools import lru_cache
from types import FunctionType
from typing import Any

import numpy as np
from numpy.typing import NDArray

from gaitdisc.recording.arrays import read_only
from gaitdisc.simulation.compiled_simulation import Compiled
from gaitdisc.simulation.expression import Number, Operation, Tree, parsed
from gaitdisc.simulation.program import compiled_program
from gaitdisc.simulation.python_simulation import PythonSimulation, called
from gaitdisc.simulation.refusal import SimulationError
from gaitdisc.simulation.simulation import Simulation


@lru_cache(maxsize=64)
def compile_simulation(simulation: Simulation | PythonSimulation) -> Compiled:
    """Simulation made ready to run; the same one again costs nothing.

    simulation: with its effects, which are part of the right-hand side

    >>> from gaitdisc.simulation.parts import State
    >>> compile_simulation(Simulation("decay", (State("x"),), equations=(("x", "-x"),))).states
    ('x',)
    """
    if isinstance(simulation, PythonSimulation):
        parts = simulation.parts
        own, feeds = (compile_simulation(replace(one, model="")) for one in (parts, simulation.feeds))
        return PythonCompiled(
            **{**vars(own), "simulation": parts, "right_hand_side": feeds.observation}, model=simulation
        )
    if simulation.model:
        raise SimulationError(
            "a simulation must have its own equations to be run",
            f"the equations of {simulation.title!r} are in {simulation.model}",
            "Give its path to gaitdisc discover, which uses the engine.",
        )
    states = tuple(state.name for state in simulation.states)
    inputs = tuple(each.name for each in simulation.inputs)
    parameters = tuple(parameter.name for parameter in simulation.parameters)
    defaults = read_only([parameter.value for parameter in simulation.parameters])
    leaves = ("t", *states, *inputs, *parameters)
    defined = simulation_scope(simulation)
    equations = dict(simulation.equations)
    wanted = [_with_effects(parsed(equations[name]), simulation, "equation", name) for name in states]
    seen = [parsed(text) for _, text in simulation.observations]
    observed = tuple(name for name, _ in simulation.observations)
    return Compiled(
        simulation,
        states,
        inputs,
        parameters=parameters,
        observed=observed,
        defaults=defaults,
        right_hand_side=compiled_program(wanted, leaves, parameters, defined),
        observation=compiled_program(seen, leaves, parameters, defined),
    )


def simulation_scope(simulation: Simulation) -> dict[str, Tree]:
    """Ports, as the sum of the effects on them, then definitions."""
    scope = {}
    for port in simulation.ports:
        scope[port.name] = _with_effects(Number(0.0), simulation, "port", port.name)
    return scope | {name: parsed(text) for name, text in simulation.definitions}


def _with_effects(tree: Tree, simulation: Simulation, kind: str, place: str) -> Tree:
    terms = [parsed(each.term) for each in simulation.effects if (each.kind, each.place) == (kind, place)]
    if terms and tree == Number(0.0):
        tree = terms.pop(0)
    for term in terms:
        tree = Operation("+", (tree, term))
    return tree


@dataclass(frozen=True, eq=False)
class PythonCompiled(Compiled):
    """A `PythonSimulation` that is ready to run; it runs and observes as `Compiled` does.

    simulation, states, inputs, parameters, observed, defaults, right_hand_side, observation: the right-hand side gives
        what the function is fed with
    """

    model: PythonSimulation

    def _integrator(self, values: NDArray[np.float64]) -> tuple[int, Callable[..., None]]:
        """All rows as one block, whose derivatives the function gives."""
        from gaitdisc.simulation import machine

        lanes, n = len(values), len(self.states)
        feeds = np.empty((self.right_hand_side.outputs, lanes))

        def derive(code: NDArray[np.uint64], registers: Any, rates: Any, width: np.uint64) -> None:
            machine.execute(code, registers, feeds.reshape(-1), width)
            x = registers.reshape(-1, lanes)[1 : 1 + n].T
            x = np.where(np.abs(x) < machine.BOUND, x, np.nan)  # nobody's function is made for what has run away
            rates.reshape(n, lanes)[:] = called(self.model, x, feeds.T, values).T

        block = machine.integrate_block.py_func
        return lanes, FunctionType(block.__code__, {**vars(machine), "derive": derive})

    def _rates_of(
        self, x: NDArray[np.float64], given: NDArray[np.float64], values: NDArray[np.float64]
    ) -> NDArray[np.float64]:
        """Derivatives by the function, which is fed with what the right-hand side gives."""
        return called(self.model, x, given, np.broadcast_to(values, (len(x), len(self.parameters))))
