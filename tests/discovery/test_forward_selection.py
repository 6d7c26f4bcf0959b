import pytest
from hidden_in_a_mass import DAMPER, Experiment, mass, record, with_load

from gaitdisc.discovery.candidate import Candidate
from gaitdisc.discovery.case import set_up_case
from gaitdisc.discovery.criteria import CRITERIA
from gaitdisc.discovery.forward_selection import beside_others, exchange, prune, select_forward, settle
from gaitdisc.discovery.scored_model import Part, ranked


def test_what_is_hidden_is_let_in_alone(named):
    now, rivals = named
    assert now.labels == ("cubic_stiffness@load",)
    assert rivals[0].labels == now.labels
    assert all(one.labels != now.labels for one in rivals[1:])
    assert now.gained > 100


def _with(case, as_read, *parts):
    return as_read.refitted(as_read.shooting, parts)


def _idle_and_true(case, as_read, cubic):
    return _with(case, as_read, Part(cubic, {"factor": -14.0}), Part(DAMPER, {"factor": 0.0}))


def _wrong_and_idle(case, as_read):
    quadratic = Candidate("missing_physics", "port", "load", "quadratic_stiffness", ("x**2",), None, "x")
    return _with(case, as_read, Part(quadratic, {"factor": 0.0}), Part(DAMPER, {"factor": 0.0}))


def test_an_explanation_that_earns_nothing_is_thrown_out(case, as_read, cubic):
    assert prune(case.search, _idle_and_true(case, as_read, cubic), CRITERIA.margin).labels == ("cubic_stiffness@load",)


def test_a_wrong_explanation_is_exchanged_for_the_true_one_and_what_is_settled_holds_it_alone(case, as_read):
    now = settle(case.search, _wrong_and_idle(case, as_read), CRITERIA.margin, set())
    assert now.labels == ("cubic_stiffness@load",)


def test_beside_what_was_explored_already_nothing_is_sought_again(case, as_read):
    now = _wrong_and_idle(case, as_read)
    explored = {case.search.without(now, number).explanations for number in range(2)}
    assert len(explored) == 2
    assert exchange(case.search, now, explored) is now


@pytest.fixture(scope="module")
def two():
    """Return a case into two springs, and the simulation as read."""
    case = set_up_case(mass(), record(with_load("-14*x**3 - 9*x**2"), 3, Experiment(seconds=8.0)))
    return case, case.as_read()


@pytest.mark.slow
def test_two_effects_are_both_found_with_their_numbers(two):
    case, as_read = two
    now, _ = select_forward(case.search, as_read, 3)
    assert sorted(now.labels) == ["cubic_stiffness@load", "quadratic_stiffness@load"]
    values = {part.candidate.name: part.values["factor"] for part in now.parts}
    assert values == pytest.approx({"cubic_stiffness": -14.0, "quadratic_stiffness": -9.0}, rel=0.05)


def test_a_pair_whose_first_was_not_the_best_alone_is_found_beside_it(two):
    case, as_read = two
    wrong = _wrong_and_idle(case, as_read)
    firsts = ranked(case.search.extended(as_read)[1:], case.search.candidates)
    cubic = [one for one in firsts if one.labels == ("cubic_stiffness@load",)]
    explored = set()
    pair = beside_others(case.search, wrong, [*cubic, *cubic], explored)
    assert sorted(pair.labels) == ["cubic_stiffness@load", "quadratic_stiffness@load"]
    assert explored == {cubic[0].explanations}


@pytest.mark.slow
@pytest.mark.parametrize(("small", "also"), [(3.0, ("quadratic_stiffness@load",)), (0.5, ())])
def test_what_explains_less_than_a_fiftieth_of_what_was_explained_is_not_added(small, also):
    case = set_up_case(mass(), record(with_load(f"-14*x**3 - {small}*x**2"), 3, Experiment(seconds=12.0)))
    assert select_forward(case.search, case.as_read(), 3)[0].labels == ("cubic_stiffness@load", *also)
