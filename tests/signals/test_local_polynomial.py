import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from scipy.signal import savgol_filter as of_scipy

from gaitdisc.signals.derivatives import savgol_filter


@given(half=st.integers(2, 12), extra=st.integers(0, 30), derivative=st.integers(0, 2), seed=st.integers(0, 99))
def test_numbers_are_those_of_scipy(half, extra, derivative, seed):
    width = 2 * half + 1
    values = np.random.default_rng(seed).normal(0, 10, width + extra)
    found = savgol_filter(values, width, 3, derivative, 0.01)
    np.testing.assert_allclose(
        found, of_scipy(values, width, 3, derivative, 0.01), rtol=0, atol=1e-9 * 0.01**-derivative
    )


@pytest.mark.parametrize("derivative", [0, 1, 2, 3])
def test_a_cubic_and_its_derivatives_come_out_exactly_up_to_both_ends(derivative):
    time = np.linspace(-1, 1, 41)
    cubic = np.polynomial.Polynomial([0.3, -1.0, 2.0, 0.7])
    found = savgol_filter(cubic(time), 11, 3, derivative, time[1] - time[0])
    expected = cubic.deriv(derivative)(time) if derivative else cubic(time)
    np.testing.assert_allclose(found, expected, atol=1e-9)
