"""A function as right-hand side gives the same as the file of the same equations."""

import numpy as np

from gaitdisc.simulation.parts import Input, Parameter, Port, State, Term
from gaitdisc.simulation.python_simulation import python_simulation
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
