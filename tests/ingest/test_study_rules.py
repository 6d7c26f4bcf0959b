"""Rules that several keys break together."""

from __future__ import annotations

import pytest
from pydantic_core import PydanticCustomError

from gaitdisc.ingest.study import Conditions, Models, Participant, PlannedTrial, Study
from gaitdisc.ingest.study_rules import (
    check_channels,
    check_conditions,
    check_participants,
    check_sessions,
    check_variables,
    refuse,
)


def test_a_refusal_carries_its_place_and_three_parts():
    with pytest.raises(PydanticCustomError) as refusal:
        refuse(("a", 1), "x", "y", "z.")
    assert refusal.value.context == {"place": ("a", 1), "needed": "x", "found": "y", "remedy": "z."}


def _participants(words, *people):
    """Study that is not validated, so that one rule can be tested alone."""
    trials = [
        Participant(id=id, trials=(PlannedTrial(condition=condition, files=("a.mot",)),)) for id, condition in people
    ]
    return Study.model_construct(conditions=Conditions(nominal=words[0], device=words[1]), participants=tuple(trials))


@pytest.mark.parametrize(
    ("words", "people", "message"),
    [
        (("natural", "exo"), [("P1", "naturl")], r"'natural' or 'exo'; found 'naturl'\. Did you mean 'natural'\?"),
        (("natural", "exo"), [("P1", "zzz")], "Use one of them, or 'unknown'"),
        (("natural", "exo"), [("p1", "exo"), ("P1", "exo")], "'p1' stands 2 times"),
    ],
)
def test_conditions_and_pseudonyms(words, people, message):
    with pytest.raises(PydanticCustomError, match=message):
        check_participants(_participants(words, *people), ("unknown", "static"))


def test_unknown_conditions_may_be_listed():
    check_participants(_participants(("natural", "exo"), ("P1", "unknown"), ("P2", "exo")), ("unknown",))


@pytest.mark.parametrize(
    ("conditions", "message"),
    [
        ({"nominal": "a", "device": "a"}, "two different words.*found 'a' and 'a'"),
        ({"nominal": "a", "device": "unknown"}, "neither of them 'unknown'"),
        ({"nominal": "a", "others": ("b", "b")}, "different words.*found 'a' and 'b' and 'b'"),
        ({"nominal": "a", "unnamed": "c"}, "one of 'a'; found 'c'"),
    ],
)
def test_words_of_conditions_differ(conditions, message):
    with pytest.raises(PydanticCustomError, match=message):
        check_conditions(Conditions(**conditions), "unknown")


def _sessions(sessions, of_trial):
    trial = PlannedTrial(condition="a", session=of_trial, files=("a.c3d",))
    people = (Participant(id="P1", trials=(trial,)),)
    return Study.model_construct(sessions=sessions, conditions=Conditions(nominal="a"), participants=people)


@pytest.mark.parametrize(
    ("sessions", "of_trial", "message"),
    [
        (("2024-03-01",), None, "no date, since a date may show who a person is; found '2024-03-01'"),
        (("01.03.24",), None, "no date"),
        (("20240301",), None, "no date"),
        (("March 2024",), None, "no date"),
        (("pre", "pre"), None, "each session once; 'pre' stands twice"),
        (("before", "after"), "befor", r"\('before', 'after'\); found 'befor'\. Did you mean 'before'\?"),
        ((), "pre", r"\(none\); found 'pre'\. Add it: sessions = \['pre'\]"),
    ],
)
def test_sessions_are_listed_and_no_dates(sessions, of_trial, message):
    with pytest.raises(PydanticCustomError, match=message):
        check_sessions(_sessions(sessions, of_trial))


def test_words_and_numbers_of_visits_are_no_dates():
    check_sessions(_sessions(("pre", "visit 2", "6 months", "session 12"), "visit 2"))


@pytest.mark.parametrize(
    ("channels", "message"),
    [
        ({"x": "emg_sol_r [mVs]"}, "a unit of the closed list; found 'mVs', the nearest is 'mV'"),
        ({"x": "emg_solr"}, r"found 'emg_solr'\. Did you mean 'emg_sol_r'\?"),
        ({"x": " [V]"}, r"the name of a channel; found ' \[V\]'"),
        ({"x": "emg_sol_r", "y": "emg_sol_r [V]"}, "'x' and 'y' both mean 'emg_sol_r'"),
    ],
)
def test_channel_maps(channels, message):
    with pytest.raises(PydanticCustomError, match=message):
        check_channels(channels)


def test_own_channels_are_allowed_and_near_ones_if_they_state_a_unit():
    check_channels({"x": "belt_speed", "y": "emg_solr [V]", "z": "emg_sol"})


@pytest.mark.parametrize(
    ("parts", "message"),
    [
        ({"angles": ("knee_angle_r", "knee_angle_r")}, "each name once; 'knee_angle_r' stands twice"),
        ({"angles": ("knee_angel_r",)}, "Did you mean 'knee_angle_r'"),
        ({"outputs": ("emg_sol_r",)}, "outputs among the inputs"),
        ({"emg": ("knee_angle_r",)}, "'knee_angle_r' is in both"),
    ],
)
def test_model_variables(parts, message):
    with pytest.raises(PydanticCustomError, match=message) as refusal:
        check_variables(Models(**parts), {})
    assert (refusal.value.context or {})["place"][:2] == ("models", *parts)


def test_names_of_the_map_are_known():
    models = Models(angles=("knee_angel_r",), outputs=("knee_angel_r",))
    check_variables(models, {"k": "knee_angel_r [deg]"})
