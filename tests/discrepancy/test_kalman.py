import numpy as np
import pytest

from gaitdisc.discrepancy.kalman import Uncertainty, linear_kalman, unscented_kalman

NOISE = Uncertainty(np.array([1.0, 2.0]), np.array([0.01, 0.02]), 0.3)
TURN, SEEN = np.array([[1.0, 0.1], [-0.2, 0.97]]), np.array([1.0, 0.0])
Y = np.random.default_rng(0).standard_normal(60)


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
