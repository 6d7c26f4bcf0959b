"""A simulation made ready to run, whether a file holds its equations or a Python object its right-hand side."""

from __future__ import annotations

from dataclasses import replace
from functools import lru_cache

from gaitdisc.recording.arrays import read_only
from gaitdisc.simulation.compiled_simulation import Compiled
from gaitdisc.simulation.expression import Number, Operation, Tree, parsed
from gaitdisc.simulation.program import compiled_program
from gaitdisc.simulation.python_simulation import PythonSimulation
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
    if not isinstance(simulation, Simulation):
        return _of_python(simulation)
    if simulation.model:
        raise SimulationError(
            "a simulation that is run has equations of its own",
            f"those of {simulation.title!r} are in {simulation.model}",
            "Give its path to gaitdisc discover: there the engine computes.",
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
        parameters,
        observed,
        defaults,
        compiled_program(wanted, leaves, parameters, defined),
        compiled_program(seen, leaves, parameters, defined),
    )


def _of_python(model: PythonSimulation) -> Compiled:
    from gaitdisc.simulation.python_running import PythonCompiled

    own, feeds = (compile_simulation(replace(one, model="")) for one in (model.parts, model.feeds))
    return PythonCompiled(
        model.parts,
        own.states,
        own.inputs,
        own.parameters,
        own.observed,
        own.defaults,
        feeds.observation,
        own.observation,
        model,
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
