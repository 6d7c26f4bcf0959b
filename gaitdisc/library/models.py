"""A model as a script names it: a simulation file, a name of a bundled one, an object, or a Python function."""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path
from typing import Any, cast

from gaitdisc.library.functions import simulation_from_function
from gaitdisc.simulation.python_simulation import PythonSimulation
from gaitdisc.simulation.refusal import SimulationError
from gaitdisc.simulation.simulation import Simulation
from gaitdisc.simulation.simulation_file import read_simulation

ModelLike = Path | str | Simulation | PythonSimulation | Callable[..., Any]


def model_of(model: ModelLike) -> Simulation:
    """Simulation of what a script names.

    model: a simulation file, an object, or a Python function as `simulation_from_function` takes it
    raises SimulationError if it is none of these, or the file or function does not hold together
    """
    if isinstance(model, Path | str):
        return read_simulation(model)
    if isinstance(model, Simulation):
        return model
    if isinstance(model, PythonSimulation):
        return cast("Simulation", model)  # it goes wherever a `Simulation` goes
    if callable(model):
        return cast("Simulation", simulation_from_function(model))
    raise SimulationError(
        "a model is a simulation file, a Simulation or a Python function",
        f"found {type(model).__name__}",
        "Give the path of a .toml file, or a function that returns the derivative of each state.",
    )
