"""The equations of a Python function, written down while it is called."""

import functools
import math
from math import sin as sine

import numpy as np
import pytest

from gaitdisc.simulation.expression import parse, written
from gaitdisc.simulation.traced import NotTraced, trace_equations

GRAVITY = 9.81


def equations(function, *names):
    return [written(tree) for tree in trace_equations(function, lambda value: (tuple(map(value, names)), {}))]


def value_at(text, **names):
    """Value of an expression by Python's own arithmetic."""
    return eval(
        text,
        {"step": lambda a: float(a > 0), "max": max, "min": min, "abs": abs, "where": where, **vars(math), **names},
    )


def where(a, b):
    return b if a > 0 else 0.0


def by_branches(v):
    if v > 1:
        return v - 1
    return v + 1 if v < -1 else 0.0


def swings(angle):
    import math as mathematics

    return GRAVITY * mathematics.sin(angle) + half_of(angle)


def half_of(x):
    return np.array([x, 0.0]) @ np.array([0.5, 7.0])


def filled_in(x, v):
    rates = np.zeros(2)
    rates[0], rates[1] = v, -float(x)
    return rates


def chain(a, b):
    return np.linalg.solve([[2.0, np.cos(a)], [np.cos(a), 3.0]], np.array([a, b]))


def looped(x):
    return sum(k * x**k for k in range(1, 4))


def guarded(v):
    return 0.0 if abs(v) < 1e-6 else v / abs(v)


@functools.lru_cache
def twice(x):
    return 2 * x


def remembered(x):
    return twice(x)


def refusing(x):
    if x > 0:
        return np.sqrt(x)
    raise ValueError("no root")


class Motor:
    """A model that is an object."""

    gain = 3.0

    def rates(self, x):
        return self.gain * math.cos(x)

    __call__ = rates


@pytest.mark.parametrize("motor", [Motor().rates, Motor(), functools.partial(lambda gain, x: gain * math.cos(x), 3.0)])
def test_methods_objects_and_partial_functions_are_written_down_too(motor):
    assert equations(motor, "x") == ["3*cos(x)"]


@pytest.mark.parametrize(
    ("function", "texts"),
    [
        (lambda x, v: (v, -x), ["v", "-x"]),
        (lambda x: 3 - 0.5 * x / 2, ["3 - 0.5*x/2"]),
        (lambda x: math.sin(x) + np.tanh(x) + sine(x), ["sin(x) + tanh(x) + sin(x)"]),
        (lambda x: [max(x, 0), min(1, x, 2), abs(x)], ["max(x, 0)", "min(1, x, 2)", "abs(x)"]),
        (lambda x: np.where(x > 0, 3 * x, 0.0), ["where(x, 3*x)"]),
        (lambda x: (x > 1) * (x - 1), ["step(x - 1)*(x - 1)"]),
        (lambda x: np.clip(x, -1, 1) + 0 * x, ["min(max(x, -1), 1)"]),
        (swings, ["9.81*sin(angle) + angle*0.5"]),
        (filled_in, ["v", "-x"]),
        (looped, ["x**1 + 2*x**2 + 3*x**3"]),
        (guarded, ["where(1 - step(1e-06 - abs(v)), v/abs(v))"]),
        (refusing, ["sqrt(x) + log(step(x))"]),
        (remembered, ["2*x"]),
    ],
)
def test_what_a_function_does_is_written_down(function, texts):
    found = equations(function, *function.__code__.co_varnames[: function.__code__.co_argcount])
    assert found == texts
    assert [written(parse(text)) for text in found] == texts


@pytest.mark.parametrize(
    ("function", "expected"),
    [
        (by_branches, by_branches),
        (lambda v: np.sign(v) * math.sqrt(abs(v)), lambda v: math.copysign(math.sqrt(abs(v)), v)),
        (lambda v: math.copysign(2.0, v) * (not v > 3), lambda v: (2.0 if v >= 0 else -2.0) if v <= 3 else 0.0),
        (lambda v: 1.0 if -1 < v <= 2 and v != 1 else 2.0, lambda v: 1.0 if -1 < v <= 2 and v != 1 else 2.0),
        (lambda v: ((v < 0) | (v > 2)) & ~(v > 3), lambda v: float(v < 0 or 2 < v <= 3)),
        (lambda v: np.interp(v, [-1.0, 0.0, 2.0], [1, 0, 4]), lambda v: float(np.interp(v, [-1, 0, 2], [1, 0, 4]))),
        (lambda v: math.hypot(v, 1) + np.sinh(v), lambda v: math.hypot(v, 1) + math.sinh(v)),
        (lambda v: np.arctan(v) + math.asin(v / 9), lambda v: math.atan(v) + math.asin(v / 9)),
        (lambda v: math.acos(v / 9) - math.atan2(v, v - 1), lambda v: math.acos(v / 9) - math.atan2(v, v - 1)),
    ],
)
def test_branches_and_tables_give_the_functions_own_numbers(function, expected):
    (text,) = equations(function, "v")
    for v in (-4.0, -1.0, -0.3, 0.5, 1.0, 2.0, 2.5, 3.0, 5.0):
        assert value_at(text, v=v) == pytest.approx(expected(v), abs=1e-12)


def test_a_mass_matrix_is_solved_for():
    texts = equations(chain, "a", "b")
    for a, b in ((0.3, 1.0), (-1.0, 2.0)):
        np.testing.assert_allclose([value_at(text, a=a, b=b) for text in texts], chain(a, b))


def halved(x):
    while x > 0.1:
        x = x / 2
    return x


def grown(x):
    for _ in range(30):
        x = x * x + x
    return x


@pytest.mark.parametrize(
    ("function", "words"),
    [
        (halved, "branches in more than 64 ways"),
        (grown, "too long"),
        (math.gamma, "converts a number into a float"),
        (lambda x: x % 1.0, "TypeError"),
        (lambda x: x + math.inf, "computes with inf"),
    ],
)
def test_what_cannot_be_written_down_is_said(function, words):
    with pytest.raises(NotTraced, match=words):
        equations(function, "x")
