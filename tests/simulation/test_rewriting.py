"""Trees to text and back; names put in place of others."""

from hypothesis import given
from hypothesis import strategies as st

from gaitdisc.simulation.expression import Name, Number, Operation, parsed, substituted, written

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
    assert parsed(written(tree)) == tree


def test_no_more_parentheses_than_needed():
    for text in ("a - (b - c)", "a/(b*c)", "(a**b)**c", "a**b**c", "-a**2", "(-a)**2", "a*-2", "a - b*c", "-(a*b)"):
        assert written(parsed(text)) == text


def test_an_input_takes_a_gain_everywhere():
    tree = substituted(parsed("(tau - b*x)/m"), {"tau": parsed("1.2*tau")}, ["tau", "x"])
    assert written(tree) == "(1.2*tau - b*x)/m"


def test_a_late_input_inside_a_delay_is_later():
    tree = substituted(parsed("delay(tau, 0.1)"), {"tau": parsed("delay(tau, d)")}, ["tau"])
    assert written(tree) == "delay(tau, d + 0.1)"


def test_a_delayed_expression_delays_signals_and_time_but_no_parameters():
    tree = substituted(parsed("delay(tau, d)"), {"tau": parsed("2*gain*tau*x*sin(t)")}, ["tau", "x"])
    assert written(tree) == "2*gain*delay(tau, d)*delay(x, d)*sin(t - d)"
