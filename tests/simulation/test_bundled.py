"""The simulations that come along do what their equations say."""

import numpy as np
import pytest
from scipy.special import ellipk
from solving import solve

from gaitdisc.errors import ReadError
from gaitdisc.simulation.compiled_simulation import Drive, Rows
from gaitdisc.simulation.running import compile_simulation
from gaitdisc.simulation.simulation_file import bundled, list_bundled


def _run(simulation, steps, rate=100.0, starts=None, inputs=None):
    compiled = compile_simulation(simulation)
    starts = [state.initial for state in simulation.states] if starts is None else starts
    inputs = np.zeros((steps + 1, len(compiled.inputs))) if inputs is None else inputs
    rows = Rows(np.array([0]), np.array([0]), np.array([starts], float))
    states, ok = compiled.run(Drive.of([inputs], rate), rows, steps)
    assert ok.all()
    return states[0]


def test_all_are_there():
    assert set(list_bundled()) == {
        "ankle", "lorenz", "mass_spring_damper", "muscle_activation", "pendulum", "swing_leg", "van_der_pol",
        "van_der_pol_published",
    }  # fmt: skip
    with pytest.raises(ReadError, match="Did you mean 'lorenz'"):
        bundled("lorentz")


@pytest.mark.parametrize("name", list_bundled())
def test_each_runs_and_says_what_it_is(name):
    simulation = bundled(name)
    starts = [0.1 if state.initial is None else state.initial for state in simulation.states]
    assert np.isfinite(_run(simulation, 200, starts=starts)).all()
    assert simulation.title and simulation.layout.startswith("# ")


def test_van_der_pol_comes_to_its_cycle():
    """Period of the cycle at mu = 0.5: 2 pi (1 + mu^2/16 - 5 mu^4/3072), Andersen and Geer 1982, to 1e-4."""
    states = _run(bundled("van_der_pol"), 10_000)[5000:]
    up = np.flatnonzero((states[:-1, 0] < 0) & (states[1:, 0] >= 0))
    crossing = up - states[up, 0] / (states[up + 1, 0] - states[up, 0])
    assert np.diff(crossing).mean() / 100 == pytest.approx(2 * np.pi * (1 + 0.25 / 16 - 5 * 0.0625 / 3072), rel=1e-4)
    assert np.abs(states[:, 0]).max() == pytest.approx(2.0, abs=0.01)


def test_lorenz_has_its_fixed_points():
    fixed = np.sqrt(8 / 3 * 27)
    rates = compile_simulation(bundled("lorenz")).rates(0.0, np.array([[fixed, fixed, 27.0]]), np.empty((1, 0)))
    np.testing.assert_allclose(rates, 0, atol=1e-12)


def test_mass_spring_damper_is_the_damped_cosine():
    t = np.arange(2001) / 100
    rate, frequency = 0.125, np.sqrt(1 - 0.125**2)
    wanted = 0.5 * np.exp(-rate * t) * (np.cos(frequency * t) + rate / frequency * np.sin(frequency * t))
    np.testing.assert_allclose(_run(bundled("mass_spring_damper"), 2000)[:, 0], wanted, atol=1e-9)


def test_pendulum_has_the_period_of_the_elliptic_integral():
    undamped = bundled("pendulum").with_values({"damping": 0.0})
    period = 4 * np.sqrt(0.8 / 9.81) * ellipk(np.sin(0.5) ** 2)
    exact = solve(undamped, [0.0, period], {}, {"theta": 1.0, "omega": 0.0})
    np.testing.assert_allclose(exact[-1], [1.0, 0.0], atol=1e-9)


def test_an_undriven_leg_keeps_its_energy():
    leg = bundled("swing_leg").with_values({"b_hip": 0.0, "b_knee": 0.0})
    hip, knee, hip_rate, knee_rate = _run(leg, 300, starts=[0.9, -0.6, 1.0, -2.0]).T
    a = 0.144 + 7.5 * 0.186**2 + 4.58 * 0.429**2
    d, c = 0.147 + 4.58 * 0.261**2, 4.58 * 0.429 * 0.261
    energy = a * hip_rate**2 / 2 + d * knee_rate**2 / 2 + c * hip_rate * knee_rate * np.cos(hip - knee)
    energy -= (7.5 * 0.186 + 4.58 * 0.429) * 9.81 * np.cos(hip) + 4.58 * 0.261 * 9.81 * np.cos(knee)
    assert np.ptp(energy) < 1e-6
    assert np.ptp(hip_rate) > 1


def test_moments_on_the_leg_do_their_work():
    """At rest in the vertical, moments accelerate the two segments as the mass matrix says."""
    leg = compile_simulation(bundled("swing_leg"))
    rates = leg.rates(0.0, np.zeros((1, 4)), np.array([[5.0, 2.0]]))[0, 2:]
    a = 0.144 + 7.5 * 0.186**2 + 4.58 * 0.429**2
    d, c = 0.147 + 4.58 * 0.261**2, 4.58 * 0.429 * 0.261
    np.testing.assert_allclose(rates, np.linalg.solve([[a, c], [c, d]], [3.0, 2.0]), rtol=1e-12)


def test_ankle_rests_where_moment_and_stiffness_agree():
    inputs = np.column_stack([np.full(301, 4.0), np.zeros(301)])
    assert _run(bundled("ankle"), 300, starts=[0, 0], inputs=inputs)[-1, 0] == pytest.approx(0.2, abs=1e-6)


def test_activation_rises_faster_than_it_falls():
    inputs = np.where(np.arange(201) < 100, 1.0, 0.0)[:, None]
    a = _run(bundled("muscle_activation"), 200, 1000.0, [0.0], inputs)[:, 0]
    rise, fall = np.argmax(a > 0.5 * a[99]), np.argmax(a[100:] < 0.5 * a[99])
    assert 0 < rise < fall
    assert a.min() >= 0 and a.max() <= 1
