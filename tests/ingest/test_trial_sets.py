"""Which trials belong together, and who is refused: what check and run share."""

import pytest
from texts import says

from gaitdisc.ingest.study import Conditions, Participant, PlannedTrial, Study
from gaitdisc.ingest.trial_sets import calibration_trial, is_calibration, is_walk, not_compared, trial_sets, why_refused
from gaitdisc.recording.trial import BodyMeasures


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
    assert is_calibration(_study(person, nominal="walk"), person.trials[0])
    assert is_walk(_study(person, nominal="static"), person.trials[0])


def test_the_static_trial_is_that_of_the_session_else_the_only_one():
    own = _person(
        "P01", _trial("static", "before", "1.c3d"), _trial("static", "after", "2.c3d"), _trial("walk", "after")
    )
    study = _study(own, nominal="walk")
    found = calibration_trial(study, own, "after", "static")
    assert found is not None and found.files == ("2.c3d",)
    only = _person("P02", _trial("static", "before"), _trial("walk", "after"))
    assert calibration_trial(study, only, "after", "static") == only.trials[0]
    assert all(calibration_trial(study, one, "", "static") is None for one in (own, _person("P03")))


def test_circled_legs_are_no_walk_but_for_a_study_that_walks_by_that_word():
    person = _person("P01", _trial("walk", "before"), _trial("functional", "before", "1.c3d"))
    study = _study(person, nominal="walk")
    assert is_calibration(study, person.trials[1]) and not is_walk(study, person.trials[1])
    assert calibration_trial(study, person, "before", "functional") == person.trials[1]
    assert calibration_trial(study, _person("P02", _trial("walk")), "", "functional") is None
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
    assert why_refused(study, person) == ""


def test_who_lacks_a_condition_is_refused_but_not_a_group_that_never_has_it():
    lacking = _person("P01", _trial("free"))
    control, patient = (_person(id, _trial("free"), group=who) for id, who in (("P02", "control"), ("P03", "patient")))
    treated = _person("P04", _trial("free"), _trial("exo"), group="patient")
    study = _study(lacking, control, patient, treated, nominal="free", device="exo")
    refused = {person.id: bool(why_refused(study, person)) for person in study.participants}
    assert refused == {"P01": True, "P02": False, "P03": True, "P04": False}
    assert says(why_refused(study, lacking), "'free'", "'exo'; P01", "1", "'free'")


def test_nobody_without_a_walk_is_reported():
    person = _person("P01", _trial("static"), _trial("unknown"))
    said = why_refused(_study(person, nominal="straight", others=("turn",)), person)
    assert says(said, "'straight'", "'turn'; P01", "trials of other conditions: 2")
    assert why_refused(_study(person, nominal="a"), _person("P02", excluded="ill")) == "excluded in the study: ill"


def _saved(tmp_path, **texts):
    for name, text in texts.items():
        (tmp_path / f"{name}.c3d").write_text(text)


def test_one_recording_under_two_people_conditions_or_sessions_is_refused(tmp_path):
    _saved(tmp_path, a="one", b="two", c="one", d="two")
    first = _person("P01", _trial("walk", file="a.c3d"), _trial("turn", file="b.c3d"))
    for trials in ((_trial("walk", file="c.c3d"),), (_trial("turn", file="c.c3d"),)):
        other = _person("P02", *trials)
        study = _study(first, other, nominal="walk", others=("turn",)).placed(tmp_path)
        said = why_refused(study, first)
        assert said.startswith(f"P01 walk and P02 {trials[0].condition} are the same recording: ")
        assert why_refused(study, other).startswith("P02 ")
    both = _person("P01", _trial("walk", file="b.c3d"), _trial("turn", file="d.c3d"))
    study = _study(both, nominal="walk", others=("turn",)).placed(tmp_path)
    assert says(why_refused(study, both), "P01 walk", "P01 turn")
    visits = _person("P01", _trial("walk", "before", "a.c3d"), _trial("walk", "after", "c.c3d"))
    assert "are the same recording" in why_refused(_study(visits, nominal="walk").placed(tmp_path), visits)


def test_parts_of_one_file_and_one_static_trial_of_two_sessions_are_no_repetition(tmp_path):
    _saved(tmp_path, a="one", b="two")
    crops = [(0.0, 5.0), (5.0, 9.0)]
    cut = [PlannedTrial(condition=c, files=("a.c3d",), crop_s=s) for c, s in zip(("walk", "turn"), crops, strict=True)]
    parts = [PlannedTrial(condition=c, files=("b.c3d",), part=n) for c, n in (("walk", "1"), ("turn", "2"))]
    stands = [_trial("static", "before", "a.c3d"), _trial("static", "after", "a.c3d"), _trial("walk", "after", "b.c3d")]
    for trials in (cut, parts, stands):
        person = _person("P01", *trials)
        study = _study(person, nominal="walk", others=("turn",)).placed(tmp_path)
        assert why_refused(study, person) == ""


@pytest.mark.parametrize(
    ("measure", "values", "said"),
    [
        ("mass_kg", (32.0, 40.0), "body mass is 32 kg in P01 walk 1 and 40 kg in P01 walk 2; files of one"),
        ("height_m", (1.32, 1.44), "stature is 1.32 m in P01 walk 1 and 1.44 m in P01 walk 2"),
        ("leg_length_m", ({"l": 0.70}, {"l": 0.83}), "leg length (l) is 0.7 m in P01 walk 1 and 0.83 m in P01 walk 2"),
    ],
)
def test_two_bodies_in_one_session_are_refused_and_a_child_that_grew_is_not(monkeypatch, measure, values, said):
    files = dict(zip(("1.c3d", "2.c3d"), values, strict=True))
    monkeypatch.setattr(
        "gaitdisc.ingest.trial_sets.read_body_measures", lambda path: BodyMeasures(**{measure: files[path.name]})
    )
    one = _person("P01", _trial("walk", file="1.c3d"), _trial("walk", file="2.c3d"))
    assert why_refused(_study(one, nominal="walk"), one).startswith(said)
    grown = _person("P01", _trial("walk", "before", "1.c3d"), _trial("walk", "after", "2.c3d"))
    assert why_refused(_study(grown, nominal="walk"), grown) == ""
    if measure == "mass_kg":  # what the study says goes before the files
        stated = one.model_copy(update={"mass_kg": 36.0})
        assert why_refused(_study(stated, nominal="walk"), stated) == ""
