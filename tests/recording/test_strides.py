import warnings

import numpy as np
import pandas as pd
import pytest
from hypothesis import given
from hypothesis import strategies as st

from gaitdisc.channel import Channel
from gaitdisc.errors import ShapeError, StrideError
from gaitdisc.recording import PERCENT, Recording, Strides

KNEE = Channel("knee_angle_r", "angle", "deg", "r")


def strides(*contacts):
    return Strides(np.array(contacts[:-1]), np.array(contacts[1:]), "r", "force")


def test_phi_runs_from_0_to_below_100_and_is_nan_outside():
    phi = strides(1.0, 2.0, 4.0).phi(np.array([0.99, 1.0, 1.5, 1.9999999, 2.0, 3.0, 4.0]))
    np.testing.assert_allclose(phi, [np.nan, 0.0, 50.0, 99.99999, 0.0, 50.0, np.nan], rtol=1e-7)


@given(st.lists(st.floats(0.3, 2.0), min_size=1, max_size=20), st.integers(0, 2**31))
def test_phi_is_always_in_its_interval(durations, seed):
    contacts = np.concatenate([[0.0], np.cumsum(durations)])
    time = np.random.default_rng(seed).uniform(-1, contacts[-1] + 1, 200)
    phi = strides(*contacts).phi(time)
    inside = (time >= 0) & (time < contacts[-1])
    assert np.all(np.isfinite(phi) == inside)
    assert np.all((phi[inside] >= 0) & (phi[inside] < 100))


def test_normalised_ramp_is_percent_itself():
    time = np.arange(301) / 100
    ramp = Recording(time, (time % 1.0 * 100)[:, None], (KNEE,))
    curves = strides(0.0, 1.0).normalised(ramp)
    assert curves.shape == (1, 101, 1)
    np.testing.assert_allclose(curves[0, :100, 0], PERCENT[:100], atol=1e-9)


def test_normalised_passes_gaps_and_ends_through():
    time = np.arange(151) / 100
    values = np.ones((151, 1))
    values[50] = np.nan
    curves = strides(0.0, 1.0, 2.0).normalised(Recording(time, values, (KNEE,)))
    assert np.isnan(curves[0, 50, 0])
    assert np.isfinite(curves[0, [48, 52], 0]).all()
    assert np.isfinite(curves[1, :51, 0]).all()
    assert np.isnan(curves[1, 52:, 0]).all()


def test_between_takes_whole_strides():
    assert strides(0.0, 1.0, 2.0, 3.0).between(0.5, 3.0).start.tolist() == [1.0, 2.0]


def test_order_and_shape():
    with pytest.raises(StrideError, match="starts, overlaps"):
        Strides(np.array([0.0, 0.5]), np.array([1.0, 1.5]), "r", "force")
    with pytest.raises(ShapeError, match="as many ends as starts"):
        Strides(np.array([0.0, 0.5]), np.array([1.0]), "r", "force")


def test_every_time_has_the_number_of_its_stride():
    strides = Strides(np.array([1.0, 2.5]), np.array([2.0, 3.5]), "r", "force")
    time = np.array([0.9, 1.0, 1.99, 2.0, 2.4, 2.5, 3.49, 3.5])
    np.testing.assert_array_equal(strides.number(time), [-1, 0, 0, -1, -1, 1, 1, -1])
    np.testing.assert_array_equal(np.isfinite(strides.phi(time)), strides.number(time) >= 0)
    none = Strides(np.empty(0), np.empty(0), "r", "force")
    np.testing.assert_array_equal(none.number(time), np.full(8, -1))
    assert len(none) == 0 and np.isnan(none.phi(time)).all()


def test_a_table_is_cut_as_its_recording_is():
    time = np.arange(300) / 100
    one, table = strides(0.5, 1.5), pd.DataFrame({"knee": time, "time": time})
    for recording in (table, table.set_index("time")):
        np.testing.assert_allclose(one.normalised(recording)[0, :, 0], 0.5 + np.arange(101) / 100)
    for other, words in ((time, "found ndarray"), (table[["knee"]], "found DataFrame without this column")):
        with pytest.raises(ShapeError, match=rf"\[s\].*'time'; {words}"):
            one.normalised(other)


def test_no_warning_of_numpy_where_nothing_is_known():
    knee = Channel("knee_angle_r", "angle", "deg", "r")
    strides = Strides(np.array([0.0, 1.0]), np.array([1.0, 2.0]), "r", "force")
    with warnings.catch_warnings():
        warnings.simplefilter("error")
        one = strides.normalised(Recording(np.array([0.5]), np.ones((1, 1)), (knee,)))
    assert one.shape == (2, 101, 1) and np.isnan(one).all()
    with pytest.raises(StrideError, match=r"2 strides.*'r'"):
        Strides(np.array([0.0, np.nan]), np.array([1.0, 2.0]), "r", "force")
