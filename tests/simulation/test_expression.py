"""The parser lets arithmetic through and nothing else; trees go to text and back."""

import math

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from gaitdisc.errors import SimulationError
from gaitdisc.simulation.expression import (
    DEEPEST,
    LARGEST,
    LONGEST,
    Name,
    Number,
    Operation,
    names,
    parse,
    substitute,
    written,
)


def test_precedence_is_that_of_python():
    assert parse("-x**2") == Operation("neg", (Operation("**", (Name("x"), Number(2.0))),))
    assert parse("a - b - c") == parse("(a - b) - c")
    assert parse("a**b**c") == parse("a**(b**c)")
    assert parse("+x") == Name("x")


def test_numbers_are_floats_and_keep_their_sign():
    assert parse("-2") == Number(-2.0)
    assert parse("1e-3") == Number(1e-3)
    assert parse("2**-1") == Operation("**", (Number(2.0), Number(-1.0)))


def test_a_line_break_is_a_blank():
    assert parse("a +\n  b") == parse("a + b")


@pytest.mark.parametrize(
    ("text", "words"),
    [
        ("x.__class__", "a dot after a name"),
        ("lambda", "column"),
        ("(lambda)", "column"),
        ("x if y else z", "Use step"),
        ("x and y", "Use products"),
        ("x < y", "Use step(b - a)"),
        ("x ^ 2", "Write powers as x**2"),
        ("x = 2", "right-hand side only"),
        ("x // 2", "Divide with /"),
        ("1, 2", "decimal point"),
        ("sine(x)", "Did you mean 'sin'?"),
        ("max(x)", "max with 1 arguments"),
        ("sin(x)(y)", "something other than a named function"),
        ("sin(*x)", "not arithmetic"),
        ("__import__(x)", "unknown function '__import__'"),
        ("True", "not a number"),
        ("1j", "not a number"),
        ("...", "not a number"),
        ("not x", "Not, which is not arithmetic"),
        ("(yield)", "not arithmetic"),
        ("(x for x in y)", "not arithmetic"),
        ("1e999", "1.8e308"),
        ("9" * 400, "1.8e308"),
        ("9" * 5000, "column"),
        ("х + 1", "'х'"),  # a Cyrillic letter
        ("ｘ + 1", "'ｘ'"),  # a full-width letter, which Python would take for x
        ("'x'", '"\'"'),
        ("x[0]", "'['"),
        ("x; y", "';'"),
        ("", "the text is empty"),
        ("   ", "the text is empty"),
        ("x +", "column"),
        ("(x", "column"),
        ("x)", "column"),
    ],
)
def test_anything_else_is_refused(text, words):
    with pytest.raises(SimulationError) as refusal:
        parse(text)
    assert words in str(refusal.value)


def test_the_column_is_told():
    with pytest.raises(SimulationError, match=r"column 9 .*'sine'"):
        parse("  tau + sine(x)")
    with pytest.raises(SimulationError, match=r"line 2, column 3 .*'\^'"):
        parse("tau +\nx ^ 2")


@pytest.mark.parametrize(
    "text",
    [
        "(" * 150 + "x" + ")" * 150,
        "(" * 5000 + "x" + ")" * 5000,
        "-" * 10_000 + "x",
        "+".join(["x"] * 5000),
        "x" * (LONGEST + 1),
        "x+" * 500_000 + "x",
        "sin(" * 4000 + "x" + ")" * 4000,
        "max(" + ",".join(["x"] * 5000) + ")",
        "2" + "**2" * 5000,
    ],
)
def test_a_hostile_text_is_refused_without_end(text):
    if text.count("(") == 150:  # many parentheses are harmless
        assert parse(text) == Name("x")
        return
    with pytest.raises(SimulationError):
        parse(text)


def test_a_power_of_powers_is_not_computed():
    tree = parse("9**9**9**9")
    assert list(names(tree)) == []
    assert isinstance(tree, Operation)


def test_limits_leave_room_for_a_long_sum():
    terms = min(DEEPEST, LARGEST // 2) - 10
    assert len(list(names(parse(" + ".join(["x"] * terms))))) == terms


@given(st.text(max_size=60))
def test_any_text_parses_or_is_refused(text):
    try:
        parse(text)
    except SimulationError as error:
        assert error.needed and error.found and error.remedy


@given(st.floats(allow_nan=False, allow_infinity=False))
def test_a_number_keeps_its_value(value):
    tree = parse(repr(value))
    assert isinstance(tree, Number)
    assert tree.value == value or (np.isclose(value, 0) and math.copysign(1, value) < 0)


@pytest.mark.parametrize(
    ("text", "found"), [("0x10*x", "0x10"), ("2*0b11", "0b11"), ("x + 1_000", "1_000"), ("\uff11*x", "\uff11")]
)
def test_numbers_are_decimal(text, found):
    with pytest.raises(SimulationError, match=rf"found '{found}'..*a decimal number"):
        parse(text)
    assert list(names(parse("x_1 + a0x1 + 1.5e-3"))) == ["x_1", "a0x1"]


leaves = st.one_of(
    st.floats(allow_nan=False, allow_infinity=False).map(Number), st.sampled_from(["x", "v", "k"]).map(Name)
)


def _larger(inner):
    pairs = st.tuples(inner, inner)
    return st.one_of(
        st.builds(Operation, st.sampled_from(["+", "-", "*", "/", "**", "max", "min"]), pairs),
        st.builds(lambda a: Number(-a.value) if isinstance(a, Number) else Operation("neg", (a,)), inner),
        st.builds(Operation, st.sampled_from(["sin", "tanh", "abs", "step"]), st.tuples(inner)),
    )


@given(st.recursive(leaves, _larger, max_leaves=25))
def test_what_is_written_parses_to_the_same(tree):
    assert parse(written(tree)) == tree


def test_no_more_parentheses_than_needed():
    for text in ("a - (b - c)", "a/(b*c)", "(a**b)**c", "a**b**c", "-a**2", "(-a)**2", "a*-2", "a - b*c", "-(a*b)"):
        assert written(parse(text)) == text


def test_an_input_takes_a_gain_everywhere():
    tree = substitute(parse("(tau - b*x)/m"), {"tau": parse("1.2*tau")}, ["tau", "x"])
    assert written(tree) == "(1.2*tau - b*x)/m"


def test_a_late_input_inside_a_delay_is_later():
    tree = substitute(parse("delay(tau, 0.1)"), {"tau": parse("delay(tau, d)")}, ["tau"])
    assert written(tree) == "delay(tau, d + 0.1)"


def test_a_delayed_expression_delays_signals_and_time_but_no_parameters():
    tree = substitute(parse("delay(tau, d)"), {"tau": parse("2*gain*tau*x*sin(t)")}, ["tau", "x"])
    assert written(tree) == "2*gain*delay(tau, d)*delay(x, d)*sin(t - d)"
