"""A function as right-hand side gives the same as the file of the same equations."""

from dataclasses import dataclass

import numpy as np
import pytest

from gaitdisc.simulation.parts import Input, Parameter, Port, Sensor, State, Term
from gaitdisc.simulation.python_simulation import python_simulation
from gaitdisc.simulation.refusal import SimulationError
from gaitdisc.simulation.running import compile_simulation


def _ball():
    def falling(t, x, u, values, ports):
        return -values[:, :1] + ports + u

    return python_simulation(
        "ball", falling, [State("v")], [Input("wind")], [Parameter("g", 9.81)], [Port("drag")], [("speed", "abs(v)")]
    )


def test_its_parts_are_those_of_a_simulation():
    ball = _ball()
    assert ball.title == "ball" and ball.signals == ("v", "wind") and ball.definitions == () and ball.source is None
    assert ball.with_values({"g": 1.6}).values() == {"g": 1.6}
    assert ball.with_parameter(Parameter("c", 2.0)).parameters[1].name == "c"
    assert ball.with_observation("v", "v").observing(["v"]).observations == (("v", "v"),)
    assert [port.name for port in ball.ports] == ["drag"]
    assert dict(ball.equations)["v"] == "wind + g + drag"


def test_inputs_are_replaced_one_after_the_other():
    ball = _ball().with_input("wind", "2*wind").with_input("wind", "delay(wind, 0.1)")
    assert ball.replaced == (("wind", "2*delay(wind, 0.1)"),)
    assert ball.observations == (("speed", "abs(v)"),)


def test_ports_and_equations_take_effects():
    ball = _ball().with_effect(Term("drag", "port", "a", "-0.5*v")).with_effect(Term("v", "equation", "b", "3"))
    rates = compile_simulation(ball).rates(np.zeros(2), np.array([[2.0], [4.0]]), np.array([[0.0], [1.0]]))
    np.testing.assert_allclose(rates[:, 0], [-9.81 - 1 + 3, -9.81 - 2 + 1 + 3])
    assert compile_simulation(ball.without_effects()).rates(0.0, np.zeros((1, 1)), np.zeros((1, 1)))[0, 0] == -9.81


@dataclass
class Balloon:
    """A callable object without its own hash, and without an answer to ==."""

    lift: np.ndarray

    def __call__(self, t, x, u, values, ports):
        return self.lift - x


def test_an_object_that_computes_needs_no_hash():
    model = python_simulation("balloon", Balloon(np.array([3.0])), [State("v")])
    changed = model.with_starts({"v": 1.0})
    assert changed.states[0].initial == 1.0
    assert compile_simulation(changed).rates(0.0, np.ones((2, 1)), np.zeros((2, 0))).tolist() == [[2.0], [2.0]]


@pytest.mark.parametrize(
    ("given", "found"),
    [
        (lambda t, x, u, p, ports: x.T, r"float64 of shape \(1, 2\)"),
        (lambda t, x, u, p, ports: None, r"object of shape \(\)"),
        (lambda t, x, u, p, ports: x[:, 0], r"float64 of shape \(2,\)"),
    ],
)
def test_a_function_gives_a_derivative_for_each_row_and_state(given, found):
    model = python_simulation("falling", given, [State("v")])
    with pytest.raises(SimulationError, match=rf"'falling'.*\(2, 1\).*it returned {found}"):
        compile_simulation(model).rates(0.0, np.ones((2, 1)), np.zeros((2, 0)))


def test_how_a_channel_was_recorded_is_kept():
    ball = _ball().with_sensor(Sensor("speed", "m/s", 0.1, 8.0))
    assert ball.sensors == (Sensor("speed", "m/s", 0.1, 8.0),) and ball.sensor("speed").sd == 0.1
    assert ball.feeds.sensors == ()
    assert ball.with_observation("v", "v").observing(["v"]).sensors == ()
