"""What each operation computes, also where it has no value."""

import math

import numpy as np
import pytest

from gaitdisc.simulation.expression import parse
from gaitdisc.simulation.program import at_points, compile_program

X = np.concatenate([np.linspace(-30, 30, 301), [1e-8, -1e-8, 1e-3, 350.0, -350.0, 1e5, -1e5]])


def _values(text, x):
    x = np.asarray(x, float)
    return at_points(compile_program([parse(text)], ["x"]), [x], None, len(x))[0]


@pytest.mark.parametrize("name", ["sin", "cos", "tan", "atan", "tanh", "exp", "abs"])
def test_functions_are_those_of_mathematics(name):
    wanted = {"abs": abs, "exp": lambda x: math.exp(min(x, 700.0))}.get(name) or getattr(math, name)
    np.testing.assert_allclose(_values(f"{name}(x)", X), [wanted(x) for x in X], rtol=4e-15, atol=2e-16)


def test_functions_with_a_domain():
    np.testing.assert_allclose(_values("log(x)", [1e-9, 1, 7.5]), np.log([1e-9, 1, 7.5]))
    assert _values("log(x)", [0.0])[0] == -np.inf
    assert np.isnan(_values("log(x)", [-1.0, np.nan])).all()
    assert _values("sqrt(x)", [2.0])[0] == math.sqrt(2)
    assert np.isnan(_values("sqrt(x)", [-1.0, np.nan])).all()


def test_exponent_is_held_at_700():
    np.testing.assert_allclose(_values("exp(x)", [700.0, 1e9]), math.exp(700), rtol=1e-13)
    assert _values("exp(x)", [-1e9])[0] == 0.0


def test_division_by_zero_is_no_exception():
    assert _values("1/x", [0.0])[0] == np.inf
    assert np.isnan(_values("x/x", [0.0])[0])
    assert np.isnan(_values("x**0.5", [-1.0])[0])


def test_sign_is_rounded_and_step_is_not():
    np.testing.assert_allclose(_values("sign(x)", [-1, 0.01, 1]), [-1, math.tanh(0.5), 1], rtol=1e-14)
    assert _values("step(x)", [-1.0, 0.0, 1e-300]).tolist() == [0.0, 0.0, 1.0]


def test_where_takes_nothing_of_what_is_not_chosen():
    assert _values("where(x, 1/x)", [-1.0, 0.0, 2.0]).tolist() == [0.0, 0.0, 0.5]
    assert np.isnan(_values("where(x, 1)", [np.nan])[0])


@pytest.mark.parametrize(
    "text",
    ["max(x, 1)", "min(1, x)", "step(x)", "where(x, x)", "atan(x)", "abs(x)", "sin(x)", "exp(x)", "tanh(x)", "x**3"],
)
def test_not_a_number_stays_one(text):
    assert np.isnan(_values(text, [np.nan])[0])


def test_the_same_at_any_place_of_a_block():
    x = np.linspace(-2, 2, 1000)
    np.testing.assert_array_equal(_values("sin(x) + exp(x)", x)[321:400], _values("sin(x) + exp(x)", x[321:400]))
