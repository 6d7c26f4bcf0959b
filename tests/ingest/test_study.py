"""The study as an object."""

from __future__ import annotations

import pytest
from pydantic import ValidationError

from gaitdisc.errors import SchemaError
from gaitdisc.ingest.study import Conditions, HeldOut, Models, Participant, PlannedTrial, Study


def _study(*participants, **parts):
    return Study(conditions=Conditions(nominal="natural", device="exo"), participants=participants, **parts)


def _walk(condition, *files):
    return PlannedTrial(condition=condition, files=files or (f"{condition}.mot",))


BOTH = Participant(id="P01", trials=(_walk("natural"), _walk("exo"), _walk("exo", "exo2.mot")))
ONE = Participant(id="P02", trials=(_walk("natural"), _walk("unknown")))
OUT = Participant(id="P03", excluded="late change", trials=(_walk("natural"), _walk("exo")))


def test_the_defaults_are_those_of_the_dissertation():
    study = _study(BOTH)
    assert (study.filters.kinematics_hz, study.filters.emg_highpass_hz, study.filters.emg_lowpass_hz) == (6, 40, 10)
    assert study.filters.order == 4
    assert study.models.seed == 0
    assert len(study.models.angles) == 10
    assert study.held_out.length_s(240.0) == 30.0


def test_both_conditions_nominal_first():
    assert _study(BOTH).conditions.both == ("natural", "exo")
    assert _study(BOTH).conditions.words == ("natural", "exo")


def test_one_condition_is_a_study_and_has_no_pair_to_compare():
    alone = Study(conditions=Conditions(nominal="natural"), participants=(ONE,))
    assert alone.conditions.words == ("natural",) and alone.one_condition_only() == ()
    with pytest.raises(SchemaError, match="'natural'"):
        _ = alone.conditions.both


def test_trials_are_named_by_session_condition_and_number():
    before = [PlannedTrial(condition="natural", session="before", files=(f"{n}.c3d",)) for n in "ab"]
    after = PlannedTrial(condition="natural", session="after", files=("c.c3d",))
    person = Participant(id="P01", trials=(*before, after))
    assert [person.trial_name(t) for t in person.trials] == [
        "P01 before natural 1", "P01 before natural 2", "P01 after natural",
    ]  # fmt: skip


def test_one_line_names_all_trials_whose_condition_is_unknown():
    study = Study(conditions=Conditions(nominal="natural", unnamed="natural"), participants=(ONE,)).placed("home")
    assert [t.condition for t in study.with_unnamed().participants[0].trials] == ["natural", "natural"]
    assert study.with_unnamed().folder == study.folder


def test_the_held_out_part_may_be_given_in_seconds():
    assert HeldOut(seconds=20.0).length_s(240.0) == 20.0
    with pytest.raises(ValidationError, match=r"'seconds'.*'share'"):
        HeldOut(seconds=20.0, share=0.2)


def test_who_lacks_a_condition_is_listed_and_not_refused():
    study = _study(BOTH, ONE, OUT)
    assert study.one_condition_only() == ("P02",)
    assert [each.id for each in study.complete()] == ["P01"]
    assert len(BOTH.trials_of("exo")) == 2


def test_a_participant_is_found_or_refused_with_the_list():
    assert _study(BOTH, ONE).participant("P02") == ONE
    with pytest.raises(SchemaError, match=r"'P09'.*P01, P02"):
        _study(BOTH, ONE).participant("P09")


def test_missing_files_are_all_named(tmp_path):
    (tmp_path / "exo.mot").write_text("x")
    study = _study(BOTH, OUT).placed(tmp_path)
    assert study.path_of("exo.mot") == tmp_path / "exo.mot"
    assert study.missing_files() == ("natural.mot", "exo2.mot")
    with pytest.raises(SchemaError, match=r"2 missing: natural\.mot, exo2\.mot"):
        study.check_files()


def test_a_study_is_frozen_and_strict():
    with pytest.raises(ValidationError, match="frozen"):
        _study(BOTH).title = "new"  # pyright: ignore[reportAttributeAccessIssue]
    with pytest.raises(ValidationError):
        Models(seed="64")  # pyright: ignore[reportArgumentType]
    with pytest.raises(ValidationError):
        Participant(id="Anna Muster")
