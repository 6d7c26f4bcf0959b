"""A simulation that starts elsewhere than the trials is told so, and nothing else is named."""

from dataclasses import replace

from hidden_in_a_mass import mass, record

from gaitdisc.discovery.discover import discover
from gaitdisc.discovery.wrong_start import begun_at
from gaitdisc.results.discovery import Estimate


def begun(x: float, v: float):
    states = tuple(replace(state, initial=at) for state, at in zip(mass().states, (x, v), strict=True))
    return replace(mass(), states=states)


def test_a_start_elsewhere_than_the_file_says_is_the_only_thing_named():
    found, augmented = discover(begun(3.0, 0.0), record(mass(), 7))
    assert found.verdict == "wrong_initial_condition"
    assert next((one.kind, one.name) for one in found.effects) == ("state", "wrong_initial_condition")
    assert "Only the start is wrong" in found.sentence
    start = next(one.estimates["initial"] for one in found.effects if one.place == "x")
    assert start.low < start.value < start.high < 2.0
    assert augmented.states[0].initial == float(f"{start.value:.6g}")


def test_states_without_a_start_in_the_file_are_left_alone():
    found, augmented = discover(mass(), record(mass(), 7))
    assert found.verdict == "no_gap"
    assert augmented == mass()


def test_other_starts_are_written_into_the_states():
    moved = begun_at(begun(3.0, 0.0), {"x": Estimate(0.25, 0.2, 0.3, "m")})
    assert [state.initial for state in moved.states] == [0.25, 0.0]
