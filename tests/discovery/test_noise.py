import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from scipy.signal import lfilter
from scipy.signal import savgol_filter as of_scipy

from gaitdisc.discovery.noise import (
    LEAST,
    MOST_LAGS,
    Noise,
    find_noise,
    savgol_filter,
    sensor_noise,
    white_noise,
    whiten,
)
from gaitdisc.discovery.record_filter import RecordFilter

FIRST, SECOND = 1.2, -0.5  # x[k] = 1.2 x[k-1] - 0.5 x[k-2] + e[k], e of variance 1


@pytest.fixture(scope="module")
def remembering():
    e = np.random.default_rng(4).normal(size=(60, 500))
    return lfilter([1.0], [1.0, -FIRST, -SECOND], e, axis=1)[:, 200:, None]


def test_an_autoregression_of_known_coefficients_is_recovered(remembering):
    noise = find_noise(remembering, white_share=0.0)
    assert noise.lags == (2,)
    np.testing.assert_allclose(noise.predictors[0][2], [FIRST, SECOND], atol=0.03)
    assert noise.spread[0][-1] == pytest.approx(1.0, abs=0.02)
    assert find_noise(remembering).is_autocorrelated
    ratio = FIRST / (1 - SECOND)  # first autocorrelation, Yule-Walker by hand
    variance = 1 / (1 - FIRST * ratio - SECOND * (FIRST * ratio + SECOND))
    assert noise.size[0] ** 2 == pytest.approx(variance, rel=0.04)  # the stationary one


def test_whitened_numbers_are_independent_and_of_unit_variance(remembering):
    white = find_noise(remembering, white_share=0.0).whiten(remembering)[:, :, 0]
    assert white.var() == pytest.approx(1.0, abs=0.03)
    along = [(white[:, :-lag] * white[:, lag:]).mean() for lag in (1, 2, 3, 4)]
    assert np.abs(along).max() < 4 / np.sqrt(white.size)


def test_the_first_samples_of_a_segment_are_as_likely_as_the_rest(remembering):
    noise = find_noise(remembering, white_share=0.0)
    many = np.concatenate([remembering[:, begin : begin + 3] for begin in range(0, 297, 3)])
    assert (noise.whiten(many) ** 2).mean(axis=0).ravel() == pytest.approx([1.0, 1.0, 1.0], abs=0.06)


def test_white_noise_has_no_memory_and_its_own_size():
    noise = find_noise(np.random.default_rng(0).normal(0, [3.0, 0.2], (40, 200, 2)))
    assert noise.lags == (0, 0)
    assert not noise.is_autocorrelated
    np.testing.assert_allclose(noise.size, [3.0, 0.2], rtol=0.03)


def test_numbers_that_the_fit_took_enlarge_the_variance():
    residual = np.random.default_rng(1).normal(size=(50, 20, 1))
    assert find_noise(residual, used=4.0).size[0] == pytest.approx(find_noise(residual).size[0] * np.sqrt(20 / 16))


def test_a_share_that_is_white_whatever_the_residuals_say():
    slow = np.sin(np.arange(400) / 40.0)[None, :, None] + np.zeros((3, 1, 1))
    left = find_noise(slow, white_share=0.1)
    assert left.spread[0][-1] ** 2 > 0.05 * left.spread[0][0] ** 2
    assert left.lags[0] <= MOST_LAGS


def test_columns_are_whitened_each_by_itself(remembering):
    noise = find_noise(remembering)
    two = np.stack([remembering, 2 * remembering], axis=-1)
    np.testing.assert_allclose(noise.whiten(two)[..., 1], 2 * noise.whiten(remembering))


def test_white_noise_of_a_size_divides_by_it_and_residuals_of_zero_by_no_zero():
    assert np.isfinite(find_noise(np.zeros((2, 40, 1))).whiten(np.zeros((2, 40, 1)))).all()
    noise: Noise = white_noise(np.array([2.0, 4.0]))
    np.testing.assert_array_equal(noise.whiten(np.full((1, 2, 2), 8.0))[0, 0], [4.0, 2.0])


def test_what_integration_leaves_is_white_and_there_in_any_case():
    noise = find_noise(np.zeros((2, 40, 2)), least=np.array([0.5, 2.0]))
    assert noise.size == pytest.approx([0.5, 2.0])
    assert noise.lags == (0, 0)


def test_gaps_do_not_count_and_what_follows_begins_afresh(remembering):
    gaps = remembering.copy()
    gaps[:, 100:120] = np.nan
    noise, whole = find_noise(gaps, white_share=0.0), find_noise(remembering, white_share=0.0)
    assert noise.lags == whole.lags
    assert noise.size[0] == pytest.approx(whole.size[0], rel=0.03)
    known = np.isfinite(gaps)
    white = whole.whiten(np.nan_to_num(gaps), known)
    np.testing.assert_array_equal(white[:, :100], whole.whiten(remembering)[:, :100])
    np.testing.assert_array_equal(white[:, 120:], whole.whiten(remembering[:, 120:]))
    assert not white[:, 100:120].any()
    assert not white_noise(np.ones(1)).whiten(np.ones_like(gaps), known)[:, 100:120].any()


def test_a_memory_that_the_records_filter_explains_is_none():
    passed = RecordFilter((6.0,), 100.0)
    white = np.random.default_rng(2).normal(size=(40, 600, 1))
    slow = lfilter([1.0], [1.0, -0.97], white, axis=1)
    autocorrelation = passed.autocorrelation(MOST_LAGS)
    for noise, beyond in ((white, False), (slow, True)):
        seen = passed.filtered(noise, 1)[:, 40 : -40 : passed.every]
        assert find_noise(seen).is_autocorrelated
        assert find_noise(seen, autocorrelation=autocorrelation).is_autocorrelated == beyond


T = np.arange(3000) / 100


def record(sd, seed=0):
    return np.sin(2 * np.pi * 0.9 * T) + np.random.default_rng(seed).normal(0, sd, T.size)


@pytest.mark.parametrize("sd", [0.001, 0.02, 0.3])
def test_white_noise_is_found_whatever_moves_below_it(sd):
    found = sensor_noise(np.stack([record(sd, seed) for seed in range(3)])[:, :, None])
    assert found == pytest.approx([sd], rel=0.06)


def test_each_channel_has_its_own_and_ends_of_trials_are_left_out():
    two = np.stack([record(0.02), record(0.1, 1)], axis=-1)[None]
    longer = np.concatenate([two, np.full((1, 500, 2), np.nan)], axis=1)
    assert sensor_noise(longer) == pytest.approx(sensor_noise(two))
    assert sensor_noise(two) == pytest.approx([0.02, 0.1], rel=0.06)


def test_a_record_without_noise_keeps_what_rounding_leaves():
    cubic = (T**3)[None, :, None]
    assert sensor_noise(cubic)[0] == pytest.approx(LEAST * cubic.std())


def test_a_trial_of_ten_samples_says_nothing():
    short = np.full((2, 3000, 1), np.nan)
    short[0, :, 0] = record(0.05)
    short[1, :10, 0] = 100 * np.random.default_rng(2).normal(size=10)
    assert sensor_noise(short) == pytest.approx(sensor_noise(short[:1]), rel=0.5)
    assert sensor_noise(short[:1]) == pytest.approx([0.05], rel=0.06)


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


@given(half=st.integers(2, 12), extra=st.integers(0, 30), derivative=st.integers(0, 2), seed=st.integers(0, 99))
def test_numbers_are_those_of_scipy(half, extra, derivative, seed):
    width = 2 * half + 1
    values = np.random.default_rng(seed).normal(0, 10, width + extra)
    found = savgol_filter(values, width, 3, derivative, 0.01)
    np.testing.assert_allclose(
        found, of_scipy(values, width, 3, derivative, 0.01), rtol=0, atol=1e-9 * 0.01**-derivative
    )


@pytest.mark.parametrize("derivative", [0, 1, 2, 3])
def test_a_cubic_and_its_derivatives_come_out_exactly_up_to_both_ends(derivative):
    time = np.linspace(-1, 1, 41)
    cubic = np.polynomial.Polynomial([0.3, -1.0, 2.0, 0.7])
    found = savgol_filter(cubic(time), 11, 3, derivative, time[1] - time[0])
    expected = cubic.deriv(derivative)(time) if derivative else cubic(time)
    np.testing.assert_allclose(found, expected, atol=1e-9)
