from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from hidden_in_a_mass import Experiment, mass, record, with_load
from texts import says

from gaitdisc.discovery.case import set_up_case
from gaitdisc.discovery.discover import discover
from gaitdisc.discovery.odd_trials import without_trial_apart
from gaitdisc.discovery.search import Search


def spoiled(measured, how):
    """The trials with one thing wrong in the second."""
    seen = measured.observed.copy()
    one = seen[1, :, 0]
    if how == "gain":
        one *= 1.5
    elif how == "offset":
        one += 2 * one.std()
    elif how == "drift":
        one += np.linspace(0, 3 * one.std(), len(one))
    elif how == "still":
        one[len(one) // 3 :] = one[len(one) // 3]
    return replace(measured, observed=seen)


@pytest.mark.parametrize(
    "how", ["gain", *(pytest.param(how, marks=pytest.mark.slow) for how in ("offset", "drift", "still"))]
)
def test_a_trial_that_goes_with_no_explanation_of_the_others_is_left_out_and_the_name_is_right(how):
    measured = spoiled(record(with_load("-14*x**3"), 3, Experiment(seconds=10.0)), how)
    found, _ = discover(mass(), measured)
    assert [(one.name, one.place) for one in found.effects] == [("cubic_stiffness", "load")]
    assert says(found.sentence, "rial '2'", "explanation", "left out")
    assert "it was left out" in found.sentence


def test_trials_that_were_recorded_alike_are_all_kept_after_one_search_at_most(monkeypatch):
    searched = []
    search = Search.extended
    monkeypatch.setattr(Search, "extended", lambda *a, **k: searched.append(1) or search(*a, **k))
    bump = with_load("-6*exp(-((x - 0.3)/0.2)**2)")  # of which no single explanation leaves mere noise
    case = set_up_case(mass(), record(bump, 3, Experiment(seconds=10.0)))
    assert without_trial_apart(case) is case.measured
    assert len(searched) <= 1


def test_of_three_trials_none_is_said_to_stand_apart():
    case = set_up_case(mass(), record(mass(), 3, Experiment(trials=3, seconds=10.0)))
    assert without_trial_apart(case) is case.measured
