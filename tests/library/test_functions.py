"""A plain Python function as a simulation."""

import functools
import math
import re

import numpy as np
import pandas as pd
import pytest
from texts import says

from gaitdisc.discovery import search
from gaitdisc.errors import SimulationError
from gaitdisc.library.discovering import discover
from gaitdisc.library.simulating import simulate
from gaitdisc.simulation.functions import simulation_from_function
from gaitdisc.simulation.python_simulation import PythonSimulation
from gaitdisc.simulation.running import compile_simulation
from gaitdisc.simulation.simulation import Simulation


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
        (lambda *x: x, r"name each of its states.*'\*x'"),
        (lambda x, a="two": -x, "a number or a dict of numbers;.*a='two'"),
        (lambda x: x + x.missing, "a derivative for each state.*raised AttributeError.*Call the function yourself"),
        (lambda x: (x, x), "one for each derivative; .*returns: 2; arguments without a default: 1"),
        (lambda x, *, push=0.0: -x, "a port must be used in an equation"),
    ],
)
def test_what_is_no_such_function_is_refused_in_words(function, words):
    with pytest.raises(SimulationError, match=words):
        simulation_from_function(function)


TIME = np.arange(3000) / 100
DRIVEN = {"torque": np.sin(2 * TIME)}
NUMBERS = {"length": 0.8, "friction": 0.4}


def scalars(angle, rate, torque, length=0.8, friction=0.4):
    return [rate, torque - 9.81 / length * math.sin(angle) - friction * math.tanh(rate)]


def vectors(t, x, u, p):
    return np.array([x[1], u[0] - 9.81 / p["length"] * np.sin(x[0]) - p["friction"] * np.tanh(x[1])])


def filling(t, x, u, p):
    change = np.zeros_like(x)
    change[0], change[1] = x[1], u[0] - 9.81 / p["length"] * math.sin(x[0]) - p["friction"] * math.tanh(x[1])
    return change


def dictionary(angle, rate, torque, p=NUMBERS):
    return rate, torque - 9.81 / p["length"] * math.sin(angle) - p["friction"] * math.tanh(rate)


def branches(angle, rate, torque, length=0.8, friction=0.4):
    size = friction * math.tanh(abs(rate))
    if rate > 0:
        return [rate, torque - 9.81 / length * math.sin(angle) - size]
    return [rate, torque - 9.81 / length * math.sin(angle) + size]


def guarded(angle, rate, torque, length=0.8, friction=0.4):
    """No division by zero at rest."""
    toward = rate / abs(rate) if rate != 0 else 0.0
    return [rate, torque - 9.81 / length * math.sin(angle) - friction * toward * math.tanh(abs(rate))]


def one_at_a_time(angle, rate, torque, length=0.8, friction=0.4):
    slowed = math.erf(rate) * 0 + math.tanh(rate)  # what no expression has
    return [rate, torque - 9.81 / length * math.sin(angle) - friction * slowed]


def many_at_once(angle, rate, torque, length=0.8, friction=0.4):
    rest = 0 * (rate % 1.0)  # what no expression has
    return rate, torque + rest - 9.81 / length * np.sin(angle) - friction * np.tanh(rate)


def counted(function):
    """The function, and a list that grows by one with each call of it."""
    calls = []

    @functools.wraps(function)
    def instead(*given, **named):
        calls.append(1)
        return function(*given, **named)

    return instead, calls


def as_vectors(function):
    return simulation_from_function(function, states=["angle", "rate"], inputs=["torque"], parameters=NUMBERS)


FORMS = {  # how it is written, how it becomes a simulation, of which kind
    "numbers, math, a list": (scalars, simulation_from_function, Simulation),
    "vectors and a dict, NumPy": (vectors, as_vectors, Simulation),
    "an array that is filled": (filling, as_vectors, Simulation),
    "a dict of parameters": (dictionary, simulation_from_function, Simulation),
    "a guard against zero": (guarded, simulation_from_function, Simulation),
    "if and else": (branches, simulation_from_function, Simulation),
    "what no expression has, of arrays": (many_at_once, simulation_from_function, PythonSimulation),
    "what no expression has, of numbers": (one_at_a_time, simulation_from_function, PythonSimulation),
}


@pytest.mark.parametrize("form", FORMS)
def test_however_it_is_written_it_runs_alike(form):
    function, made, kind = FORMS[form]
    model = made(function)
    assert type(model) is kind and model.values() == NUMBERS
    few = slice(0, 200)
    driven = {"torque": DRIVEN["torque"][few]}
    run, wanted = (simulate(each, TIME[few], driven, start=[1.0, 0.0]) for each in (model, pendulum_in_equations()))
    np.testing.assert_allclose(run.values, wanted.values, rtol=0, atol=1e-12)


def pendulum_in_equations():
    model = simulation_from_function(scalars)
    assert isinstance(model, Simulation)
    rate = "torque - 9.81/length*sin(angle) - friction*tanh(rate)"
    assert model.equations == (("angle", "rate"), ("rate", rate))
    return model


@pytest.mark.parametrize("form", [form for form, (_, _, kind) in FORMS.items() if kind is Simulation])
def test_a_function_with_equations_is_not_called_to_run_it(form):
    function, made, _ = FORMS[form]
    watched, calls = counted(function)
    model = made(watched)
    called = len(calls)
    assert 0 < called < 100  # to write it down, and to compare both at a few points
    simulate(model, TIME, DRIVEN, start=[1.0, 0.0])
    assert len(calls) == called


def test_a_discovery_calls_a_function_to_write_it_down_and_tells_how_long_it_will_take(monkeypatch):
    def cooling(temperature, rate=0.5):
        return [-rate * temperature if temperature > -100 else 0.0]

    monkeypatch.setattr(search, "EVERY", 0.0)
    time, said = np.arange(90) / 10, []
    runs = [(2 - k) * np.exp(-0.7 * time) + 0.002 * np.cos(7 * time + k) for k in range(2)]
    frames = [pd.DataFrame({"time": time, "temperature": run, "trial": k}) for k, run in enumerate(runs)]
    watched, calls = counted(cooling)
    found, augmented = discover(watched, pd.concat(frames), progress=said.append)
    assert 0 < len(calls) < len(time)
    assert isinstance(augmented, Simulation) and found.verdict == "wrong_parameter"
    assert any(re.fullmatch(r"1 of \d+ .*\d+ s remain.*", line) for line in said)


def test_how_a_function_without_equations_is_called_is_said():
    arrays, points = simulation_from_function(many_at_once), simulation_from_function(one_at_a_time)
    assert isinstance(arrays, PythonSimulation) and isinstance(points, PythonSimulation)
    assert says(arrays.manner, "many_at_once", "because its equations", "not")
    assert says(points.manner, "one_at_a_time", "called one point")
    assert says(points.manner, "converts a number")


def test_a_function_that_mixes_up_points_is_called_point_by_point():
    model = simulation_from_function(
        lambda x, v: (v, -x / np.linalg.norm([x, v, 1e-9]))
    )  # of arrays: of all points together
    x = np.array([[0.3, 0.4], [3.0, 4.0]])
    rates = compile_simulation(model).rates(np.zeros(2), x, np.empty((2, 0)))
    np.testing.assert_allclose(rates, [[0.4, -0.6], [4.0, -0.6]], rtol=1e-9)


def test_what_math_refuses_is_a_run_that_ends_and_no_error():
    model = simulation_from_function(lambda x: [math.sqrt(x) + 0 * math.erf(x)])
    rates = compile_simulation(model).rates(np.zeros(2), np.array([[4.0], [-1.0]]), np.empty((2, 0)))
    np.testing.assert_array_equal(rates, [[2.0], [np.nan]])


def test_vectors_and_units_need_the_arguments_that_they_are_given_to():
    with pytest.raises(SimulationError, match=r"vectors takes \(t"):
        simulation_from_function(vectors, states=["angle", "rate"], inputs=["torque"])
    with pytest.raises(SimulationError, match=r"returns: 2; states: 3"):
        simulation_from_function(lambda t, x: x[:2], states=["a", "b", "c"])
    with pytest.raises(SimulationError, match=r"'angel'.*rate, torque, length"):
        simulation_from_function(pendulum, {"angel": "rad"})


def ball(t, y):
    return [y[1], -9.81]


def turned(y, t):
    return [y[1], -9.81]


def test_a_solver_s_function_without_names_of_its_states_says_how_to_name_them():
    with pytest.raises(SimulationError, match=r"'y'.*states, name them.*states="):
        simulate(ball, np.arange(5.0), start=[1.0, 0.0])
    with pytest.raises(SimulationError, match=r"the first argument.*states="):
        simulation_from_function(turned)
    with pytest.raises(SimulationError, match="Put the time first"):
        simulation_from_function(turned, states=["height", "speed"])
    assert simulation_from_function(ball, states=["height", "speed"]).equations[0] == ("height", "speed")


@pytest.mark.parametrize("returned", [None, {"x": 1.0}, "a", ()], ids=repr)
def test_a_function_that_returns_no_numbers_is_refused_with_what_it_returned(returned):
    with pytest.raises(SimulationError, match=re.escape(f"returns {returned!r}.")):
        simulation_from_function(lambda x: returned)


def test_a_function_with_noise_in_it_is_refused():
    rng = np.random.default_rng(0)
    with pytest.raises(SimulationError, match="Noise belongs to"):
        simulation_from_function(lambda x: -x + rng.normal())


def test_one_state_and_one_input_may_be_named_by_a_word():
    model = simulation_from_function(lambda t, x, u: [u[0] - x[0]], states="level", inputs="pump")
    assert model.equations == (("level", "pump - level"),)
