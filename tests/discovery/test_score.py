from dataclasses import replace

import numpy as np
import pytest
from hidden_in_a_mass import Experiment, mass, record, with_load

from gaitdisc.discovery.candidate import saturations
from gaitdisc.discovery.case import set_up_case
from gaitdisc.discovery.scored_model import Part, fit_model


def _inquiry(truth, late=0):
    case = set_up_case(mass(), record(truth, 5, Experiment(seconds=10.0, late=late)))
    return case, case.as_read()


def _scores(case, now):
    scorer = case.search.scorer(now)
    return {one.candidate.label: one for one in reversed(scorer.scores(case.search.candidates))}


def _fall(case, now, score):
    part = score
    refitted = fit_model(now.shooting, case.search.base, (part,), now.fit.starts)
    return now.fit.misfit - refitted.fit.misfit, refitted.parts[0].values


@pytest.mark.parametrize(
    ("term", "label"),
    [("0.15", "constant_load@load"), ("-0.3*x", "linear_stiffness@load"), ("-0.2*x**3", "cubic_stiffness@load")],
)
def test_of_a_small_effect_the_score_is_the_fall_of_the_misfit_after_the_refit(term, label):
    case, now = _inquiry(with_load(term))
    score = _scores(case, now)[label]
    fall, values = _fall(case, now, score)
    assert score.gain == pytest.approx(fall, rel=0.03)
    assert score.values["factor"] == pytest.approx(values["factor"], rel=0.03)


def test_a_wrong_number_and_a_wrong_sensor_are_scored_alike():
    case, now = _inquiry(mass().with_values({"k": 24.2}).with_observation("x", "x + 0.002"))
    scores = _scores(case, now)
    for label, slot in (("wrong_parameter@k", "value"), ("sensor_offset@x", "offset")):
        fall, values = _fall(case, now, scores[label])
        assert scores[label].gain == pytest.approx(fall, rel=0.05)
        assert scores[label].values[slot] == pytest.approx(values[slot], rel=0.05)


def test_the_best_delay_of_the_grid_is_near_the_true_one():
    case, now = _inquiry(mass(), late=6)
    scores = _scores(case, now)
    assert scores["input_delay@push"].values["seconds"] == pytest.approx(0.12, abs=0.05)
    assert scores["input_delay@push"].gain > scores["input_gain@push"].gain


def test_the_best_limit_of_the_grid_is_near_the_true_one():
    case, now = _inquiry(mass().with_input("push", "min(push, 4)"))
    scores = case.search.scorer(now).scores(saturations(mass(), {}))
    assert [one.candidate.slots for one in scores[:2]] == [("upper_limit",), ("lower_limit", "upper_limit")]
    assert scores[0].values["upper_limit"] == pytest.approx(4, abs=1)


def test_an_effect_that_is_let_in_already_promises_nothing_more(case, as_read, cubic):
    part = Part(cubic, {"factor": -14.0})
    model = as_read.refitted(as_read.shooting, (part,))
    before, after = _scores(case, as_read), _scores(case, model)
    assert after["cubic_stiffness@load"].gain < 1e-3 * before["cubic_stiffness@load"].gain


def test_scores_are_in_order_and_one_for_each_candidate(case, as_read):
    scorer = case.search.scorer(as_read)
    scores = scorer.scores(case.search.candidates)
    assert len(scores) <= len(case.search.candidates)
    assert np.all(np.diff([one.gain for one in scores]) <= 0)


def test_a_sensor_that_lags_already_is_not_delayed_again():
    lagging = mass().with_observation("x", "delay(x, 0.05)")
    case = set_up_case(lagging, record(lagging, 5, Experiment(seconds=8.0)))
    assert "sensor_lag@x" not in _scores(case, case.as_read())


def test_what_is_left_without_a_trial_is_what_the_others_alone_would_leave(case, as_read):
    candidates = case.search.candidates
    scorer = case.search.scorer(as_read)
    left = scorer.leave_out_each(candidates)
    segments = as_read.shooting.segments
    for trial in np.unique(segments.trial):
        some = np.flatnonzero(segments.trial != trial)
        shooting = replace(as_read.shooting, segments=segments.among(some))
        others = case.search.scorer(replace(as_read, shooting=shooting, fit=as_read.fit.among(some)))
        best = others.scores(candidates)[0].gain
        expected = (np.square(others.model.fit.projected[0]).sum() - best) / others.model.fit.white.size
        assert left[trial] == pytest.approx(expected, rel=1e-9)


def test_of_a_great_many_candidates_those_worth_it_are_scored_as_all_are(monkeypatch):
    case, now = _inquiry(with_load("-0.3*x"))
    every = _scores(case, now)
    monkeypatch.setattr("gaitdisc.discovery.score.MOST", len(every) // 2)
    monkeypatch.setattr("gaitdisc.discovery.score.KEPT", len(every) // 3)
    some = _scores(case, now)
    assert len(every) // 4 < len(some) <= len(every) // 3
    best = max(every.values(), key=lambda one: one.gain)
    assert max(some.values(), key=lambda one: one.gain).candidate.label == best.candidate.label
    assert some[best.candidate.label].gain == pytest.approx(best.gain, rel=1e-9)
