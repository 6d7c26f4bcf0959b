import numpy as np
import pytest
from chapter3.record import KnownRates
from solving import solve

from gaitdisc.simulation.refusal import SimulationError
from gaitdisc.simulation.simulation_file import bundled


def test_fixed_steps_agree_with_an_adaptive_method():
    simulation, time = bundled("van_der_pol"), np.linspace(0, 10, 1001)
    wanted = solve(simulation, time, {}, {"x": 0.1, "y": 5.0})
    assert np.abs(KnownRates(simulation).run(np.array([[0.1, 5.0]]), 0.01, 1000)[0] - wanted).max() < 1e-9


def test_rates_are_those_of_the_equations():
    assert KnownRates(bundled("lorenz"))(np.array([[1.0, 2.0, 3.0]])).round(9).tolist() == [[10.0, 23.0, -6.0]]


def test_inputs_are_refused():
    driven = next(name for name in ("ankle", "swing_leg", "muscle_activation") if bundled(name).inputs)
    with pytest.raises(SimulationError, match="has inputs or delays"):
        KnownRates(bundled(driven))
