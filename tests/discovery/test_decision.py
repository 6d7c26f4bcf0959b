from __future__ import annotations

from dataclasses import replace
from types import SimpleNamespace

import numpy as np
import pytest
from hidden_in_a_mass import Experiment, mass, record

from gaitdisc.discovery import decision
from gaitdisc.discovery.beam import Outcome
from gaitdisc.discovery.case import Case, set_up_case
from gaitdisc.discovery.criteria import CRITERIA
from gaitdisc.discovery.decision import (
    Verdict,
    decide,
    keep_on_longer_runs,
    keep_useful,
    prefer_on_held_out,
    prove_held_out,
)
from gaitdisc.discovery.fitted import Prior
from gaitdisc.discovery.forward_selection import prune
from gaitdisc.discovery.paired_test import PairedTest
from gaitdisc.discovery.scored_model import Part, fit_model, score
from gaitdisc.discovery.search import is_certain
from gaitdisc.discovery.second_look import prefer_relatives
from gaitdisc.simulation.simulation import Term


def test_what_longer_runs_have_no_use_for_is_not_named(case, as_read, cubic, labelled):
    shooting = case.shooting(case.segments(case.learned, 0.4)).with_noise(as_read.noise)
    starts = shooting.segments.starts(case.guess)
    read, both = (
        score(fit_model(shooting, case.search.base, parts, starts))
        for parts in ((), (Part(cubic, {"factor": -14.0}), Part(labelled["viscous_damping@load"], {"factor": 0.0})))
    )
    assert not case.spans_a_period(read)
    assert keep_on_longer_runs(case, read, both).labels == ("cubic_stiffness@load",)
    assert keep_on_longer_runs(case, read, both).shooting.segments is shooting.segments
    assert keep_on_longer_runs(case, as_read, both) is both


@pytest.fixture(scope="module")
def beside(as_read, cubic, labelled):
    """Return the cubic spring beside explanations that are idle."""

    def fit(*idle):
        parts = (Part(labelled[one], dict.fromkeys(labelled[one].slots, 0.0)) for one in idle)
        model = as_read.refitted(as_read.shooting, (Part(cubic, {"factor": -14.0}), *parts))
        return score(model)

    return fit


def test_what_the_held_out_data_do_not_bear_out_beside_another_is_left_out(case, as_read, beside):
    assert keep_useful(case, as_read, beside("viscous_damping@load")).labels == ("cubic_stiffness@load",)
    alone = beside()
    assert keep_useful(case, as_read, alone) is alone


def test_held_out_data_prefer_two_plain_effects_to_one_of_more_numbers_that_imitates(case, as_read, beside, labelled):
    imitates = Part(labelled["periodic_forcing@load"], {"factor": 1.0, "factor_1": 1.0, "w": 3.0})
    one = score(as_read.refitted(as_read.shooting, (imitates,)))
    true, two = beside(), beside("viscous_damping@load")
    assert one.size > two.size > true.size
    assert prefer_on_held_out(case, one, (two,)) is two
    assert prefer_on_held_out(case, one, (two, true)) is true  # the plainest of what is preferred
    assert prefer_on_held_out(case, true, (one, two)) is true  # more numbers are none of its equals
    assert prefer_on_held_out(case, two, (true,)) is two  # not beyond chance


def test_of_three_names_the_one_that_is_missed_least_goes(case, beside):
    kept = prune(case.search, beside("viscous_damping@load", "sensor_drift@x"), float("inf"), 2)
    assert len(kept.parts) == 2
    assert "cubic_stiffness@load" in kept.labels


def test_a_shape_that_the_held_out_data_do_not_bear_out_is_not_handed_out(case, as_read, cubic, beside, monkeypatch):
    both = beside("viscous_damping@load")
    wrong = replace(cubic, name="unnamed")
    shape = as_read.refitted(as_read.shooting, (Part(wrong, {"factor": 2.0}),), turns=0)
    for name, value in (
        ("search_runs", lambda *_: (as_read, both, [])),
        ("fit_shape", lambda *_: shape),
        ("says_more", lambda *_: True),
        ("with_autocorrelation", lambda *_: None),
    ):
        monkeypatch.setattr(f"gaitdisc.discovery.decision.{name}", value)
    verdict = decide(case, as_read)
    assert (verdict.word, verdict.found.labels) == ("missing_physics", ("cubic_stiffness@load",))
    assert verdict.proof.test.p < 0.05


def test_a_shape_that_is_no_likelier_than_a_name_is_none_either_way(case, as_read, cubic, beside, monkeypatch):
    likelier, unnamed = beside("viscous_damping@load"), Part(replace(cubic, name="unnamed"), {"factor": -14.0})
    shape = score(as_read.refitted(as_read.shooting, (unnamed,)))
    borne = {likelier.labels: True, shape.labels: True}
    monkeypatch.setattr(decision, "prove_held_out", lambda *of: SimpleNamespace(bears_out=borne[of[-1].labels]))
    monkeypatch.setattr(decision, "with_random_pushes", lambda *_: "pushes")
    both = case, as_read, likelier, shape, []
    assert decision.with_autocorrelation(*both) is None
    borne[likelier.labels] = False  # with a shape in place of such a name, three records without a gap got one
    assert decision.with_autocorrelation(*both) is None
    borne[shape.labels] = False
    assert decision.with_autocorrelation(*both) == "pushes"


@pytest.mark.parametrize(("half", "word"), [(0.5, "missing_physics"), (1.1, "no_gap")])
def test_of_more_names_than_are_named_two_take_half_of_the_error(case, as_read, beside, monkeypatch, half, word):
    three = beside("viscous_damping@load", "sensor_drift@x")
    monkeypatch.setattr("gaitdisc.discovery.decision.search_runs", lambda *_: (as_read, three, []))
    monkeypatch.setattr("gaitdisc.discovery.decision.fit_shape", lambda *_: None)
    monkeypatch.setattr("gaitdisc.discovery.decision.CRITERIA", replace(CRITERIA, half=half))
    monkeypatch.setattr(Case, "leaves_noise", lambda *_: False)
    for name in ("plainest", "with_random_pushes"):
        monkeypatch.setattr(f"gaitdisc.discovery.decision.{name}", lambda *_: None)
    verdict = decide(case, as_read)
    assert verdict.word == word
    assert verdict.proof.test.p < 0.05
    assert 0.5 < verdict.proof.closed <= 1.0


def test_one_shape_that_leaves_mere_noise_stands_before_names_that_do_not(case, as_read, monkeypatch):
    two, one = (SimpleNamespace(parts=(None,) * count) for count in (2, 1))
    shape = SimpleNamespace(parts=(None,), word="unnamed")
    names = SimpleNamespace(found=two, rivals=("rival",))
    proofs, errors = iter([True, True, False, True, False]), {"shape": 0.1}
    monkeypatch.setattr(decision, "free_run_error", lambda _, now: errors["shape"] if now is shape else 0.2)
    monkeypatch.setattr(Case, "leaves_noise", lambda _, now: now in (shape, one))
    monkeypatch.setattr(decision, "prove_held_out", lambda *_: SimpleNamespace(bears_out=next(proofs)))
    found = decision.shape_that_leaves_noise(case, as_read, shape, names)
    assert (found.word, found.found, found.rivals) == ("unnamed", shape, (names.found, "rival"))
    assert decision.shape_that_leaves_noise(case, as_read, shape, names) is None  # not preferred to names
    assert decision.shape_that_leaves_noise(case, as_read, shape, names) is None  # not borne out
    assert decision.shape_that_leaves_noise(case, as_read, shape, SimpleNamespace(found=one)) is None  # leaves noise
    errors["shape"] = 0.3
    assert decision.shape_that_leaves_noise(case, as_read, shape, names) is None
    monkeypatch.setattr(Case, "leaves_noise", lambda *_: False)
    assert decision.shape_that_leaves_noise(case, as_read, shape, names) is None


def test_a_name_stands_though_a_number_of_the_file_may_be_anything_beside_it(case, as_read, named, monkeypatch):
    now, _ = named
    fit, k = now.fit, now.machine.parameters.index("k")
    alike = fit.slopes[..., -1:] * (1 + 1e-4 * np.random.default_rng(0).normal(size=(*fit.white.shape, 1)))
    prior = Prior(("k",), np.array([k]), *(fit.values[[k]] + width for width in (0.0, -1e9, 1e9)))
    loose = replace(fit, free=(*fit.free, "k"), slopes=np.concatenate([fit.slopes, alike], axis=2), prior=prior)
    lost = replace(now, fit=loose)
    assert not is_certain(lost)
    likelier = [SimpleNamespace(bic=bic) for bic in (100.0, 0.0)]
    for name, value in (
        ("closing_most", Outcome(as_read, lost, 0.9, PairedTest(0.01, 9, 5.0), (), (), ())),
        ("keep_useful", lost),
        ("compared", likelier),
        ("prove_held_out", SimpleNamespace(bears_out=True, closed=0.9)),
    ):
        monkeypatch.setattr(decision, name, lambda *_, value=value: value)
    assert decision.plainest(case, now).found is lost


def test_a_verdict_carries_the_account_and_what_else_was_weighed(case, as_read, named):
    verdict = decide(case, as_read)
    assert verdict.word == "missing_physics"
    assert verdict.found.labels == named[0].labels
    assert verdict.rivals[0].bic <= verdict.rivals[1].bic
    assert (verdict.process_noise, verdict.starts) == (None, {})


@pytest.mark.slow
def test_a_random_push_comes_with_its_place_and_strength_and_without_an_explanation():
    case = set_up_case(mass(), record(mass(), 3, Experiment(seconds=8.0, shaking=6.0)))
    verdict = decide(case, case.as_read())
    assert verdict.word == "process_noise"
    assert verdict.found.parts == ()
    assert verdict.process_noise is not None
    assert verdict.process_noise.place.name == "load"
    assert 4.0 < verdict.process_noise.strength < 8.0


@pytest.mark.parametrize(("name", "constants"), [("series_elasticity", {"tau": 5e13}), ("hysteresis", {"width": 2e14})])
def test_what_never_relaxes_or_yields_within_the_record_is_named_as_the_spring_that_it_is(name, constants):
    measured = record(mass().with_effect(Term("load", "port", "hidden", "-30*x")), 3, Experiment(seconds=12.0))
    case = set_up_case(mass(), measured)
    as_read = case.as_read()
    remembering, spring = (
        next(one for one in case.search.candidates if one.label == f"{each}@load")
        for each in (name, "linear_stiffness")
    )
    part = Part(remembering, {"factor": -30.0, **constants})
    base, starts = case.search.base, as_read.fit.starts
    endless = score(fit_model(as_read.shooting, base, (part,), starts, turns=0))
    assert not case.search.shows(endless)
    plain = score(fit_model(as_read.shooting, base, (Part(spring, {"factor": -30.0}),), starts))
    as_rival = prefer_relatives(case, as_read, Verdict(plain, (endless, plain)))
    assert [one.labels for one in as_rival.rivals] == [("linear_stiffness@load",)]
    proof = prove_held_out(case, as_read, endless)
    found = prefer_relatives(case, as_read, Verdict(endless, (), proof=proof))
    assert (found.word, found.found.labels) == ("missing_physics", ("linear_stiffness@load",))
    assert found.found.parts[0].values["factor"] == pytest.approx(-30.0, rel=0.05)


def test_what_relaxes_beyond_the_record_and_is_no_spring_either_is_not_named(case, as_read, cubic, labelled):
    parts = (Part(cubic, {"factor": -14.0}), Part(labelled["series_elasticity@load"], {"factor": 2.0, "tau": 5e13}))
    model = as_read.refitted(as_read.shooting, parts, turns=0)
    endless = score(model)
    proof = prove_held_out(case, as_read, endless)
    found = prefer_relatives(case, as_read, Verdict(endless, (), proof=proof))
    assert all(case.search.shows(one) for one in (found.found, *found.rivals))
