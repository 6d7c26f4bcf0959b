"""A plain Python function as a simulation."""

import numpy as np
import pytest

from gaitdisc.library.functions import simulation_from_function
from gaitdisc.simulation.refusal import SimulationError
from gaitdisc.simulation.running import compile_simulation


def pendulum(angle, rate, torque, length=0.8, *, hip=0.0):
    return rate, torque + hip - 9.81 / length * np.sin(angle)


def test_arguments_say_what_is_what():
    model = simulation_from_function(pendulum, {"angle": "rad", "torque": "N m"})
    assert [state.name for state in model.states] == ["angle", "rate"]
    assert [(each.name, each.unit) for each in model.inputs] == [("torque", "N m")]
    assert (model.values(), [port.name for port in model.ports]) == ({"length": 0.8}, ["hip"])
    assert model.title == "pendulum"


def test_its_rates_are_those_of_the_function():
    machine = compile_simulation(simulation_from_function(pendulum))
    x, u = np.array([[0.3, 1.0], [-0.2, 2.0]]), np.array([[0.5], [0.0]])
    expected = np.column_stack([x[:, 1], u[:, 0] - 9.81 / 0.8 * np.sin(x[:, 0])])
    np.testing.assert_allclose(machine.rates(np.zeros(2), x, u), expected)
    other = machine.rates(np.zeros(2), x, u, np.array([1.6]))
    np.testing.assert_allclose(other[:, 1], u[:, 0] - 9.81 / 1.6 * np.sin(x[:, 0]))


def test_time_is_an_argument_called_t_and_a_constant_rate_is_spread():
    machine = compile_simulation(simulation_from_function(lambda x, t, a=2.0: a * t))
    np.testing.assert_allclose(machine.rates(np.array([1.0, 3.0]), np.zeros((2, 1)), np.empty((2, 0))), [[2.0], [6.0]])
    still = compile_simulation(simulation_from_function(lambda h, v: (v, -9.81)))
    np.testing.assert_allclose(still.rates(np.zeros(2), np.ones((2, 2)), np.empty((2, 0))), [[1, -9.81]] * 2)


def test_observations_may_be_expressions():
    model = simulation_from_function(lambda x, offset=1.0: -x, observations={"seen": "x + offset"})
    assert model.observations == (("seen", "x + offset"),)


@pytest.mark.parametrize(
    ("function", "words"),
    [
        (lambda *x: x, r"names each of its states.*'\*x'"),
        (lambda x, a="two": -x, "a parameter of the simulation, a number; .*a='two'"),
        (lambda x: -x if x > 0 else x, "takes arrays.*raised ValueError.*np.where in place of if"),
        (lambda x: (x, x), "one for each derivative; .*returns 2 derivatives and has 1 arguments"),
    ],
)
def test_what_is_no_such_function_is_refused_in_words(function, words):
    with pytest.raises(SimulationError, match=words):
        simulation_from_function(function)


def test_a_unit_of_nothing_is_refused():
    with pytest.raises(SimulationError, match=r"none called 'angel'.*Known: angle, rate, torque, length, hip"):
        simulation_from_function(pendulum, {"angel": "rad"})
