"""A simulation that starts elsewhere than the trials is told so, and nothing else is named."""

from dataclasses import replace
from types import SimpleNamespace

import numpy as np
from hidden_in_a_mass import mass, record

from gaitdisc.discovery.discover import discover
from gaitdisc.discovery.estimates import wrong_starts


def begun(x: float, v: float):
    states = tuple(replace(state, initial=at) for state, at in zip(mass().states, (x, v), strict=True))
    return replace(mass(), states=states)


def test_a_start_elsewhere_than_the_file_says_is_the_only_thing_named():
    found, augmented = discover(begun(3.0, 0.0), record(mass(), 7))
    assert found.verdict == "wrong_initial_condition"
    assert next((one.kind, one.name) for one in found.effects) == ("state", "wrong_initial_condition")
    assert "Only the initial condition is wrong" in found.sentence
    start = next(one.estimates["initial"] for one in found.effects if one.place == "x")
    assert start.low < start.value < start.high < 2.0
    assert augmented.states[0].initial == float(f"{start.value:.6g}")


def test_states_without_a_start_in_the_file_are_left_alone():
    found, augmented = discover(mass(), record(mass(), 7))
    assert found.verdict == "no_gap"
    assert augmented == mass()


def test_trials_that_begin_at_unlike_places_show_no_start_that_all_have():
    slopes = np.full((3, 8, 2), 10.0) * [1.0, 0.0] + np.eye(8, 2)
    for starts, wrong in (((0.4, 0.41, 0.4), True), ((0.9, -0.2, 0.5), False)):
        fit = SimpleNamespace(starts=np.column_stack([starts, np.zeros(3)]), slopes=slopes)
        runs = SimpleNamespace(segments=SimpleNamespace(begin=np.zeros(3, int)))
        as_read = SimpleNamespace(model=SimpleNamespace(fit=fit), shooting=runs)
        assert ("x" in wrong_starts(begun(0.0, 0.0), as_read)) is wrong
