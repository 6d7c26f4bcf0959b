from dataclasses import replace

import pytest

from gaitdisc.discovery.account import Part, account_for
from gaitdisc.discovery.candidate import Candidate
from gaitdisc.discovery.evidence import Judged
from gaitdisc.discovery.search import MARGIN, ranked

SPRING = Candidate(
    "missing_physics", "port", "load", "one_sided_spring", ("max(0, x - _x0)",), {"x0": "quantiles of x"}, "x"
)
SLACK = Candidate("missing_physics", "port", "load", "slack", ("max(0, x - _d)",), {"d": "half widths of x"}, "x")
LATE = Candidate("missing_physics", "port", "load", "late", ("delay(x, _d)",), {"d": "delays"}, "x")
DELAY = Candidate("input_error", "input", "push", "input_delay")
DAMPER = Candidate("missing_physics", "port", "load", "viscous_damping", ("v",), None, "x")


def _with(account, candidate, **values):
    return replace(account, parts=(Part(candidate, values),))


def test_what_is_hidden_is_let_in_alone(named):
    now, rivals = named
    assert now.labels == ("cubic_stiffness@load",)
    assert rivals[0].labels == now.labels
    assert all(one.labels != now.labels for one in rivals[1:])
    assert now.gained > 100


@pytest.mark.parametrize(
    ("candidate", "values", "sensible"),
    [
        (SPRING, {"factor": -9.0, "x0": 0.1}, True),
        (SPRING, {"factor": -9.0, "x0": 40.0}, False),
        (SPRING, {"factor": -9.0, "x0": -40.0}, False),
        (SLACK, {"factor": -9.0, "d": 0.2}, True),
        (SLACK, {"factor": -9.0, "d": -0.2}, False),
        (LATE, {"factor": -9.0, "d": 0.05}, True),
        (LATE, {"factor": -9.0, "d": -0.05}, False),
        (LATE, {"factor": -9.0, "d": 99.0}, False),
        (DELAY, {"seconds": 0.1}, True),
        (DELAY, {"seconds": -0.1}, False),
    ],
)
def test_a_number_has_to_lie_where_it_means_what_its_name_says(inquiry, as_read, candidate, values, sensible):
    assert inquiry.search.sensible(_with(as_read.account, candidate, **values)) is sensible


def test_a_fit_that_failed_is_not_sensible(inquiry, as_read):
    failed = replace(as_read.account.fit, white=as_read.account.fit.white * float("inf"))
    assert not inquiry.search.sensible(replace(as_read.account, fit=failed))


def _both(inquiry, as_read, cubic):
    parts = (Part(cubic, {"factor": -14.0}), Part(DAMPER, {"factor": 0.0}))
    return Judged(
        account_for(as_read.shooting, inquiry.search.base, parts, as_read.account.fit.starts), as_read.shooting
    )


def test_less_one_explanation_the_others_stay(inquiry, as_read, cubic):
    both = _both(inquiry, as_read, cubic)
    assert inquiry.search.without(both, 0).labels == ("viscous_damping@load",)
    assert inquiry.search.without(both, 1).labels == ("cubic_stiffness@load",)


def test_an_explanation_that_earns_nothing_is_thrown_out(inquiry, as_read, cubic):
    pruned = inquiry.search.pruned(_both(inquiry, as_read, cubic), MARGIN)
    assert pruned.labels == ("cubic_stiffness@load",)


def test_a_wrong_explanation_is_exchanged_for_the_true_one(inquiry, as_read):
    quadratic = Candidate("missing_physics", "port", "load", "quadratic_stiffness", ("x**2",), None, "x")
    parts = (Part(quadratic, {"factor": 0.0}), Part(DAMPER, {"factor": 0.0}))
    wrong = Judged(
        account_for(as_read.shooting, inquiry.search.base, parts, as_read.account.fit.starts), as_read.shooting
    )
    assert "cubic_stiffness@load" in inquiry.search.exchanged(wrong).labels


def _judged(as_read, candidate, evidence, size):
    """An account of a given evidence, by a residual that has it."""
    fit = replace(as_read.account.fit, free=tuple("abcdef"[:size]))
    one = Judged(replace(as_read.account, fit=fit, parts=(Part(candidate, {}),)), as_read.shooting)
    scale = ((evidence - (one.account.criterion - fit.misfit)) / fit.misfit) ** 0.5
    return replace(one, account=replace(one.account, fit=replace(fit, white=fit.white * scale)))


def test_the_better_explanation_stands_first(as_read):
    better, worse = _judged(as_read, DAMPER, 5e3, 1), _judged(as_read, SPRING, 6e3, 1)
    assert ranked([worse, better]) == [better, worse]


def test_a_simpler_statement_stands_before_one_that_is_hardly_better(as_read):
    simple, wordy = _judged(as_read, DAMPER, 5e3 + MARGIN / 2, 1), _judged(as_read, SPRING, 5e3, 2)
    assert ranked([wordy, simple])[0] is simple
    far = _judged(as_read, DAMPER, 5e3 + 2 * MARGIN, 1)
    assert ranked([wordy, far])[0] is wordy


def test_of_equals_a_wrong_number_stands_before_a_missing_term_and_a_sensor_last(as_read):
    number = Candidate("wrong_parameter", "parameter", "c", "wrong_parameter")
    sensor = Candidate("sensor_error", "observation", "x", "sensor_gain")
    three = [_judged(as_read, one, 5e3 + i / 10, 1) for i, one in enumerate((sensor, DAMPER, number))]
    assert ranked(three) == three[::-1]


def test_accounts_that_failed_are_not_ranked(as_read):
    failed = replace(as_read.account.fit, white=as_read.account.fit.white * float("inf"))
    assert ranked([replace(as_read, account=replace(as_read.account, fit=failed))]) == []


def test_accounts_that_are_all_hopeless_are_ranked_as_well(as_read):
    hopeless = [_judged(as_read, one, 1e20, 1) for one in (DAMPER, SPRING)]
    assert len(ranked(hopeless)) == 2
