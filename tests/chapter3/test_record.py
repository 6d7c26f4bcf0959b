from dataclasses import replace

import numpy as np
import pytest
from chapter3.record import Conditions, recorded

from gaitdisc.errors import SamplingError


def test_noise_is_a_share_of_each_channel_or_absolute(lorenz):
    for absolute in (False, True):
        record = recorded(lorenz, Conditions(noise=0.1, absolute=absolute, duration_s=20.0))
        wanted = 0.1 * (np.ones(3) if absolute else record.truth.std(axis=0))
        assert (record.measured - record.truth).std(axis=0) == pytest.approx(wanted, rel=0.1)


def test_the_published_variant_starts_and_compares_from_the_last_measured_sample(van_der_pol):
    record = recorded(van_der_pol, Conditions(noise=0.05, published=True, absolute=True, duration_s=10.0))
    assert np.array_equal(record.start(forecast=True), record.filtered[-1])
    assert np.array_equal(record.target(forecast=True)[0], record.filtered[-1])
    right = recorded(van_der_pol, Conditions(noise=0.05, duration_s=10.0))
    assert np.array_equal(right.target(forecast=True), right.truth[right.split - 1 :])


def test_a_record_too_short_says_by_how_much(van_der_pol):
    with pytest.raises(SamplingError, match=r"60 samples.*0.01 s.*31, 29"):
        recorded(van_der_pol, Conditions(duration_s=0.5))


def test_a_start_that_is_assumed_wrongly_is_the_known_models_and_not_the_forecasts(van_der_pol):
    wrong = replace(van_der_pol, assumed=np.array([0.6, 4.0]))
    record = recorded(wrong, Conditions(duration_s=5.0))
    assert record.start(forecast=False).tolist() == [0.6, 4.0]
    assert np.array_equal(record.start(forecast=True), record.truth[record.split - 1])
    assert record.truth[0].tolist() == [0.1, 5.0]


def test_further_records_start_where_the_first_one_went_with_noise_of_their_own(van_der_pol):
    record = recorded(van_der_pol, Conditions(noise=0.05, duration_s=10.0, trajectories=3))
    low, high = record.truth.min(axis=0), record.truth.max(axis=0)
    starts = [each.truth[0] for each in record.others]
    assert len(starts) == 2
    assert all(((low <= start) & (start <= high)).all() for start in starts)
    noises = [each.measured - each.truth for each in (record, *record.others)]
    assert max(abs(np.corrcoef(noises[0].ravel(), other.ravel())[0, 1]) for other in noises[1:]) < 0.1
    alone = recorded(van_der_pol, Conditions(noise=0.05, duration_s=10.0))
    assert np.array_equal(alone.measured, record.measured)


def test_what_is_sacrificed_is_the_beginning_of_the_forecast(van_der_pol):
    record = recorded(van_der_pol, Conditions(noise=0.05, duration_s=10.0, sacrificed_s=2.0))
    part = record.beginning_of_forecast(np.array([0.3, 0.4]))
    assert part.split == len(part.time) == 201
    assert np.array_equal(part.measured, record.measured[record.split - 1 : record.split + 200])
    assert part.start(forecast=False).tolist() == [0.3, 0.4]


def test_sacrificing_all_of_a_forecast_or_next_to_nothing_is_refused(van_der_pol):
    for seconds, count in ((4.0, 401), (0.2, 21)):
        record = recorded(van_der_pol, Conditions(duration_s=10.0, sacrificed_s=seconds))
        with pytest.raises(SamplingError, match=rf"{seconds:g} s have {count} of the forecast's 401"):
            record.beginning_of_forecast(record.truth[0])
