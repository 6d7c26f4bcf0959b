"""Runs against closed forms, against Runge-Kutta in plain NumPy, and against themselves."""

import numpy as np
import pytest
from made_simulation import system
from scipy.special import ellipk

from gaitdisc.errors import ShapeError, SimulationError
from gaitdisc.simulation.compiled_simulation import Drive, Rows
from gaitdisc.simulation.running import compile_simulation


def _free(steps, rate=100.0, trials=1):
    return Drive.of([np.empty((steps + 1, 0))] * trials, rate)


def _rows(starts, values=None, trial=0, begin=0):
    starts = np.atleast_2d(np.asarray(starts, float))
    place = np.zeros(len(starts), int)
    return Rows(place + trial, place + begin, starts, values)


def _runge_kutta(rates, x, steps, h, substeps=5):
    found = [x]
    h = h / substeps
    for step in range(steps * substeps):
        t = step * h
        k1 = rates(t, x)
        k2 = rates(t + h / 2, x + h / 2 * k1)
        k3 = rates(t + h / 2, x + h / 2 * k2)
        k4 = rates(t + h, x + h * k3)
        x = x + h / 6 * (k1 + 2 * k2 + 2 * k3 + k4)
        found.append(x)
    return np.array(found[::substeps])


VAN_DER_POL = system({"x": "y", "y": "mu*(1 - x**2)*y - x"}, parameters={"mu": 1.0})


def test_decay_is_exponential():
    decay = compile_simulation(system({"x": "-r*x"}, parameters={"r": 2.0}))
    states, ok = decay.run(_free(100), _rows([[1.0], [3.0]]), 100)
    assert ok.all()
    np.testing.assert_allclose(states[:, :, 0], np.outer([1, 3], np.exp(-2 * np.arange(101) / 100)), rtol=1e-10)


@pytest.mark.parametrize("count", [1, 63, 64, 65, 130])
def test_rows_agree_with_plain_runge_kutta(count):
    rng = np.random.default_rng(count)
    starts, mu = rng.uniform(-2, 2, (count, 2)), rng.uniform(0.5, 2, count)
    states, ok = compile_simulation(VAN_DER_POL).run(_free(60), _rows(starts, mu[:, None]), 60)
    wanted = _runge_kutta(
        lambda t, x: np.stack([x[1], mu * (1 - x[0] ** 2) * x[1] - x[0]]), starts.T.copy(), 60, 0.01
    ).transpose(2, 0, 1)
    assert ok.all()
    np.testing.assert_allclose(states, wanted, rtol=1e-13, atol=1e-13)


def test_order_four():
    errors = []
    for substeps in (1, 2, 4):
        states, _ = compile_simulation(VAN_DER_POL).run(_free(20, 10.0), _rows([1.0, 0.5]), 20, substeps=substeps)
        fine, _ = compile_simulation(VAN_DER_POL).run(_free(20, 10.0), _rows([1.0, 0.5]), 20, substeps=64)
        errors.append(np.abs(states - fine).max())
    orders = np.log2(np.array(errors[:-1]) / errors[1:])
    assert np.all(orders > 3.6)


def test_period_of_a_pendulum_is_the_elliptic_integral():
    pendulum = compile_simulation(system({"a": "w", "w": "-w2*sin(a)"}, parameters={"w2": 12.0}))
    period = 4 * ellipk(np.sin(1.0) ** 2) / np.sqrt(12.0)  # swings to 2 rad
    states, _ = pendulum.run(_free(100, 100 / period), _rows([2.0, 0.0]), 100)
    np.testing.assert_allclose(states[0, -1], [2.0, 0.0], atol=3e-6)


def test_inputs_are_linear_between_samples():
    ramp = compile_simulation(system({"x": "u"}, ("u",)))
    u = np.array([0.0, 2.0, -1.0, 5.0])[:, None]
    states, _ = ramp.run(Drive.of([u], 10.0), _rows([1.0]), 3)
    np.testing.assert_allclose(states[0, :, 0], [1.0, 1.1, 1.15, 1.35], atol=1e-14)


def test_time_is_the_trials_own():
    clock = compile_simulation(system({"x": "2*t"}))
    drive = Drive.of([np.empty((101, 0))] * 2, 100.0, [0.0, 5.0])
    rows = Rows(np.array([0, 1, 1]), np.array([0, 0, 50]), np.zeros((3, 1)))
    states, _ = clock.run(drive, rows, 50)
    np.testing.assert_allclose(states[:, -1, 0], [0.25, 5.5**2 - 25, 36 - 5.5**2], rtol=1e-12)


def test_phase_wraps_instead_of_sweeping_back():
    stride = system({"x": "step(phase - 0.9)"}, ("phase",))
    phase = (np.arange(101) / 100 * 2.05) % 1.0
    states, _ = compile_simulation(stride).run(Drive.of([phase[:, None]], 100.0), _rows([0.0]), 100, substeps=50)
    assert states[0, -1, 0] == pytest.approx(2 * 0.1 / 2.05, abs=5e-4)  # two strides, a tenth of each


def test_a_row_stops_at_its_trials_end():
    drive = Drive.of([np.zeros((11, 1)), np.zeros((31, 1))], 10.0)
    simple = compile_simulation(system({"x": "1 + u"}, ("u",)))
    states, ok = simple.run(drive, Rows(np.array([0, 1]), np.array([4, 0]), np.zeros((2, 1))), 20)
    assert ok.all()
    assert np.isfinite(states[0, :7]).all() and np.isnan(states[0, 7:]).all()
    assert states[1, -1, 0] == pytest.approx(2.0)


def test_a_row_that_diverges_does_not_touch_the_others():
    growth = compile_simulation(system({"x": "r*x"}, parameters={"r": 1.0}))
    states, ok = growth.run(_free(100), _rows([[1.0], [1.0]], np.array([[1.0], [20.0]])), 100)
    assert ok.tolist() == [True, False]
    assert states[0, -1, 0] == pytest.approx(np.e, rel=1e-9)
    last = int(np.log(1e6) / 20 * 100)
    assert np.isfinite(states[1, : last + 1]).all() and np.isnan(states[1, last + 1 :]).all()


def test_a_root_of_a_negative_number_is_a_divergence():
    root = compile_simulation(system({"x": "-1 + 0*sqrt(x)"}))
    states, ok = root.run(_free(100), _rows([[0.495], [5.0]]), 100)
    assert ok.tolist() == [False, True]
    assert np.isfinite(states[0, :49]).all() and np.isnan(states[0, 50:]).all()


def test_a_start_that_is_no_number_is_a_divergence():
    states, ok = compile_simulation(VAN_DER_POL).run(_free(5), _rows([[np.nan, 0.0], [1.0, 0.0]]), 5)
    assert ok.tolist() == [False, True]
    assert np.isfinite(states[1]).all()


def test_rates_take_parameters_for_each_point(ankle):
    x, u = np.tile([[0.1, 0.2]], (2, 1)), np.zeros((2, 2))
    values = np.array([[0.12, 1.1, 25.0], [0.24, 1.1, 25.0]])
    rates = compile_simulation(ankle).rates(np.zeros(2), x, u, values)
    assert rates[0, 1] == pytest.approx(2 * rates[1, 1])


def test_delayed_decay_by_the_method_of_steps():
    late = compile_simulation(system({"x": "-delay(x, d)"}, parameters={"d": 1.0}))
    states, _ = late.run(_free(300), _rows([1.0]), 300)
    t = np.arange(301) / 100
    wanted = 1 - t + np.where(t > 1, (t - 1) ** 2 / 2, 0) - np.where(t > 2, (t - 2) ** 3 / 6, 0)
    np.testing.assert_allclose(states[0, :, 0], wanted, atol=2e-5)


def test_each_row_has_its_own_delay():
    late = compile_simulation(system({"x": "-delay(x, d)"}, parameters={"d": 1.0}))
    states, _ = late.run(_free(100), _rows([[1.0], [1.0]], np.array([[0.4], [0.8]])), 100)
    np.testing.assert_allclose(states[:, -1, 0], [1 - 1 + 0.6**2 / 2 - 0.2**3 / 6, 1 - 1 + 0.2**2 / 2], atol=1e-5)


def test_an_input_is_delayed_in_the_record_before_the_row():
    late = compile_simulation(system({"x": "delay(u, 0.25)"}, ("u",)))
    u = (np.arange(101) / 100)[:, None]
    drive = Drive.of([u], 100.0)
    states, _ = late.run(drive, Rows(np.array([0, 0]), np.array([0, 50]), np.zeros((2, 1))), 50)
    np.testing.assert_allclose(states[:, -1, 0], [0.25**2 / 2, (0.75**2 - 0.25**2) / 2], rtol=1e-6)


def test_a_state_is_delayed_into_the_measured_past():
    late = compile_simulation(system({"x": "delay(x, 0.2)"}))
    past = (np.arange(101) / 100)[None, :, None]
    drive = _free(100)
    rows = _rows([0.5], begin=50)
    measured, _ = late.run(drive, rows, 20, past=past)
    held, _ = late.run(drive, rows, 20)
    unknown, _ = late.run(drive, rows, 20, past=np.full((1, 101, 1), np.nan))
    assert measured[0, -1, 0] - 0.5 == pytest.approx((0.5**2 - 0.3**2) / 2, rel=1e-9)
    assert held[0, -1, 0] - 0.5 == pytest.approx(0.1, rel=1e-12)
    np.testing.assert_array_equal(held, unknown)


def test_a_state_beyond_the_measured_past_is_held_at_its_start():
    """A lag that an explanation brings along is a state of its own, which nobody measured."""
    late = compile_simulation(system({"x": "delay(y, 0.2)", "y": "1"}, observations={"z": "delay(y, 0.1)"}))
    drive, rows, past = _free(100), _rows([[0.5, 0.0]], begin=50), np.full((1, 101, 1), 7.0)
    run = {name: late.run(drive, rows, 20, past=one)[0] for name, one in (("narrow", past), ("none", None))}
    np.testing.assert_array_equal(run["narrow"], run["none"])
    seen = late.observe(drive, rows, run["none"], past)[0, :, 0]
    np.testing.assert_allclose(seen, np.maximum(np.arange(21) / 100 - 0.1, 0.0), atol=1e-12)


def test_observations_and_their_delays():
    seen = compile_simulation(system({"x": "1 + 0*u"}, ("u",), {"d": 0.1}, {"y": "2*x + u", "z": "delay(x, d)"}))
    drive = Drive.of([np.full((51, 1), 3.0)], 100.0)
    rows = _rows([[0.0], [1.0]], np.array([[0.1], [0.055]]))
    states, _ = seen.run(drive, rows, 50)
    observed = seen.observe(drive, rows, states)
    t = np.arange(51) / 100
    np.testing.assert_allclose(observed[:, :, 0], [2 * t + 3, 2 * (t + 1) + 3], rtol=1e-12)
    np.testing.assert_allclose(observed[0, :, 1], np.maximum(t - 0.1, 0), atol=1e-12)
    np.testing.assert_allclose(observed[1, :, 1], 1 + np.maximum(t - 0.055, 0), atol=1e-12)


def test_a_late_input_of_a_row_comes_from_before_its_start():
    seen = compile_simulation(system({"x": "0*u"}, ("u",), observations={"z": "delay(u, 0.1)"}))
    drive, rows = Drive.of([np.arange(101.0)[:, None] / 100], 100.0), _rows([[0.0]], begin=50)
    states, _ = seen.run(drive, rows, 20)
    np.testing.assert_allclose(seen.observe(drive, rows, states)[0, :, 0], 0.4 + np.arange(21) / 100, atol=1e-12)


def test_a_delay_without_a_history_is_refused():
    late = compile_simulation(system({"x": "-delay(x, 1)"}))
    with pytest.raises(SimulationError, match="signals must be given"):
        late.rates(np.zeros(1), np.ones((1, 1)), np.empty((1, 0)))
    assert late.rates(np.zeros(1), np.ones((1, 1)), np.empty((1, 0)), late=np.array([[4.0]]))[0, 0] == -4.0


@pytest.mark.parametrize(
    ("rows", "words"),
    [
        (_rows([[1.0, 2.0, 3.0]]), r"starts \(1, 3\)"),
        (_rows([[1.0, 2.0]], np.ones((2, 1))), r"values \(2, 1\)"),
        (_rows([[1.0, 2.0]], trial=1), "1 to 1"),
        (_rows([[1.0, 2.0]], begin=99), "first samples 99"),
    ],
)
def test_rows_that_do_not_fit_are_refused(rows, words):
    with pytest.raises(ShapeError, match=words):
        compile_simulation(VAN_DER_POL).run(_free(10), rows, 5)
