from dataclasses import replace

import numpy as np
import pytest

from gaitdisc.discrepancy.record import Conditions, recorded
from gaitdisc.errors import SamplingError


def test_noise_is_a_share_of_each_channel_or_absolute(lorenz):
    for absolute in (False, True):
        record = recorded(lorenz, Conditions(noise=0.1, absolute=absolute, duration_s=20.0))
        wanted = 0.1 * (np.ones(3) if absolute else record.truth.std(axis=0))
        assert (record.measured - record.truth).std(axis=0) == pytest.approx(wanted, rel=0.1)


def test_the_published_variant_starts_and_judges_from_the_last_measured_sample(van_der_pol):
    record = recorded(van_der_pol, Conditions(noise=0.05, published=True, absolute=True, duration_s=10.0))
    assert np.array_equal(record.start(forecast=True), record.filtered[-1])
    assert np.array_equal(record.target(forecast=True)[0], record.filtered[-1])
    right = recorded(van_der_pol, Conditions(noise=0.05, duration_s=10.0))
    assert np.array_equal(right.target(forecast=True), right.truth[right.split - 1 :])


def test_a_record_too_short_says_by_how_much(van_der_pol):
    with pytest.raises(SamplingError, match=r"needs 60 samples; 0.5 s at 0.01 s give 31, 29 too few"):
        recorded(van_der_pol, Conditions(duration_s=0.5))


def test_a_start_that_is_assumed_wrongly_is_the_known_models_and_not_the_forecasts(van_der_pol):
    wrong = replace(van_der_pol, assumed=np.array([0.6, 4.0]))
    record = recorded(wrong, Conditions(duration_s=5.0))
    assert record.start(forecast=False).tolist() == [0.6, 4.0]
    assert np.array_equal(record.start(forecast=True), record.truth[record.split - 1])
    assert record.truth[0].tolist() == [0.1, 5.0]
