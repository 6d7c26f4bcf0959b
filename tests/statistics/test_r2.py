from __future__ import annotations

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from sklearn.metrics import r2_score
from texts import says

from gaitdisc.errors import ShapeError
from gaitdisc.statistics.r2 import r2, why_no_r2


@given(st.integers(0, 999), st.floats(1e-6, 1e6), st.floats(-1e6, 1e6))
def test_it_is_scikit_learns_and_does_not_depend_on_the_unit(seed, unit, offset):
    rng = np.random.default_rng(seed)
    y, f = rng.normal(size=(2, 30, 3))
    np.testing.assert_allclose(r2(y, f), r2_score(y, f, multioutput="raw_values"))
    if unit > 1e-3 * abs(offset):
        np.testing.assert_allclose(r2(unit * y + offset, unit * f + offset), r2(y, f), rtol=1e-6)


def test_perfect_mean_and_worse_than_the_mean():
    y = np.arange(5.0)[:, None] * np.ones(3)
    f = np.column_stack([y[:, 0], np.full(5, 2.0), y[::-1, 0]])
    np.testing.assert_allclose(r2(y, f), [1.0, 0.0, -3.0])


def test_the_mean_is_that_of_the_held_out_part_itself():
    """A prediction by another mean, 3 beside a spread of 1, is judged by what it misses: 1 - (1 + 9) / 1."""
    y = np.array([[-1.0], [1.0]])
    assert r2(y, np.full((2, 1), 3.0))[0] == pytest.approx(-9.0)


def test_it_is_nan_with_a_reason_where_it_means_nothing():
    y = np.column_stack([np.full(4, 0.3), np.arange(4.0), np.full(4, 1e5) + 1e-6 * np.arange(4), np.arange(4.0)])
    f = y.copy()
    f[2, 1] = np.nan
    assert np.isnan(r2(y, f)).tolist() == [True, True, True, False]
    constant, missing, rounding, fine = why_no_r2(y, f)
    assert says(constant, "0.3", "4 samples")
    assert says(missing, "1 of 4 samples")
    assert says(rounding, "the measured part", "100000")
    assert fine == ""
    assert why_no_r2(y[:1], f[:1])[0] == "1 samples are too few"
    assert np.isnan(r2(y[:0], f[:0])).all()


def test_shapes():
    with pytest.raises(ShapeError, match=r"shape \(sample, column\).*\(4, 1\).*\(4, 2\)"):
        r2(np.zeros((4, 1)), np.zeros((4, 2)))
