import numpy as np
import pytest

from gaitdisc.errors import StrideError
from gaitdisc.reconstruction.reconstruct import contact_times, persistence, phase_average
from gaitdisc.recording import Samples


def walk(duration=20.0, first=0.25, start=0.0):
    """A state that is a function of phase alone; strides of a second, contacts at `first`, `first` + 1, ..."""
    time = start + np.arange(round(100 * duration)) / 100
    phi = 100 * ((time - first) % 1.0)
    phi[time < first] = np.nan
    y = np.column_stack([np.sin(2 * np.pi * (time - first)), np.cos(2 * np.pi * (time - first))])
    return Samples(y[:, :1], y, ("a",), ("a", "b"), time, phi)


def test_contacts_are_where_percent_stride_begins_anew():
    trial = walk()
    np.testing.assert_allclose(contact_times(trial), np.arange(20) + 0.25, atol=1e-9)
    apart = trial.rows((trial.time < 5.1) | (trial.time > 8.6))
    gone = np.array([6.25, 7.25])
    np.testing.assert_allclose(contact_times(apart), np.setdiff1d(np.arange(20) + 0.25, gone), atol=1e-9)


def test_the_mean_stride_tells_a_state_that_is_a_function_of_phase():
    average = phase_average([walk(), walk(first=0.6)])
    assert average.stride_s == pytest.approx(1.0)
    trial = walk(10.0, first=0.4)
    forecast = average.forecast([trial], 0.3)
    before = trial.time < 0.4 + 0.3 - 1e-6
    assert np.isnan(forecast[before]).all()
    np.testing.assert_allclose(forecast[~before], trial.y[~before], atol=0.07)  # bins of one percent


def test_the_mean_stride_knows_no_contact_that_has_not_happened():
    average = phase_average([walk()])
    late = walk(10.0)
    late = Samples(late.x, late.y, late.inputs, late.outputs, late.time, np.where(late.time > 5.25, np.nan, late.phi))
    forecast = average.forecast([late], 0.5)
    np.testing.assert_allclose(forecast[-100:], average.forecast([walk(10.0)], 0.5)[-100:], atol=0.1)


def test_persistence_looks_back_within_its_own_trial():
    pair = [walk(3.0), walk(3.0, start=50.0)]
    forecast = persistence(pair, 0.2)
    assert np.isnan(forecast[[0, 19, 300, 319]]).all()
    np.testing.assert_array_equal(forecast[20:300], pair[0].y[:280])
    np.testing.assert_array_equal(forecast[320:], pair[1].y[:280])


def test_without_strides():
    still = walk(3.0)
    none = Samples(still.x, still.y, still.inputs, still.outputs, still.time, np.full(300, np.nan))
    with pytest.raises(StrideError, match=r"0.*100 of 100"):
        phase_average([none])


def test_strides_of_71_samples_each_leave_percents_empty_that_lie_between_their_neighbours():
    time = np.arange(710) / 100
    phi = 100 * (np.arange(710) % 71) / 71
    y = np.sin(2 * np.pi * phi / 100)[:, None]
    average = phase_average([Samples(y, y, ("a",), ("a",), time, phi)])
    assert average.stride_s == pytest.approx(0.71)
    np.testing.assert_allclose(average.curve[:, 0], np.sin(2 * np.pi * np.arange(100) / 100), atol=0.07)
