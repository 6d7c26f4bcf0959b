"""A function as right-hand side gives the same as the file of the same equations."""

from dataclasses import dataclass

import numpy as np
import pytest

from gaitdisc.errors import SimulationError
from gaitdisc.simulation.compiled_simulation import Drive, Rows
from gaitdisc.simulation.evaluating import Points, evaluate
from gaitdisc.simulation.parts import Input, Parameter, Port, Sensor, State, Term
from gaitdisc.simulation.python_simulation import python_simulation
from gaitdisc.simulation.running import PythonCompiled, compile_simulation


def _ball():
    def falling(t, x, u, values, ports):
        return -values[:, :1] + ports + u

    return python_simulation(
        "ball", falling, [State("v")], [Input("wind")], [Parameter("g", 9.81)], [Port("drag")], {"speed": "abs(v)"}
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


def _joint(t, x, u, values, ports):
    theta, omega = x.T
    inertia, b, k = values[:, :3].T
    return np.column_stack([omega, (u[:, 0] + ports[:, 0] - b * omega - k * theta) / inertia])


EFFECTS = {
    "none": lambda s: s,
    "spring": lambda s: s.with_effect(Term("ankle_moment", "port", "a", "-30*max(0, theta - 0.01)")),
    "equation": lambda s: s.with_effect(Term("omega", "equation", "a", "5*sin(9*t) + phase")),
    "feedback": lambda s: s.with_effect(Term("ankle_moment", "port", "a", "-0.5*delay(omega, 0.07)")),
    "late input": lambda s: s.with_input("tau", "1.2*delay(tau, 0.04)"),
    "late phase": lambda s: s.with_effect(Term("ankle_moment", "port", "a", "3*delay(phase, 0.033)")),
    "number": lambda s: s.with_values({"k": 31.0}),
}


@pytest.mark.parametrize("effect", EFFECTS)
@pytest.mark.parametrize("before", [False, True])
def test_a_function_and_a_file_agree(ankle, effect, before):
    python = EFFECTS[effect](
        python_simulation("joint", _joint, ankle.states, ankle.inputs, ankle.parameters, ankle.ports)
    )
    file = EFFECTS[effect](ankle)
    rng = np.random.default_rng(4)
    t = np.arange(61) / 100
    trials = [np.column_stack([np.sin(9 * t + k), (1.7 * t + 0.3 * k) % 1]) for k in range(2)]
    drive = Drive.of([trials[0][:45], trials[1]], 100.0, [0.0, 2.0])
    rows = Rows(np.array([0, 1, 1]), np.array([5, 0, 17]), rng.uniform(-0.1, 0.1, (3, 2)))
    past = rng.uniform(-0.1, 0.1, (2, 61, 2)) if before else None
    one, ok_one = compile_simulation(python).run(drive, rows, 43, past=past)
    other, ok_other = compile_simulation(file).run(drive, rows, 43, past=past)
    assert ok_one.all() and ok_other.all()
    np.testing.assert_allclose(one, other, atol=1e-12)
    seen = [compile_simulation(each).observe(drive, rows, one, past) for each in (python, file)]
    np.testing.assert_allclose(*seen, atol=1e-12)


def test_a_divergence_is_told_by_row(ankle):
    python = python_simulation("joint", _joint, ankle.states, ankle.inputs, ankle.parameters, ankle.ports)
    values = np.array([[0.12, 1.1, 25.0], [0.12, -30.0, 25.0]])
    rows = Rows(np.zeros(2, int), np.zeros(2, int), np.full((2, 2), 0.1), values)
    states, ok = compile_simulation(python).run(Drive.of([np.zeros((61, 2))], 100.0), rows, 60)
    assert ok.tolist() == [True, False]
    assert np.isfinite(states[0]).all() and np.isnan(states[1, -1]).all()


def test_expressions_of_its_names_are_evaluated(ankle):
    python = python_simulation("joint", _joint, ankle.states, ankle.inputs, ankle.parameters, ankle.ports)
    points = Points(np.zeros(2), np.array([[1.0, 2.0], [3.0, 4.0]]), np.zeros((2, 2)))
    assert evaluate(python, "k*theta - omega", points).tolist() == [23.0, 71.0]


def test_effects_act_at_ports_and_in_equations(ankle):
    both = ankle.with_effect(Term("ankle_moment", "port", "a", "-3*theta")).with_effect(
        Term("omega", "equation", "b", "2*spring")
    )
    both = both.with_effect(Term("ankle_moment", "port", "c", "1.5"))
    t, x, u = np.zeros(1), np.array([[0.1, 0.2]]), np.array([[4.0, 0.3]])
    rates = compile_simulation(both).rates(t, x, u)
    moment = 4.0 - 0.3 + 1.5 - 1.1 * 0.2 - 2.5
    np.testing.assert_allclose(rates, [[0.2, moment / 0.12 + 2 * 2.5]], rtol=1e-14)


def test_the_same_simulation_is_compiled_once(ankle):
    assert compile_simulation(ankle) is compile_simulation(ankle.without_effects())


def test_a_python_object_runs_by_its_own_function(ankle):
    made = python_simulation("fall", lambda t, x, u, p: 0 * x, ankle.states, ankle.inputs, ankle.parameters)
    compiled = compile_simulation(made)
    assert isinstance(compiled, PythonCompiled)
    assert compiled.model is made
    assert compiled.states == compile_simulation(ankle).states
