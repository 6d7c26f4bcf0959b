"""Which trials belong together, and who is refused: what check and run share."""

from __future__ import annotations

import pytest

from gaitdisc.ingest.study import Conditions, Participant, PlannedTrial, Study
from gaitdisc.ingest.trial_sets import (
    functional_trial,
    is_functional,
    is_static,
    is_walk,
    not_compared,
    refused_participant,
    static_trial,
    trial_sets,
)


def _trial(condition, session=None, file="a.c3d"):
    return PlannedTrial(condition=condition, session=session, files=(file,))


def _study(*people, **conditions):
    return Study(sessions=("before", "after"), conditions=Conditions(**conditions), participants=people)


def _person(id, *trials, **fields):
    return Participant(id=id, trials=trials, **fields)


def test_walks_are_taken_together_by_session_and_condition_in_the_study_s_order():
    person = _person(
        "P01", _trial("turn", "after"), _trial("straight", "after"), _trial("turn", "before"), _trial("turn", "after"),
        _trial("static", "before"), _trial("unknown", "before"),
    )  # fmt: skip
    study = _study(person, nominal="straight", others=("turn",))
    sets = trial_sets(study, person)
    assert [(one.session, one.condition, len(one.trials)) for one in sets] == [
        ("before", "turn", 1), ("after", "straight", 1), ("after", "turn", 2),
    ]  # fmt: skip
    assert [is_walk(study, trial) for trial in person.trials] == [True] * 4 + [False, False]


def test_static_is_a_condition_where_the_study_says_so():
    person = _person("P01", _trial("static"))
    assert is_static(_study(person, nominal="walk"), person.trials[0])
    assert is_walk(_study(person, nominal="static"), person.trials[0])


def test_the_static_trial_is_that_of_the_session_else_the_only_one():
    own = _person(
        "P01", _trial("static", "before", "1.c3d"), _trial("static", "after", "2.c3d"), _trial("walk", "after")
    )
    study = _study(own, nominal="walk")
    found = static_trial(study, own, "after")
    assert found is not None and found.files == ("2.c3d",)
    only = _person("P02", _trial("static", "before"), _trial("walk", "after"))
    assert static_trial(study, only, "after") == only.trials[0]
    assert static_trial(study, own, "") is None and static_trial(study, _person("P03"), "") is None


def test_circled_legs_are_no_walk_but_for_a_study_that_walks_by_that_word():
    person = _person("P01", _trial("walk", "before"), _trial("functional", "before", "1.c3d"))
    study = _study(person, nominal="walk")
    assert is_functional(study, person.trials[1]) and not is_walk(study, person.trials[1])
    assert functional_trial(study, person, "before") == person.trials[1]
    assert functional_trial(study, _person("P02", _trial("walk")), "") is None
    assert is_walk(_study(person, nominal="functional", others=("walk",)), person.trials[1])


@pytest.mark.parametrize(
    ("trials", "message"),
    [
        ((_trial("free"), _trial("exo")), ""),
        ((_trial("free"), _trial("free"), _trial("exo")), "P01 has 2 of 'free', 1 of 'exo'"),
        ((_trial("free", "before"), _trial("exo", "after")), "P01 has 1 of 'free', 1 of 'exo'"),
    ],
)
def test_models_compare_one_walk_of_each_of_one_session(trials, message):
    person = _person("P01", *trials)
    study = _study(person, nominal="free", device="exo")
    assert message in not_compared(study, person) and bool(message) == bool(not_compared(study, person))
    assert refused_participant(study, person) == ""


def test_who_lacks_a_condition_is_refused_but_not_a_group_that_never_has_it():
    lacking = _person("P01", _trial("free"))
    control, patient = (
        _person(id, _trial("free"), group=group) for id, group in (("P02", "control"), ("P03", "patient"))
    )
    treated = _person("P04", _trial("free"), _trial("exo"), group="patient")
    study = _study(lacking, control, patient, treated, nominal="free", device="exo")
    refused = {person.id: bool(refused_participant(study, person)) for person in study.participants}
    assert refused == {"P01": True, "P02": False, "P03": True, "P04": False}
    assert "a comparison needs one trial of 'free' and one of 'exo'; P01 has 1 of 'free', none" in refused_participant(
        study, lacking
    )


def test_nobody_without_a_walk_is_reported():
    person = _person("P01", _trial("static"), _trial("unknown"))
    said = refused_participant(_study(person, nominal="straight", others=("turn",)), person)
    assert said.startswith("a participant needs a trial of 'straight' or 'turn'; P01 has 2 trials of other conditions")
    assert (
        refused_participant(_study(person, nominal="a"), _person("P02", excluded="ill")) == "excluded in the study: ill"
    )
