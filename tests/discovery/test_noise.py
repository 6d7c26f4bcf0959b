import numpy as np
import pytest
from scipy.signal import lfilter

from gaitdisc.discovery.noise import MOST_LAGS, Noise, noise_of, white_noise
from gaitdisc.discovery.record_filter import RecordFilter

FIRST, SECOND = 1.2, -0.5  # x[k] = 1.2 x[k-1] - 0.5 x[k-2] + e[k], e of variance 1


@pytest.fixture(scope="module")
def remembering():
    e = np.random.default_rng(4).normal(size=(60, 500))
    return lfilter([1.0], [1.0, -FIRST, -SECOND], e, axis=1)[:, 200:, None]


def test_an_autoregression_of_known_coefficients_is_recovered(remembering):
    noise = noise_of(remembering, white_share=0.0)
    assert noise.lags == (2,)
    np.testing.assert_allclose(noise.predictors[0][2], [FIRST, SECOND], atol=0.03)
    assert noise.spread[0][-1] == pytest.approx(1.0, abs=0.02)


def test_its_size_is_the_stationary_one(remembering):
    ratio = FIRST / (1 - SECOND)  # first autocorrelation, Yule-Walker by hand
    variance = 1 / (1 - FIRST * ratio - SECOND * (FIRST * ratio + SECOND))
    assert noise_of(remembering, white_share=0.0).size[0] ** 2 == pytest.approx(variance, rel=0.04)


def test_whitened_numbers_are_independent_and_of_unit_variance(remembering):
    white = noise_of(remembering, white_share=0.0).whitened(remembering)[:, :, 0]
    assert white.var() == pytest.approx(1.0, abs=0.03)
    along = [(white[:, :-lag] * white[:, lag:]).mean() for lag in (1, 2, 3, 4)]
    assert np.abs(along).max() < 4 / np.sqrt(white.size)


def test_the_first_samples_of_a_segment_are_as_likely_as_the_rest(remembering):
    noise = noise_of(remembering, white_share=0.0)
    many = np.concatenate([remembering[:, begin : begin + 3] for begin in range(0, 297, 3)])
    assert (noise.whitened(many) ** 2).mean(axis=0).ravel() == pytest.approx([1.0, 1.0, 1.0], abs=0.06)


def test_white_noise_has_no_memory_and_its_own_size():
    noise = noise_of(np.random.default_rng(0).normal(0, [3.0, 0.2], (40, 200, 2)))
    assert noise.lags == (0, 0)
    assert not noise.is_autocorrelated
    np.testing.assert_allclose(noise.size, [3.0, 0.2], rtol=0.03)


def test_noise_that_remembers_says_so(remembering):
    assert noise_of(remembering).is_autocorrelated


def test_numbers_that_the_fit_took_enlarge_the_variance():
    residual = np.random.default_rng(1).normal(size=(50, 20, 1))
    assert noise_of(residual, used=4.0).size[0] == pytest.approx(noise_of(residual).size[0] * np.sqrt(20 / 16))


def test_a_share_that_is_white_whatever_the_residuals_say():
    slow = np.sin(np.arange(400) / 40.0)[None, :, None] + np.zeros((3, 1, 1))
    left = noise_of(slow, white_share=0.1)
    assert left.spread[0][-1] ** 2 > 0.05 * left.spread[0][0] ** 2
    assert left.lags[0] <= MOST_LAGS


def test_columns_are_whitened_each_by_itself(remembering):
    noise = noise_of(remembering)
    two = np.stack([remembering, 2 * remembering], axis=-1)
    np.testing.assert_allclose(noise.whitened(two)[..., 1], 2 * noise.whitened(remembering))


def test_residuals_of_zero_do_not_divide_by_zero():
    noise = noise_of(np.zeros((2, 40, 1)))
    assert np.isfinite(noise.whitened(np.zeros((2, 40, 1)))).all()


def test_white_noise_of_a_size_divides_by_it():
    noise: Noise = white_noise(np.array([2.0, 4.0]))
    np.testing.assert_array_equal(noise.whitened(np.full((1, 2, 2), 8.0))[0, 0], [4.0, 2.0])


def test_what_integration_leaves_is_white_and_there_in_any_case():
    noise = noise_of(np.zeros((2, 40, 2)), least=np.array([0.5, 2.0]))
    assert noise.size == pytest.approx([0.5, 2.0])
    assert noise.lags == (0, 0)


def test_gaps_do_not_count_and_what_follows_begins_afresh(remembering):
    gaps = remembering.copy()
    gaps[:, 100:120] = np.nan
    noise, whole = noise_of(gaps, white_share=0.0), noise_of(remembering, white_share=0.0)
    assert noise.lags == whole.lags
    assert noise.size[0] == pytest.approx(whole.size[0], rel=0.03)
    known = np.isfinite(gaps)
    white = whole.whitened(np.nan_to_num(gaps), known)
    np.testing.assert_array_equal(white[:, :100], whole.whitened(remembering)[:, :100])
    np.testing.assert_array_equal(white[:, 120:], whole.whitened(remembering[:, 120:]))
    assert not white[:, 100:120].any()
    assert not white_noise(np.ones(1)).whitened(np.ones_like(gaps), known)[:, 100:120].any()


def test_a_memory_that_the_records_filter_explains_is_none():
    passed = RecordFilter((6.0,), 100.0)
    white = np.random.default_rng(2).normal(size=(40, 600, 1))
    slow = lfilter([1.0], [1.0, -0.97], white, axis=1)
    autocorrelation = passed.autocorrelation(MOST_LAGS)
    for noise, beyond in ((white, False), (slow, True)):
        seen = passed.filtered(noise, 1)[:, 40 : -40 : passed.every]
        assert noise_of(seen).is_autocorrelated
        assert noise_of(seen, autocorrelation=autocorrelation).is_autocorrelated == beyond
