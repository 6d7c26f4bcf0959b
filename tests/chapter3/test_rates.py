"""Rates: known, learned, stochastic, of Burgers' equation; a run with a learned term in it."""

import numpy as np
import pytest
from chapter3.augmented_run import learned_rate, learned_term, on_states, with_learned_rates
from chapter3.burgers import (
    LENGTH,
    POINTS,
    BurgersRates,
    burgers,
    fit_local_field,
    local_cell,
    places,
    recorded_field,
    slope_and_bend,
    smoothed_in_space,
)
from chapter3.methods import OF_TIME, MethodSettings, fitted
from chapter3.record import Conditions, KnownRates, StochasticRates, error_samples, noise_cutoff_hz, recorded, smoothed
from chapter3.sindy import Sindy, library
from solving import solve

from gaitdisc.errors import SamplingError, SimulationError, TrainingError
from gaitdisc.simulation.parts import State
from gaitdisc.simulation.simulation import Simulation
from gaitdisc.simulation.simulation_file import bundled

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


def test_another_kind_of_model_is_refused():
    with pytest.raises(TrainingError, match="found function"):
        learned_term(test_another_kind_of_model_is_refused, np.empty(0))


@pytest.mark.parametrize("method", ["sindy", "gp", "gpm", "nn", "dmd", "bopdmd"])
def test_compiled_code_gives_the_numbers_of_the_model(quiet, method):
    samples = error_samples(quiet, "dynamics", of_time=method in OF_TIME)
    settings = MethodSettings(nodes=4, bags=2 if method == "bopdmd" else 0)
    model = fitted(samples, method, settings)
    points = samples.x[::300]
    term = learned_term(model, points[:, 0])
    found = np.empty((len(points), 2))
    for place, point in enumerate(points):
        learned_rate(term.kind, term.tables, place, np.resize(point, 2), found[place])
    assert np.allclose(found, model(points), atol=1e-5 * np.abs(samples.y).max())


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


def test_without_pushes_it_is_the_system_and_with_them_only_the_pushed_state_leaves_it(van_der_pol):
    start = van_der_pol.start[None]
    alone = van_der_pol.true.run(start, 0.01, 50)
    assert np.allclose(StochasticRates(van_der_pol.true, (0.0, 0.0)).run(start, 0.01, 50), alone, rtol=0, atol=1e-9)
    pushed = StochasticRates(van_der_pol.true, (0.0, 0.1), 3).run(start, 0.01, 50)
    assert pushed[0, 1, 0] == alone[0, 1, 0]
    assert pushed[0, 1, 1] != alone[0, 1, 1]


def test_a_seed_gives_the_same_pushes_and_the_rates_are_those_without(van_der_pol):
    start = van_der_pol.start[None]
    one, same, other = (StochasticRates(van_der_pol.true, (0.0, 0.1), seed).run(start, 0.01, 20) for seed in (1, 1, 2))
    assert np.array_equal(one, same)
    assert not np.array_equal(one, other)
    assert np.array_equal(StochasticRates(van_der_pol.true, (0.0, 0.1))(start), van_der_pol.true(start))


T = np.arange(3000) / 100
CLEAN = np.sin(2 * np.pi * 0.5 * T) + 0.2 * np.sin(2 * np.pi * 3 * T)
NOISE = np.random.default_rng(0).standard_normal(3000)


def test_more_noise_lowers_the_cutoff_and_no_signal_is_lost():
    cutoffs = [noise_cutoff_hz(CLEAN + level * NOISE, 100.0) for level in (0.001, 0.05, 3.0)]
    assert cutoffs[0] >= cutoffs[1] >= cutoffs[2]
    assert cutoffs[1] > 3


def test_noise_shrinks_and_signal_stays():
    left = smoothed((CLEAN + 0.05 * NOISE)[:, None], 100.0)[200:-200, 0] - CLEAN[200:-200]
    assert left.std() < 0.03


def test_a_constant_stays_constant():
    assert np.allclose(smoothed(np.full((500, 1), 7.0), 100.0, 4.0), 7.0)


@pytest.fixture(scope="module")
def decaying():
    return recorded(burgers(0.1), Conditions(duration_s=2.0))


def test_the_cubic_is_found_at_every_point_and_nothing_else(decaying):
    learned = fit_local_field(error_samples(decaying, "dynamics"), "sindy", MethodSettings())
    fields = decaying.truth[[0, 150]]
    assert learned.said == "error: -0.1*u**3"
    assert learned(fields) == pytest.approx(-0.1 * fields**3, abs=1e-4)


def test_slope_and_bend_are_read_where_they_stand(decaying):
    samples = error_samples(decaying, "dynamics")
    slope, bend = slope_and_bend(samples.x)
    learned = fit_local_field(samples.with_outputs(2.0 * slope - bend), "sindy", MethodSettings())
    assert learned(samples.x[:3]) == pytest.approx((2.0 * slope - bend)[:3], abs=1e-6)


def test_a_cell_holds_what_was_found_and_both_parts(decaying):
    cell = local_cell(decaying, "sindy")
    assert (cell.method, cell.variant, cell.terms) == ("sindy", "at each point", "error: -0.1*u**3")
    assert np.median(cell.parts["oracle forecast"].accuracy()) > 99


def test_noise_is_taken_out_over_space_as_well_as_over_time():
    made = Conditions(0.01, duration_s=2.0)
    by_time, by_both = recorded(burgers(0.1), made), recorded_field(burgers(0.1), made)
    over_time, over_both = ((each.filtered - each.truth[: each.split]).std() for each in (by_time, by_both))
    assert over_both < 0.7 * over_time


def test_a_small_wave_decays_as_diffusion_says():
    wave = 1e-6 * np.sin(2 * np.pi * places() / LENGTH)
    found = BurgersRates(0.1).run(wave[None], 0.01, 200)[0, -1]
    assert np.allclose(found, wave * np.exp(-0.1 * (2 * np.pi / LENGTH) ** 2 * 2.0), atol=1e-11)


def test_the_sum_is_kept_without_the_hidden_term():
    system = burgers(0.1)
    known, true = (rates.run(system.start[None], 0.01, 100)[0, -1].sum() for rates in (system.known, system.true))
    assert known == pytest.approx(system.start.sum(), rel=1e-10)
    assert true < known


def test_the_first_pulse_of_the_text_cannot_run():
    with pytest.raises(SamplingError, match=r"every bound at 0 s"):
        recorded(burgers(0.01, +1.0), Conditions(duration_s=2.0))


def test_slope_and_bend_of_a_wave_are_its_derivatives():
    k = 2 * np.pi / LENGTH * 5
    slope, bend = slope_and_bend(np.sin(k * places())[None])
    assert slope[0] == pytest.approx(k * np.cos(k * places()), abs=1e-10)
    assert bend[0] == pytest.approx(-(k**2) * np.sin(k * places()), abs=1e-9)


def test_smoothing_in_space_keeps_the_field_and_only_its_share_of_the_noise():
    wave = np.sin(2 * np.pi / LENGTH * 10 * places()) + np.zeros((400, 1))
    noise = 0.05 * np.random.default_rng(0).standard_normal(wave.shape)
    left = smoothed_in_space(wave + noise) - wave
    assert left.std() == pytest.approx(0.05 * np.sqrt(2 * 15 / POINTS), rel=0.1)
