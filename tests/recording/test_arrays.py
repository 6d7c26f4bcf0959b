import numpy as np
import pytest

from gaitdisc.recording.arrays import mean_where_known, read_only


def test_the_view_cannot_be_written_and_shares_memory():
    values = np.zeros(3)
    view = read_only(values)
    with pytest.raises(ValueError, match="read-only"):
        view[0] = 1.0
    assert np.shares_memory(view, values)
    values[0] = 2.0  # the caller's own array stays writable


def test_a_mean_is_of_the_values_that_are_there():
    values = np.array([[1.0, np.nan, np.nan, np.inf], [3.0, 5.0, np.nan, 2.0]])
    assert mean_where_known(values) == pytest.approx([2.0, 5.0, np.nan, 2.0], nan_ok=True)
    whole = np.random.default_rng(0).normal(size=(7, 3, 2))
    assert mean_where_known(whole) == pytest.approx(whole.mean(axis=0))
