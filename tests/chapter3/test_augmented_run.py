import numpy as np
import pytest
from chapter3.augmented_run import on_states, with_learned_rates
from chapter3.burgers import BurgersRates
from chapter3.record import KnownRates
from chapter3.sindy import Sindy, library

from gaitdisc.simulation.parts import State
from gaitdisc.simulation.simulation import Simulation

TIME = np.linspace(0, 2, 201)


def only(power, weight):
    coefficients = np.zeros((4, 1))
    coefficients[power] = weight
    return Sindy(("x",), ("x",), library(1, 3), coefficients, 0.0)


def test_the_true_term_gives_the_true_run(van_der_pol):
    powers = library(2, 3)
    coefficients = np.where((powers == [3, 0]).all(axis=1)[:, None], [0.0, -0.01], 0.0)
    learned = Sindy(("x", "y"), ("x", "y"), powers, coefficients, 0.0)
    found = with_learned_rates(van_der_pol.known, learned, van_der_pol.start, np.linspace(0, 10, 1001))
    wanted = van_der_pol.true.run(van_der_pol.start[None], 0.01, 1000)[0]
    assert np.abs(found.values - wanted).max() < 1e-6


def test_what_diverges_says_when():
    still = KnownRates(Simulation("still", (State("x"),), equations=(("x", "0*x"),)))
    found = with_learned_rates(still, only(2, 1.0), np.ones(1), TIME)  # 1 / (1 - t)
    assert found.diverged_s == pytest.approx(1.0, abs=0.02)
    assert np.isnan(found.values[-1]).all()


def test_rates_without_a_simulation_file_run_in_python():
    class Decay(BurgersRates):
        def __call__(self, x):
            return 0.0 * x

    found = with_learned_rates(Decay(), only(1, -1.0), np.ones(1), TIME)
    assert found.values[-1, 0] == pytest.approx(np.exp(-2.0), abs=1e-9)


def test_a_residual_that_is_summed_from_zero_without_a_constant_stays_zero(van_der_pol):
    learned = Sindy(("x", "y"), ("x", "y"), library(2, 1), np.array([[0, 0], [0.5, 0], [0, 0.5]]), 0.0)
    known = van_der_pol.known.run(van_der_pol.start[None], 0.01, 200)[0]
    assert np.array_equal(on_states(van_der_pol, learned, van_der_pol.start, TIME, summed=True).values, known)
    assert np.allclose(on_states(van_der_pol, learned, van_der_pol.start, TIME).values, 1.5 * known)
