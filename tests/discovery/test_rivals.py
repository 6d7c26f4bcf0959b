"""Rivals of an answer on a mass whose missing cubic spring is known."""

from dataclasses import replace

import pytest

from gaitdisc.discovery.account import Part, account_for
from gaitdisc.discovery.evidence import judged
from gaitdisc.discovery.rivals import TIE, evidence_of, rivals_of


@pytest.fixture(scope="module")
def shape(inquiry, as_read, cubic):
    """Return an answer without a name that is the truth: no effect of the catalogue but one comes near it."""
    part = Part(replace(cubic, name="unnamed"), {"factor": -14.0})
    account = account_for(as_read.shooting, inquiry.search.base, (part,), as_read.account.fit.starts)
    return judged(as_read.shooting, inquiry.search.base, account)


def test_the_evidence_of_an_answer_is_its_own(inquiry, shape):
    before = account_for(shape.shooting, inquiry.search.base, (), shape.account.fit.starts, 15)
    assert evidence_of(inquiry.search, shape) == pytest.approx(before.criterion - shape.evidence)


def test_an_answer_of_nothing_has_no_evidence(inquiry, as_read):
    assert evidence_of(inquiry.search, as_read) == 0.0


def test_the_best_rival_is_compared_with_the_answer_and_not_with_itself(inquiry, shape, named):
    gained = evidence_of(inquiry.search, shape)
    found = tuple(one for one in named[1] if one.labels != ("cubic_stiffness@load",))
    assert found
    rivals = rivals_of(inquiry.search, shape, found, gained)
    assert rivals
    assert not any(one.tied for one in rivals)
    assert all(one.gained < gained - TIE for one in rivals)


def test_a_rival_that_explains_as_much_is_tied(inquiry, shape, named):
    gained = evidence_of(inquiry.search, shape)
    first = rivals_of(inquiry.search, shape, tuple(named[1]), gained)[0]
    assert first.account.labels == ("cubic_stiffness@load",)
    assert first.tied
    assert first.gained == pytest.approx(gained, abs=0.5)


def test_one_that_is_in_the_answer_is_no_rival(inquiry, named):
    now, found = named
    rivals = rivals_of(inquiry.search, now, tuple(found), evidence_of(inquiry.search, now))
    assert "cubic_stiffness@load" not in [one.account.labels[-1] for one in rivals]


def test_beside_one_of_two_a_rival_stands_in_the_place_of_the_other(inquiry, as_read, cubic, named):
    drift = next(one for one in inquiry.search.candidates if one.label == "sensor_drift@x")
    parts = (Part(cubic, {"factor": -14.0}), Part(drift, {"rate": 0.0}))
    account = account_for(as_read.shooting, inquiry.search.base, parts, as_read.account.fit.starts)
    both = judged(as_read.shooting, inquiry.search.base, account)
    offset = next(one for one in inquiry.search.candidates if one.label == "sensor_offset@x")
    other = account_for(
        as_read.shooting, inquiry.search.base, (Part(offset, {"offset": 0.0}),), as_read.account.fit.starts
    )
    (rival,) = rivals_of(inquiry.search, both, (replace(both, account=other),), 0.0)
    assert rival.account.labels == ("cubic_stiffness@load", "sensor_offset@x")
    assert rival.tied


def test_where_nothing_is_named_rivals_keep_what_they_were_found_with(inquiry, as_read, named):
    rivals = rivals_of(inquiry.search, as_read, tuple(named[1]), 0.0)
    assert [one.gained for one in rivals] == [one.gained for one in named[1]][: len(rivals)]
    assert not any(one.tied for one in rivals)
