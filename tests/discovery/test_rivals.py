"""Rivals of an answer on a mass whose missing cubic spring is known."""

from dataclasses import replace

import pytest

from gaitdisc.discovery.answer import bic_gain, rivals_of
from gaitdisc.discovery.candidate_model import Part, fit_model
from gaitdisc.discovery.criteria import CRITERIA
from gaitdisc.discovery.scored_model import scored


@pytest.fixture(scope="module")
def shape(case, as_read, cubic):
    """Return an answer without a name that is the truth: no effect of the catalogue but one comes near it."""
    part = Part(replace(cubic, name="unnamed"), {"factor": -14.0})
    model = fit_model(as_read.shooting, case.search.base, (part,), as_read.model.fit.starts)
    return scored(as_read.shooting, case.search.base, model)


def test_the_evidence_of_an_answer_is_its_own(case, shape):
    before = fit_model(shape.shooting, case.search.base, (), shape.model.fit.starts, 15)
    assert bic_gain(case.search, shape) == pytest.approx(before.bic - shape.bic)


def test_an_answer_of_nothing_has_no_evidence(case, as_read):
    assert bic_gain(case.search, as_read) == 0.0


def test_the_best_rival_is_compared_with_the_answer_and_not_with_itself(case, shape, named):
    gained = bic_gain(case.search, shape)
    found = tuple(one for one in named[1] if one.labels != ("cubic_stiffness@load",))
    assert found
    rivals = rivals_of(case.search, shape, found, gained)
    assert rivals
    assert not any(one.tied for one in rivals)
    assert all(one.gained < gained - CRITERIA.tie for one in rivals)


def test_a_rival_that_explains_as_much_is_tied(case, shape, named):
    gained = bic_gain(case.search, shape)
    first = rivals_of(case.search, shape, tuple(named[1]), gained)[0]
    assert first.scored.labels == ("cubic_stiffness@load",)
    assert first.tied
    assert first.gained == pytest.approx(gained, abs=0.5)


def test_one_that_is_in_the_answer_is_no_rival(case, named):
    now, found = named
    rivals = rivals_of(case.search, now, tuple(found), bic_gain(case.search, now))
    assert "cubic_stiffness@load" not in [one.scored.labels[-1] for one in rivals]


def test_beside_one_of_two_a_rival_stands_in_the_place_of_the_other(case, as_read, cubic, named):
    drift = next(one for one in case.search.candidates if one.label == "sensor_drift@x")
    parts = (Part(cubic, {"factor": -14.0}), Part(drift, {"rate": 0.0}))
    model = fit_model(as_read.shooting, case.search.base, parts, as_read.model.fit.starts)
    both = scored(as_read.shooting, case.search.base, model)
    offset = next(one for one in case.search.candidates if one.label == "sensor_offset@x")
    other = fit_model(as_read.shooting, case.search.base, (Part(offset, {"offset": 0.0}),), as_read.model.fit.starts)
    (rival,) = rivals_of(case.search, both, (replace(both, model=other),), 0.0)
    assert rival.scored.labels == ("cubic_stiffness@load", "sensor_offset@x")
    assert rival.tied


def test_where_nothing_is_named_rivals_keep_what_they_were_found_with(case, as_read, named):
    rivals = rivals_of(case.search, as_read, tuple(named[1]), 0.0)
    assert [one.gained for one in rivals] == [one.gained for one in named[1]][: len(rivals)]
    assert not any(one.tied for one in rivals)
