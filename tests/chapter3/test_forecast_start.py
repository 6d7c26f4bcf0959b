from dataclasses import replace

import numpy as np
import pytest
from chapter3.burgers import burgers
from chapter3.record import Conditions, recorded
from chapter3.sindy import Sindy, library
from chapter3.starts import forecast_start


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
