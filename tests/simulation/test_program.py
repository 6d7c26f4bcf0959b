"""Programs: equal parts once, what is fixed first, registers used again."""

import math

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from gaitdisc.errors import SimulationError
from gaitdisc.simulation.expression import parse
from gaitdisc.simulation.program import CODES, at_points, compile_program, leaf_columns


def _value(text, **values):
    program = compile_program([parse(text)], list(values))
    return at_points(program, [np.array([float(value)]) for value in values.values()], None, 1)[0, 0]


def test_what_is_shared_is_computed_once():
    program = compile_program([parse("sin(k*x) + x*k"), parse("sin(x*k)**2")], ["x", "k"])
    assert [int(op) for op in program.code[:, 0]].count(CODES["sin"]) == 1
    assert len(program.code) == 4 + 2  # product, sine, sum, square; two stores


def test_what_depends_on_parameters_alone_comes_first():
    program = compile_program([parse("x*exp(k**2.5)/(2 + 3)")], ["x", "k"], ["k"])
    assert program.setup == 3  # power, exponential, 2 + 3
    assert program.code[program.setup :, 0].tolist() == [CODES["*"], CODES["/"], CODES["store"]]


def test_what_nobody_needs_is_left_out():
    program = compile_program([parse("x")], ["x"], (), {"unused": parse("sin(x)")})
    assert program.code[:, 0].tolist() == [CODES["store"]]


def test_registers_are_used_again():
    program = compile_program([parse(" + ".join(f"sin({i}*x)" for i in range(1, 100)))], ["x"])
    assert program.registers < 1 + 99 + 8


@pytest.mark.parametrize("power", [1, 2, 3, 4, 5, 7, 8, -1, -2, -3, 9, 0.5, 2.5, 0])
def test_powers(power):
    assert _value(f"x**{power}", x=1.7) == pytest.approx(1.7**power, rel=1e-15)
    if power == int(power):
        assert _value(f"x**{power}", x=-1.7) == pytest.approx((-1.7) ** power, rel=1e-15)


def test_max_of_three():
    assert _value("max(x, 2, k)", x=1.0, k=5.0) == 5.0
    assert _value("min(x, 2, k)", x=1.0, k=5.0) == 1.0


def test_a_delay_is_a_leaf_of_its_own():
    program = compile_program([parse("delay(x, d)*delay(x, d)*delay(v, d)")], ["x", "v", "d"])
    assert [signal for signal, _ in program.delays] == ["x", "v"]
    assert program.used().tolist() == [False, False, False, True, True]


TERMS = {
    "a*b": lambda a, b, c: a * b,
    "sin(a + b)": lambda a, b, c: math.sin(a + b),
    "b - c*a": lambda a, b, c: b - c * a,
    "max(a, b)": lambda a, b, c: max(a, b),
    "a/(1 + c**2)": lambda a, b, c: a / (1 + c**2),
    "tanh(a*b)": lambda a, b, c: math.tanh(a * b),
}


@given(st.lists(st.sampled_from(sorted(TERMS)), min_size=1, max_size=30))
def test_a_program_agrees_with_python(terms):
    values = {"a": 0.3, "b": -1.2, "c": 0.7}
    wanted = sum(TERMS[term](**values) for term in terms)
    assert _value(" + ".join(f"({term})" for term in terms), **values) == pytest.approx(wanted, rel=1e-12, abs=1e-12)


@pytest.mark.parametrize("mass", [2.0, 2.5])
def test_what_a_parameter_that_keeps_its_value_does_not_change_is_left_out(mass):
    text, leaves = parse("(-9.81*x + u) + (a*x + b*u)*(mass - 2.0)"), ["x", "u", "a", "b", "mass"]
    whole, quicker = (compile_program([text], leaves, ["mass"], None, still) for still in (None, {"mass": mass}))
    columns = [*np.random.default_rng(3).normal(size=(4, 20)), np.array(mass)]
    assert np.array_equal(at_points(whole, columns, None, 20), at_points(quicker, columns, None, 20))
    assert quicker.used().tolist() == [True, True, mass != 2.0, mass != 2.0, False]


def test_columns_are_in_the_order_of_a_program():
    columns = leaf_columns(np.zeros(3), np.ones((3, 2)), np.full((3, 1), 2.0), np.array([7.0, 8.0]))
    assert [np.shape(column) for column in columns] == [(3,), (3,), (3,), (3,), (), ()]


def test_one_number_serves_all_points():
    program = compile_program([parse("a*b"), parse("b")], ["a", "b", "unused"])
    found = at_points(program, [np.arange(200.0), np.array(3.0), np.array(np.nan)], None, 200)
    np.testing.assert_array_equal(found, [3 * np.arange(200.0), np.full(200, 3.0)])


def test_late_signals_are_asked_for():
    program = compile_program([parse("delay(a, 0.1) + a")], ["a"])
    assert at_points(program, [np.ones(2)], np.array([[5.0], [6.0]]), 2)[0].tolist() == [6.0, 7.0]
    with pytest.raises(SimulationError, match="signals must be given"):
        at_points(program, [np.ones(2)], None, 2)
