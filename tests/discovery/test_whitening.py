import numpy as np
from hypothesis import given, settings
from hypothesis import strategies as st

from gaitdisc.discovery.noise import whiten


def _whitened(values, predictors, spread, known=None):
    out = np.empty_like(values)
    known = np.ones(values.shape[:3], bool) if known is None else known
    whiten(values, 0, known, np.array(predictors), np.array(spread), out)
    return out


def test_what_the_past_says_is_taken_off_and_the_rest_divided():
    out = _whitened(
        np.array([4.0, 6.0, 8.0]).reshape(1, 3, 1, 1), [[0.0, 0.0], [0.5, 0.0], [1.0, -0.5]], [4.0, 2.0, 1.0]
    )
    np.testing.assert_allclose(out.ravel(), [4 / 4, (6 - 0.5 * 4) / 2, 8 - 6 + 0.5 * 4])


def test_each_segment_begins_afresh():
    values = np.arange(12.0).reshape(2, 6, 1, 1)
    table, spread = [[0.0], [0.9]], [2.0, 1.0]
    both = _whitened(values, table, spread)
    alone = _whitened(values[1:], table, spread)
    np.testing.assert_array_equal(both[1:], alone)


def test_what_follows_a_gap_begins_afresh_and_the_gap_is_nothing():
    values = np.arange(1.0, 8.0).reshape(1, 7, 1, 1)
    known = np.array([1, 1, 0, 0, 1, 1, 1], bool).reshape(1, 7, 1)
    table, spread = [[0.0], [0.9]], [2.0, 1.0]
    out = _whitened(values, table, spread, known)
    np.testing.assert_array_equal(out[:, 2:4], 0.0)
    np.testing.assert_array_equal(out[:, 4:], _whitened(values[:, 4:], table, spread))


@settings(max_examples=20, deadline=None)
@given(st.floats(-0.9, 0.9), st.floats(0.1, 10.0), st.integers(0, 99))
def test_the_innovations_of_an_autoregression_come_back(autocorrelation, size, seed):
    innovations = np.random.default_rng(seed).normal(size=30)
    spread = size / np.sqrt(1 - autocorrelation**2)
    values = [spread * innovations[0]]
    for one in innovations[1:]:
        values.append(autocorrelation * values[-1] + size * one)
    out = _whitened(np.reshape(values, (1, 30, 1, 1)), [[0.0], [autocorrelation]], [spread, size])
    np.testing.assert_allclose(out.ravel(), innovations, atol=1e-9)


def test_other_channels_are_left_alone():
    out = np.full((1, 4, 2, 1), 7.0)
    whiten(np.ones((1, 4, 2, 1)), 1, np.ones((1, 4, 2), bool), np.zeros((1, 1)), np.array([2.0]), out)
    np.testing.assert_array_equal(out[..., 0, 0], 7.0)
    np.testing.assert_array_equal(out[..., 1, 0], 0.5)
