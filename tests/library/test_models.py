"""A model as a script names it."""

import math

import pytest

from gaitdisc.library.models import model_of
from gaitdisc.simulation.python_simulation import PythonSimulation
from gaitdisc.simulation.refusal import SimulationError
from gaitdisc.simulation.simulation_file import bundled
from gaitdisc.simulation.writing import write_simulation


def test_a_file_an_object_and_a_function_are_models(tmp_path):
    pendulum = bundled("pendulum")
    file = write_simulation(pendulum, tmp_path / "pendulum.toml")
    assert model_of(file) == model_of(str(file)) == model_of(pendulum) == pendulum
    assert model_of(lambda x: -x).equations == (("x", "-x"),)
    model = model_of(lambda x: math.erf(x))  # noqa: PLW0108 its argument is the state
    assert isinstance(model, PythonSimulation) and model_of(model) is model


def test_anything_else_is_refused():
    with pytest.raises(SimulationError, match="Python function; found"):
        model_of(3)  # pyright: ignore[reportArgumentType]
