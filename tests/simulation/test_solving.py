"""Adaptive and fixed steps agree; an explosion is told."""

import numpy as np
import pytest
from made_simulation import system
from solving import solve

from gaitdisc.errors import SamplingError, SimulationError
from gaitdisc.simulation.compiled_simulation import Drive, Rows
from gaitdisc.simulation.running import compile_simulation

LORENZ = system({"x": "10*(y - x)", "y": "x*(28 - z) - y", "z": "x*y - 8/3*z"})


def test_lorenz_by_both():
    start = {"x": -8.0, "y": 8.0, "z": 27.0}
    exact = solve(LORENZ, np.arange(301) / 100, {}, start)
    fixed, _ = compile_simulation(LORENZ).run(
        Drive.of([np.empty((301, 0))], 100.0),
        Rows(np.array([0]), np.array([0]), np.array([[-8.0, 8.0, 27.0]])), 300, substeps=40,
    )  # fmt: skip
    np.testing.assert_allclose(fixed[0], exact, atol=2e-5)


def test_inputs_by_both(ankle):
    t = np.arange(41) / 100
    tau = np.where((t * 10).astype(int) % 2, 5.0, -3.0)
    phase = (t * 3) % 1
    exact = solve(ankle, t, {"tau": tau, "phase": phase}, {"theta": 0.1, "omega": 0.0}, tolerance=1e-9)
    fixed, _ = compile_simulation(ankle).run(
        Drive.of([np.column_stack([tau, phase])], 100.0), Rows(np.array([0]), np.array([0]), np.array([[0.1, 0.0]])), 40
    )
    np.testing.assert_allclose(fixed[0], exact, atol=1e-7)


def test_an_explosion_with_its_time_and_state_delays_and_times_that_stand_still_are_refused():
    blow = system({"x": "1", "y": "y**2"})
    with pytest.raises(SimulationError, match=r"= 0\.99.*'y'"):
        solve(blow, np.linspace(0, 2, 201), {}, {"x": 0.0, "y": 1.0})
    late = system({"x": "-delay(x, 1)"})
    with pytest.raises(SimulationError, match="without delays"):
        solve(late, [0.0, 1.0], {}, {"x": 1.0})
    with pytest.raises(SamplingError, match="times increase"):
        solve(LORENZ, [0.0, 1.0, 1.0], {}, {"x": 1.0, "y": 1.0, "z": 1.0})
