import numpy as np
import pytest
from chapter3.starts import Filtered, Uncertainty, ensemble_kalman, unscented_kalman

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
