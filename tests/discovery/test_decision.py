from __future__ import annotations

from dataclasses import replace
from types import SimpleNamespace

import pytest

from gaitdisc.discovery import decision
from gaitdisc.discovery.account import Part, account_for
from gaitdisc.discovery.decision import judge, lasting, needed, strongest
from gaitdisc.discovery.evidence import Judged, judged


def test_what_longer_runs_have_no_use_for_is_not_named(inquiry, as_read, cubic):
    shooting = inquiry.shooting(inquiry.segments(inquiry.learned, 0.4)).with_noise(as_read.noise)
    starts = inquiry.guess.starts(shooting.segments)
    damper = next(one for one in inquiry.search.candidates if one.label == "viscous_damping@load")
    read, both = (
        judged(shooting, inquiry.search.base, account_for(shooting, inquiry.search.base, parts, starts))
        for parts in ((), (Part(cubic, {"factor": -14.0}), Part(damper, {"factor": 0.0})))
    )
    assert not inquiry.is_tame(read)
    assert lasting(inquiry, read, both).labels == ("cubic_stiffness@load",)
    assert lasting(inquiry, read, both).shooting.segments is shooting.segments
    assert lasting(inquiry, as_read, both) is both


def _with(inquiry, as_read, parts):
    account = account_for(as_read.shooting, inquiry.search.base, parts, as_read.account.fit.starts)
    return judged(as_read.shooting, inquiry.search.base, account)


def test_what_the_held_out_data_do_not_bear_out_beside_another_is_left_out(inquiry, as_read, cubic):
    idle = next(one for one in inquiry.search.candidates if one.label == "viscous_damping@load")
    both = _with(inquiry, as_read, (Part(cubic, {"factor": -14.0}), Part(idle, {"factor": 0.0})))
    assert needed(inquiry, as_read, both).labels == ("cubic_stiffness@load",)
    alone = _with(inquiry, as_read, (Part(cubic, {"factor": -14.0}),))
    assert needed(inquiry, as_read, alone) is alone


def test_of_three_names_the_one_that_is_missed_least_goes(inquiry, as_read, cubic):
    others = [
        next(one for one in inquiry.search.candidates if one.label == label)
        for label in ("viscous_damping@load", "sensor_drift@x")
    ]
    parts = (Part(cubic, {"factor": -14.0}), *(Part(one, dict.fromkeys(one.slots, 0.0)) for one in others))
    kept = strongest(inquiry.search, _with(inquiry, as_read, parts))
    assert len(kept.account.parts) == 2
    assert "cubic_stiffness@load" in kept.labels


def test_a_shape_that_the_held_out_data_do_not_bear_out_is_not_handed_out(inquiry, as_read, cubic, monkeypatch):
    idle = next(one for one in inquiry.search.candidates if one.label == "viscous_damping@load")
    both = _with(inquiry, as_read, (Part(cubic, {"factor": -14.0}), Part(idle, {"factor": 0.0})))
    wrong = replace(cubic, name="unnamed")
    bad = account_for(
        as_read.shooting, inquiry.search.base, (Part(wrong, {"factor": 2.0}),), as_read.account.fit.starts, 0
    )
    shape = Judged(bad, as_read.shooting)
    for name, value in (
        ("searched", lambda *_: (as_read, both, [])),
        ("fitted_shape", lambda *_: shape),
        ("says_more", lambda *_: True),
        ("weighed_with_memory", lambda *_: None),
    ):
        monkeypatch.setattr(f"gaitdisc.discovery.decision.{name}", value)
    verdict = judge(inquiry, as_read)
    assert (verdict.word, verdict.account.labels) == ("missing_physics", ("cubic_stiffness@load",))
    assert verdict.proof.test.p < 0.05


@pytest.mark.parametrize(("half", "word"), [(0.5, "missing_physics"), (1.1, "no_gap")])
def test_of_more_names_than_are_named_two_have_to_take_half_of_the_error(
    inquiry, as_read, cubic, monkeypatch, half, word
):
    others = [
        next(one for one in inquiry.search.candidates if one.label == label)
        for label in ("viscous_damping@load", "sensor_drift@x")
    ]
    parts = (Part(cubic, {"factor": -14.0}), *(Part(one, dict.fromkeys(one.slots, 0.0)) for one in others))
    three = _with(inquiry, as_read, parts)
    monkeypatch.setattr("gaitdisc.discovery.decision.searched", lambda *_: (as_read, three, []))
    monkeypatch.setattr("gaitdisc.discovery.decision.fitted_shape", lambda *_: None)
    monkeypatch.setattr("gaitdisc.discovery.decision.HALF", half)
    monkeypatch.setattr("gaitdisc.discovery.decision.leaves_noise", lambda *_: False)
    monkeypatch.setattr("gaitdisc.discovery.decision.plainest", lambda *_: None)
    verdict = judge(inquiry, as_read)
    assert verdict.word == word
    assert verdict.proof.test.p < 0.05
    assert 0.5 < verdict.proof.closed <= 1.0


def test_one_shape_that_leaves_mere_noise_stands_before_names_that_do_not(inquiry, as_read, monkeypatch):
    names = SimpleNamespace(account=SimpleNamespace(account=SimpleNamespace(parts=(1, 2))), rivals=("rival",))
    alone = SimpleNamespace(account=SimpleNamespace(account=SimpleNamespace(parts=(1,))), rivals=())
    proofs = iter([True, False])
    monkeypatch.setattr(decision, "fitted_shape", lambda *_: "shape")
    monkeypatch.setattr(decision, "leaves_noise", lambda _, one: one == "shape")
    monkeypatch.setattr(decision, "borne_out", lambda *_: SimpleNamespace(bears_out=next(proofs)))
    found = decision.shape_that_leaves_noise(inquiry, as_read, None, names)
    assert (found.word, found.account, found.rivals) == ("unnamed", "shape", (names.account, "rival"))
    assert decision.shape_that_leaves_noise(inquiry, as_read, None, names) is None  # not borne out
    assert decision.shape_that_leaves_noise(inquiry, as_read, None, alone) is None
    monkeypatch.setattr(decision, "leaves_noise", lambda *_: False)
    assert decision.shape_that_leaves_noise(inquiry, as_read, None, names) is None
