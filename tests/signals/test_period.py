from __future__ import annotations

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from gaitdisc.signals.walking import stride_period


@settings(deadline=None, max_examples=20)
@given(st.floats(0.5, 1.8))
def test_the_period_of_a_periodic_signal(period):
    t = np.arange(1500) / 100
    x = np.sin(2 * np.pi * t / period) + 0.6 * np.cos(4 * np.pi * t / period)
    found, regularity = stride_period(x, 100.0)
    assert found == pytest.approx(period, abs=0.01)
    assert regularity > 0.98


def test_noise_and_constants_do_not_repeat():
    assert stride_period(np.random.default_rng(0).normal(size=2000), 100.0)[1] < 0.2
    assert stride_period(np.zeros(2000), 100.0)[1] == 0.0


def test_gaps_do_not_matter():
    t = np.arange(1500) / 100
    x = np.sin(2 * np.pi * t)
    x[300:420] = np.nan
    assert stride_period(x, 100.0)[0] == pytest.approx(1.0, abs=0.01)


def test_two_strides_are_enough_and_one_is_not():
    t = np.arange(400) / 100
    x = np.sin(2 * np.pi * t / 1.1)
    assert stride_period(x[:220], 100.0)[0] == pytest.approx(1.1, abs=0.02)
    assert stride_period(x[:110], 100.0)[0] != pytest.approx(1.1, abs=0.1)
