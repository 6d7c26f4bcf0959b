import numpy as np
import pytest

from gaitdisc.recording.autocorrelation import autocorrelation_time


def test_of_an_autoregressive_series_it_is_the_sum_of_a_geometric_one():
    rng, kept = np.random.default_rng(0), 0.8
    series = np.zeros(200_000)
    for k, push in enumerate(rng.standard_normal(len(series) - 1)):
        series[k + 1] = kept * series[k] + push
    assert autocorrelation_time(series[:, None], 0.01)[0] == pytest.approx((1 + kept) / (1 - kept), rel=0.05)


def test_every_column_has_its_own_and_one_that_stands_still_none():
    rng = np.random.default_rng(1)
    noise = rng.standard_normal(50_000)
    found = autocorrelation_time(np.column_stack([noise, np.repeat(noise[::10], 10), np.zeros(50_000)]), 0.05)
    assert found == pytest.approx([1.0, 10.0, 1.0], rel=0.05)


def test_a_shift_and_a_scale_change_nothing():
    values = np.random.default_rng(2).standard_normal((500, 2)).cumsum(axis=0)
    assert autocorrelation_time(3 - 7 * values) == pytest.approx(autocorrelation_time(values))
