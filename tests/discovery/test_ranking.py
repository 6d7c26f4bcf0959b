from dataclasses import replace

from gaitdisc.discovery.candidate import Candidate
from gaitdisc.discovery.candidate_model import Part
from gaitdisc.discovery.criteria import CRITERIA
from gaitdisc.discovery.scored_model import ScoredModel, ranked

SPRING = Candidate(
    "missing_physics", "port", "load", "one_sided_spring", ("max(0, x - _x0)",), {"x0": "quantiles of x"}, "x"
)
DAMPER = Candidate("missing_physics", "port", "load", "viscous_damping", ("v",), None, "x")
NUMBER = Candidate("wrong_parameter", "parameter", "c", "wrong_parameter")
SENSOR = Candidate("sensor_error", "observation", "x", "sensor_gain")
OPEN = (SPRING, DAMPER, NUMBER, SENSOR)


def _judged(as_read, candidate, bic, size):
    """A model of a given evidence, by a residual that has it."""
    fit = replace(as_read.model.fit, free=tuple("abcdef"[:size]))
    one = ScoredModel(replace(as_read.model, fit=fit, parts=(Part(candidate, {}),)), as_read.shooting)
    scale = ((bic - (one.model.bic - fit.misfit)) / fit.misfit) ** 0.5
    return replace(one, model=replace(one.model, fit=replace(fit, white=fit.white * scale)))


def test_the_better_explanation_stands_first(as_read):
    better, worse = _judged(as_read, DAMPER, 5e3, 1), _judged(as_read, SPRING, 6e3, 1)
    assert ranked([worse, better], OPEN) == [better, worse]


def test_a_simpler_statement_stands_before_one_that_is_hardly_better(as_read):
    simple, wordy = _judged(as_read, DAMPER, 5e3 + CRITERIA.margin / 2, 1), _judged(as_read, SPRING, 5e3, 2)
    assert ranked([wordy, simple], OPEN)[0] is simple
    far = _judged(as_read, DAMPER, 5e3 + 2 * CRITERIA.margin, 1)
    assert ranked([wordy, far], OPEN)[0] is wordy


def test_of_equals_a_wrong_number_stands_first_and_a_missing_term_whose_kind_has_most_members_last(as_read):
    three = [_judged(as_read, one, 5e3 + i / 10, 1) for i, one in enumerate((DAMPER, SENSOR, NUMBER))]
    assert ranked(three, OPEN) == three[::-1]


def test_accounts_that_failed_are_not_ranked(as_read):
    failed = replace(as_read.model.fit, white=as_read.model.fit.white * float("inf"))
    assert ranked([replace(as_read, model=replace(as_read.model, fit=failed))], OPEN) == []


def test_accounts_that_are_all_hopeless_are_ranked_as_well(as_read):
    hopeless = [_judged(as_read, one, 1e20, 1) for one in (DAMPER, SPRING)]
    assert len(ranked(hopeless, OPEN)) == 2
