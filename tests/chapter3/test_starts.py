"""Where a forecast starts: least squares over a window, Kalman filters."""

from dataclasses import replace

import numpy as np
import pytest
from chapter3.burgers import burgers
from chapter3.cell import learned_model
from chapter3.methods import MethodSettings
from chapter3.record import Conditions, recorded, system_of
from chapter3.sindy import Sindy, library
from chapter3.starts import (
    WINDOWS,
    Filtered,
    Uncertainty,
    ensemble_kalman,
    estimated_start,
    filtered_start,
    forecast_start,
    unscented_kalman,
)

from gaitdisc.errors import ShapeError
from gaitdisc.simulation.simulation_file import bundled

NOISE = Uncertainty(np.array([1.0, 2.0]), np.array([0.01, 0.02]), 0.3)
TURN, SEEN = np.array([[1.0, 0.1], [-0.2, 0.97]]), np.array([1.0, 0.0])
Y = np.random.default_rng(0).standard_normal(60)


def linear_kalman(turn, seen, y, start, noise):
    """The filter of Kalman 1960, J. Basic Eng. 82:35, of one channel: what the others are where all is linear."""
    x, p = np.array(start, float), np.diag(noise.first**2)
    states, sd, likelihood = np.empty((len(y), len(x))), np.empty((len(y), len(x))), 0.0
    for k, value in enumerate(y):
        if k:
            x, p = turn @ x, turn @ p @ turn.T + np.diag(noise.step**2)
        variance, missed = seen @ p @ seen + noise.measured**2, value - seen @ x
        gain = p @ seen / variance
        likelihood -= 0.5 * (np.log(2 * np.pi * variance) + missed**2 / variance)
        x, p = x + gain * missed, p - np.outer(gain, seen @ p)
        states[k], sd[k] = x, np.sqrt(np.diag(p))
    return Filtered(states, sd, likelihood)


def test_both_filters_agree_where_everything_is_linear():
    one = linear_kalman(TURN, SEEN, Y, np.zeros(2), NOISE)
    other = unscented_kalman(lambda x: x @ TURN.T, lambda x: x @ SEEN, Y, np.zeros(2), NOISE)
    assert np.allclose(one.states, other.states, atol=1e-7)
    assert np.allclose(one.sd, other.sd, atol=1e-7)


def test_a_mean_is_weighed_as_bayes_says():
    found = linear_kalman(
        np.eye(1), np.ones(1), np.full(9, 5.0), np.zeros(1), Uncertainty(np.ones(1), np.zeros(1), 2.0)
    )
    assert found.states[-1, 0] == pytest.approx(5 * 9 / (9 + 4))
    assert found.sd[-1, 0] ** 2 == pytest.approx(1 / (1 + 9 / 4))


def test_likelihoods_of_both_filters_are_that_of_the_whole_record():
    one = linear_kalman(TURN, SEEN, Y, np.zeros(2), NOISE)
    other = unscented_kalman(lambda x: x @ TURN.T, lambda x: x @ SEEN, Y, np.zeros(2), NOISE)
    state, covariance, rows = np.diag(NOISE.first**2), [], []
    for _ in Y:  # covariance of the measurements among each other, written out
        covariance.append(state)
        state = TURN @ state @ TURN.T + np.diag(NOISE.step**2)
    for i in range(len(Y)):
        rows.append([
            SEEN @ np.linalg.matrix_power(TURN, max(i - j, 0)) @ covariance[min(i, j)]
            @ np.linalg.matrix_power(TURN, max(j - i, 0)).T @ SEEN
            for j in range(len(Y))
        ])  # fmt: skip
    whole = np.array(rows) + 0.09 * np.eye(len(Y))
    _, size = np.linalg.slogdet(2 * np.pi * whole)
    wanted = -0.5 * (size + Y @ np.linalg.solve(whole, Y))
    assert one.likelihood == pytest.approx(wanted, rel=1e-9)
    assert other.likelihood == pytest.approx(wanted, rel=1e-6)


def test_an_ensemble_without_process_noise_comes_near_the_linear_filter():
    still = Uncertainty(np.array([1.0, 2.0]), np.array([0.1, 0.2]), 0.3)
    one = linear_kalman(TURN, SEEN, Y, np.zeros(2), still)
    many = ensemble_kalman(lambda x: x @ TURN.T, lambda x: x @ SEEN, Y, np.zeros(2), still, members=4000)
    assert np.abs(many.states - one.states).max() < 0.15 * one.sd.max()


def test_several_channels_weigh_as_one_with_the_noise_of_their_mean():
    noise = Uncertainty(np.ones(1), np.zeros(1), np.array([2.0, 2.0]))
    both = unscented_kalman(lambda x: x, lambda x: x[:, [0, 0]], np.full((9, 2), 5.0), np.zeros(1), noise)
    one = unscented_kalman(
        lambda x: x, lambda x: x[:, 0], np.full(9, 5.0), np.zeros(1),
        Uncertainty(np.ones(1), np.zeros(1), 2 / np.sqrt(2)),
    )  # fmt: skip
    assert both.states[-1] == pytest.approx(one.states[-1], abs=1e-9)
    assert both.sd[-1] == pytest.approx(one.sd[-1], abs=1e-9)


DT, TIME = 0.01, np.arange(1000) * 0.01
TRUTH = np.column_stack([np.cos(TIME), -np.sin(TIME)])


def turning(rate):
    """A pendulum of small swing, solved by a rotation; the first state or both are measured."""

    def run(start, time):
        angle = rate * (time - time[0])
        x = start[0] * np.cos(angle) + start[1] * np.sin(angle)
        v = start[1] * np.cos(angle) - start[0] * np.sin(angle)
        states = np.column_stack([x, v])
        return states, states

    return run


def noisy(seed, sd=0.1):
    return TRUTH + sd * np.random.default_rng(seed).standard_normal(TRUTH.shape)


def test_the_state_of_a_linear_model_is_that_of_least_squares():
    measured = noisy(0)
    found = estimated_start(turning(1.0), TIME, measured, TRUTH)
    window = slice(len(TIME) - 1 - found.samples, None)
    angle = TIME[window] - TIME[-1]
    rows = np.vstack(
        [np.column_stack([np.cos(angle), np.sin(angle)]), np.column_stack([-np.sin(angle), np.cos(angle)])]
    )
    sd = (measured - TRUTH).std(axis=0)
    weight = np.repeat(1 / sd, len(angle))
    wanted, *_ = np.linalg.lstsq(rows * weight[:, None], measured[window].T.ravel() * weight, rcond=None)
    assert found.samples == WINDOWS[-1]
    assert found.state == pytest.approx(wanted, abs=1e-6)
    assert found.sd == pytest.approx(0.1 / np.sqrt(found.samples + 1), rel=0.1)


def test_the_error_is_as_large_as_its_standard_error_says():
    found = [estimated_start(turning(1.0), TIME, noisy(seed), TRUTH) for seed in range(40)]
    scaled = np.array([(each.state - TRUTH[-1]) / each.sd for each in found])
    assert 0.75 < np.sqrt(np.mean(scaled**2)) < 1.3


def test_a_model_that_is_wrong_is_fitted_to_a_short_window():
    wrong = [estimated_start(turning(1.3), TIME, noisy(seed), TRUTH) for seed in range(10)]
    assert max(each.samples for each in wrong) < WINDOWS[-1]
    longest = 1.3 * DT * WINDOWS[-1] - DT * WINDOWS[-1]  # by how far the phase of a whole window would be off
    assert all(np.abs(each.state - TRUTH[-1]).max() < longest / 4 for each in wrong)


def test_a_state_that_is_not_measured_is_found_by_the_model():
    def seen(start, time):
        states, _ = turning(1.0)(start, time)
        return states, states[:, :1]

    guess = np.column_stack([TRUTH[:, 0], np.zeros(len(TIME))])
    found = estimated_start(seen, TIME, noisy(1)[:, :1], guess)
    assert np.abs(found.state - TRUTH[-1]).max() < 0.05


def test_without_noise_it_is_the_last_sample():
    assert estimated_start(turning(1.3), TIME, TRUTH, TRUTH).state == pytest.approx(TRUTH[-1], abs=1e-12)


def test_a_model_that_diverges_leaves_the_first_guess():
    def lost(start, time):
        nothing = np.full((len(time), 2), np.nan)
        return nothing, nothing

    found = estimated_start(lost, TIME, noisy(0), TRUTH)
    assert (found.samples, found.state.tolist()) == (0, TRUTH[-1].tolist())
    assert np.isnan(found.sd).all()


def cubic(weight=-0.01):
    powers = library(2, 3)
    coefficients = np.where((powers == [3, 0]).all(axis=1)[:, None], [0.0, weight], 0.0)
    return Sindy(("x", "y"), ("x", "y"), powers, coefficients, 0.0)


@pytest.fixture(scope="module")
def loud(van_der_pol):
    return recorded(van_der_pol, Conditions(noise=0.1, duration_s=20.0))


@pytest.mark.parametrize("approach", ["dynamics", "state"])
def test_nothing_of_the_truth_and_of_the_forecast_is_used(loud, approach):
    measured = np.array(loud.measured)
    measured[loud.split :] = np.nan
    blind = replace(loud, truth=np.full_like(loud.truth, np.nan), measured=measured)
    learned = cubic() if approach == "dynamics" else cubic(0.0)
    assert np.array_equal(forecast_start(blind, learned, approach), forecast_start(loud, learned, approach))


def test_it_is_nearer_to_the_true_state_than_the_last_filtered_sample(van_der_pol, lorenz):
    for system, learned in ((van_der_pol, cubic()), (lorenz, None)):
        size, errors = None, []
        for seed in range(5):
            record = recorded(system, Conditions(noise=0.1, seed=seed, duration_s=20.0))
            true, size = record.start(forecast=True), record.truth.std(axis=0)
            both = (forecast_start(record, learned, "dynamics"), record.filtered[-1])
            errors.append([np.sqrt(np.mean(((each - true) / size) ** 2)) for each in both])
        ours, last = np.sqrt(np.mean(np.square(errors), axis=0))
        assert ours < 0.5 * last, system.name


def test_a_state_that_is_not_measured_is_estimated_too(van_der_pol):
    only = replace(van_der_pol, observation=np.eye(2)[:1])
    record = recorded(only, Conditions(noise=0.01, duration_s=20.0))
    assert forecast_start(record, None, "state") == pytest.approx(record.start(forecast=True), abs=0.3)


def test_the_published_way_and_a_field_begin_at_the_last_smoothed_sample(van_der_pol):
    published = recorded(van_der_pol, Conditions(noise=0.05, duration_s=10.0, published=True, absolute=True))
    assert np.array_equal(forecast_start(published, cubic(), "dynamics"), published.filtered[-1])
    field = recorded(burgers(0.1), Conditions(noise=0.01, duration_s=2.0))
    assert np.array_equal(forecast_start(field, None, "dynamics"), field.filtered[-1])


@pytest.mark.parametrize("by", ["unscented", pytest.param("ensemble", marks=pytest.mark.slow)])
def test_a_filter_is_nearer_to_the_true_state_than_the_last_sample_and_its_smoothing(van_der_pol, by):
    record = recorded(van_der_pol, Conditions(noise=0.1, duration_s=20.0, seed=5))
    learned = learned_model(record, "sindy", "dynamics", MethodSettings())
    true = record.start(forecast=True)
    error = np.linalg.norm(filtered_start(record, learned, by) - true)
    assert error < 0.5 * np.linalg.norm(record.filtered[-1] - true)


def test_states_that_nobody_measures_are_refused():
    hidden = system_of(bundled("mass_spring_damper"), gain=(1.1,))
    record = recorded(hidden, Conditions(noise=0.01, duration_s=5.0))
    with pytest.raises(ShapeError, match=r"2 states.*1 are: x"):
        filtered_start(record, lambda x: x, "unscented")
