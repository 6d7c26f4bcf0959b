"""Delayed signals along the samples of a trial."""

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from made_simulation import system

from gaitdisc.simulation.delays import delayed_in_series
from gaitdisc.simulation.drive import Drive, Rows
from gaitdisc.simulation.running import compile_simulation


@given(st.floats(0, 3), st.integers(1, 200))
def test_a_line_is_delayed_exactly(seconds, count):
    t = np.arange(count) / 100
    np.testing.assert_allclose(
        delayed_in_series(5 * t, np.array(seconds), 100.0), 5 * np.maximum(t - seconds, 0), atol=1e-12
    )


def test_a_phase_is_delayed_through_the_wrap():
    phase = (np.arange(200) / 100 * 0.9) % 1.0
    late = delayed_in_series(phase, np.array(0.155), 100.0, wraps=True)
    np.testing.assert_allclose(late[16:], ((np.arange(16, 200) / 100 - 0.155) * 0.9) % 1.0, atol=1e-12)


def test_each_sample_may_have_its_own_delay():
    assert delayed_in_series(np.arange(4.0), np.array([0.0, 0.1, 0.0, 0.3]), 10.0).tolist() == [0, 0, 2, 0]


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
