import pytest
from hidden_in_a_mass import Experiment, mass, record, with_load

from gaitdisc.discovery.account import Part, account_for
from gaitdisc.discovery.candidate import Candidate
from gaitdisc.discovery.evidence import Judged
from gaitdisc.discovery.growth import beside_others, exchanged, grown, pruned, settled
from gaitdisc.discovery.inquiry import begin_inquiry
from gaitdisc.discovery.ranking import MARGIN, ranked

DAMPER = Candidate("missing_physics", "port", "load", "viscous_damping", ("v",), None, "x")


def test_what_is_hidden_is_let_in_alone(named):
    now, rivals = named
    assert now.labels == ("cubic_stiffness@load",)
    assert rivals[0].labels == now.labels
    assert all(one.labels != now.labels for one in rivals[1:])
    assert now.gained > 100


def _with(inquiry, as_read, *parts):
    return Judged(
        account_for(as_read.shooting, inquiry.search.base, parts, as_read.account.fit.starts), as_read.shooting
    )


def _idle_and_true(inquiry, as_read, cubic):
    return _with(inquiry, as_read, Part(cubic, {"factor": -14.0}), Part(DAMPER, {"factor": 0.0}))


def _wrong_and_idle(inquiry, as_read):
    quadratic = Candidate("missing_physics", "port", "load", "quadratic_stiffness", ("x**2",), None, "x")
    return _with(inquiry, as_read, Part(quadratic, {"factor": 0.0}), Part(DAMPER, {"factor": 0.0}))


def test_an_explanation_that_earns_nothing_is_thrown_out(inquiry, as_read, cubic):
    assert pruned(inquiry.search, _idle_and_true(inquiry, as_read, cubic), MARGIN).labels == ("cubic_stiffness@load",)


def test_a_wrong_explanation_is_exchanged_for_the_true_one(inquiry, as_read):
    assert "cubic_stiffness@load" in exchanged(inquiry.search, _wrong_and_idle(inquiry, as_read), set()).labels


def test_what_is_settled_holds_the_true_one_alone(inquiry, as_read):
    now = settled(inquiry.search, _wrong_and_idle(inquiry, as_read), MARGIN, set())
    assert now.labels == ("cubic_stiffness@load",)


def test_beside_what_was_explored_already_nothing_is_sought_again(inquiry, as_read):
    now = _wrong_and_idle(inquiry, as_read)
    explored = {inquiry.search.without(now, number).account.explanations for number in range(2)}
    assert len(explored) == 2
    assert exchanged(inquiry.search, now, explored) is now


@pytest.fixture(scope="module")
def two():
    """Return an inquiry into two springs, and the simulation as read."""
    inquiry = begin_inquiry(mass(), record(with_load("-14*x**3 - 9*x**2"), 3, Experiment(seconds=12.0)))
    return inquiry, inquiry.as_read()


def test_two_effects_are_both_found_with_their_numbers(two):
    inquiry, as_read = two
    now, _ = grown(inquiry.search, as_read, 3)
    assert sorted(now.labels) == ["cubic_stiffness@load", "quadratic_stiffness@load"]
    values = {part.candidate.name: part.values["factor"] for part in now.account.parts}
    assert values == pytest.approx({"cubic_stiffness": -14.0, "quadratic_stiffness": -9.0}, rel=0.05)


def test_a_pair_whose_first_was_not_the_best_alone_is_found_beside_it(two):
    inquiry, as_read = two
    wrong = _wrong_and_idle(inquiry, as_read)
    firsts = ranked(inquiry.search.extended(as_read)[1:], inquiry.search.candidates)
    cubic = [one for one in firsts if one.labels == ("cubic_stiffness@load",)]
    explored = set()
    pair = beside_others(inquiry.search, wrong, [*cubic, *cubic], explored)
    assert sorted(pair.labels) == ["cubic_stiffness@load", "quadratic_stiffness@load"]
    assert explored == {cubic[0].account.explanations}
