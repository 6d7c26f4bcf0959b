import numpy as np
from hypothesis import given
from hypothesis import strategies as st
from hypothesis.extra.numpy import arrays

from gaitdisc.recording import scale_of


@given(arrays(float, (20, 3), elements=st.floats(-1e4, 1e4)))
def test_unscaling_undoes_scaling(values):
    scale = scale_of(values)
    np.testing.assert_allclose(scale.unscaled(scale.scaled(values)), values, atol=2e-5)


def test_constant_columns_weigh_nothing_also_where_they_vary_later():
    scale = scale_of(np.column_stack([np.full(10, 0.1), np.arange(10.0), np.full(10, -3.0) + 1e-13]))
    assert scale.constant.tolist() == [True, False, True]
    np.testing.assert_array_equal(scale.scaled(np.array([[5.0, 4.5, 9.0]])), [[0.0, 0.0, 0.0]])


def test_small_units_are_not_taken_for_constant():
    assert not scale_of(1e-6 * np.sin(np.arange(50.0))[:, None]).constant[0]


def test_numbers_are_frozen():
    assert not scale_of(np.arange(4.0)[:, None]).mean.flags.writeable


def test_missing_values_take_no_part():
    values = np.array([[1.0, np.nan, 5.0], [np.nan, np.nan, 7.0], [3.0, np.nan, 6.0]])
    scale = scale_of(values)
    np.testing.assert_array_equal(scale.mean, [2.0, 0.0, 6.0])
    assert scale.sd[0] == 1.0
    assert scale.constant.tolist() == [False, True, False]
