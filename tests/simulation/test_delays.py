"""Delays: signals along the samples of a trial; those that have no meaning are refused with seconds and place."""

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from made_simulation import system

from gaitdisc.errors import SchemaError, SimulationError
from gaitdisc.simulation.compiled_simulation import Drive, Rows
from gaitdisc.simulation.evaluating import delay_series, refuse_delays
from gaitdisc.simulation.parts import Input, Parameter, State
from gaitdisc.simulation.python_simulation import python_simulation
from gaitdisc.simulation.running import compile_simulation
from gaitdisc.simulation.simulation_file import parse_simulation


@given(st.floats(0, 3), st.integers(1, 200))
def test_a_line_is_delayed_exactly(seconds, count):
    t = np.arange(count) / 100
    np.testing.assert_allclose(
        delay_series(5 * t, np.array(seconds), 100.0), 5 * np.maximum(t - seconds, 0), atol=1e-12
    )


def test_a_phase_is_delayed_through_the_wrap():
    phase = (np.arange(200) / 100 * 0.9) % 1.0
    late = delay_series(phase, np.array(0.155), 100.0, wraps=True)
    np.testing.assert_allclose(late[16:], ((np.arange(16, 200) / 100 - 0.155) * 0.9) % 1.0, atol=1e-12)


def test_each_sample_may_have_its_own_delay():
    assert delay_series(np.arange(4.0), np.array([0.0, 0.1, 0.0, 0.3]), 10.0).tolist() == [0, 0, 2, 0]


def test_an_observed_state_is_delayed_to_the_third_order():
    compiled = compile_simulation(system({"x": "v", "v": "-x"}, observations={"y": "delay(x, 0.033)"}))
    drive, rows = Drive.of([np.empty((301, 0))], 50.0), Rows(np.array([0]), np.array([0]), np.array([[1.0, 0.0]]))
    states, _ = compiled.run(drive, rows, 300)
    observed = compiled.observe(drive, rows, states)[0, :, 0]
    np.testing.assert_allclose(observed[2:], np.cos(np.arange(2, 301) / 50 - 0.033), atol=1e-8)


@pytest.mark.parametrize("begin", [0, 40])
def test_an_observed_state_is_delayed_into_the_measured_past(begin):
    compiled = compile_simulation(system({"x": "1"}, observations={"y": "delay(x, 0.1)"}))
    t = np.arange(101) / 100
    drive = Drive.of([np.empty((101, 0))], 100.0)
    rows = Rows(np.array([0]), np.array([begin]), np.array([[t[begin]]]))
    states, _ = compiled.run(drive, rows, 30)
    observed = compiled.observe(drive, rows, states, past=t[None, :, None])[0, :, 0]
    np.testing.assert_allclose(observed, np.maximum(t[begin : begin + 31] - 0.1, 0.0), atol=1e-12)


TEXT = """[states.x]
[inputs.u]
[parameters.late]
value = {late}
[equations]
x = "u - delay({what})"
"""


def late(what, value=0.2):
    return TEXT.format(what=what, late=value)


@pytest.mark.parametrize(
    ("text", "words"),
    [
        (
            late("x, -1"),
            r"line 6, \[equations\] x: the delay of a state must not be negative.*; 'delay\(x, -1\)' is -1",
        ),
        (late("x, -late"), r"'delay\(x, -late\)' is -0.2 s \(-late\). Write the delay without the minus sign"),
        (late("x, late", -0.3), r"'delay\(x, late\)' is -0.3 s \(late\)"),
        (
            late("x, 1e9"),
            r"must be shorter than a day \(86400 s\); 'delay\(x, 1000000000.*' is 1e\+09 s. Write the delay",
        ),
        (late("x, 0/0"), r"must be a number of seconds; 'delay\(x, 0/0\)' is nan s. Write a number that is not"),
        (late("u, late - 1e308*10"), r"is -inf s \(late - .*Write a number that is not negative"),
        (
            late("x, 1") + '[[effects]]\nequation = "x"\nterm = "delay(x, -2)"\n',
            r"\[effects\] 0: .*'delay\(x, -2\)' is -2",
        ),
        (late("x, 1") + '[observations]\nseen = "delay(x, -3)"\n', r"line 8, \[observations\] seen: .* is -3 s"),
    ],
)
def test_a_file_with_such_a_delay_is_refused_when_it_is_read(text, words):
    with pytest.raises(SchemaError, match=words):
        parse_simulation(text)


@pytest.mark.parametrize("what", ["x, 0", "x, late", "u, -0.05", "u, 0.05", "x, 2*late - 0.1"])
def test_delays_that_have_a_meaning_are_read(what):
    assert "delay" in parse_simulation(late(what)).equations[0][1]


@pytest.mark.parametrize("what", ["x, 1e4", "x, 40*late", "u, -8", "u, 8"])
def test_a_delay_as_long_as_the_shortest_trial_is_refused(what):
    simulation = parse_simulation(late(what))
    refuse_delays(simulation)
    with pytest.raises(SimulationError, match=r"\[equations\].*shorter.*'b'.*8 s"):  # fmt: skip
        refuse_delays(simulation, 8.0, "b")


def test_a_python_object_with_such_a_delay_is_refused_as_well():
    model = python_simulation("f", lambda t, x, u, p, ports: x, [State("x")], [Input("u")], [Parameter("d", 0.5)])
    refuse_delays(model.with_input("u", "delay(u, -d)"), 2.0, "a")
    with pytest.raises(SimulationError, match=r"\[inputs\] u: .*9\*d\)'.*4\.5 s"):
        refuse_delays(model.with_input("u", "delay(u, 9*d)"), 2.0, "a")
    with pytest.raises(SimulationError, match=r"\[observations\] x: .*-1\)'.*-1 s"):
        refuse_delays(model.with_observation("x", "delay(x, -1)"), 2.0, "a")
