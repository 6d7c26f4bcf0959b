"""The functions written here against those of mathematics."""

import math

import numpy as np
import pytest

from gaitdisc.simulation.operations import exponential, hyperbolic_tangent, sine

RNG = np.random.default_rng(5)
TURNS = np.arange(-50, 51) * np.pi / 2
ANGLES = np.concatenate([RNG.uniform(-10, 10, 3000), RNG.uniform(-1e5, 1e5, 3000), TURNS])


@pytest.mark.parametrize(("quarter", "wanted"), [(0, math.sin), (1, math.cos)])
def test_sine_and_cosine(quarter, wanted):
    found = np.array([sine(x, quarter) for x in ANGLES])
    assert np.abs(found - [wanted(x) for x in ANGLES]).max() < 2.3e-16


def test_exponential():
    x = np.concatenate([RNG.uniform(-700, 700, 3000), RNG.uniform(-1, 1, 3000), [0.0]])
    found, wanted = np.array([exponential(each) for each in x]), np.exp(x)
    assert np.abs(found / wanted - 1).max() < 4.5e-16
    assert exponential(-710.0) == 0.0
    assert exponential(1e9) == pytest.approx(math.exp(700), rel=1e-14)


def test_hyperbolic_tangent():
    x = np.concatenate([RNG.uniform(-20, 20, 3000), RNG.uniform(-1, 1, 3000), 10.0 ** -np.arange(1, 300), [1e9, -1e9]])
    found, wanted = np.array([hyperbolic_tangent(each) for each in x]), np.tanh(x)
    assert np.abs(found / wanted - 1).max() < 4.5e-16


@pytest.mark.parametrize("function", [lambda x: sine(x, 0), lambda x: sine(x, 1), exponential, hyperbolic_tangent])
def test_not_a_number_stays_one(function):
    assert math.isnan(function(math.nan))
