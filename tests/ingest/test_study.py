"""The study as an object, and its file: loaded, written with every default, equal to its JSON Schema."""

import json
import tomllib
from pathlib import Path

import jsonschema
import pytest
from hypothesis import given
from hypothesis import strategies as st
from pydantic import ValidationError
from texts import says

from gaitdisc.channel import schema_folder
from gaitdisc.errors import ReadError, SchemaError
from gaitdisc.ingest.study import (
    Conditions,
    Filters,
    HeldOut,
    Kinematics,
    Models,
    Participant,
    PlannedTrial,
    Study,
    Treadmill,
)
from gaitdisc.ingest.study_file import load_study, study_text, write_study


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
    assert 240.0 * study.held_out.share == 30.0


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
    assert HeldOut(seconds=20.0).seconds == 20.0
    with pytest.raises(ValidationError, match=r"'seconds'.*'share'"):
        HeldOut(seconds=20.0, share=0.2)


def test_who_lacks_a_condition_is_listed_and_not_refused():
    study = _study(BOTH, ONE, OUT)
    assert study.one_condition_only() == ("P02",)
    assert len(BOTH.trials_of("exo")) == 2


def test_a_participant_is_found_or_refused_with_the_list():
    assert _study(BOTH, ONE).participant("P02") == ONE
    with pytest.raises(SchemaError, match=r"'P09'.*P01, P02"):
        _study(BOTH, ONE).participant("P09")


def test_a_study_is_frozen_and_strict():
    with pytest.raises(ValidationError, match="frozen"):
        _study(BOTH).title = "new"  # pyright: ignore[reportAttributeAccessIssue]
    with pytest.raises(ValidationError):
        Models(seed="64")  # pyright: ignore[reportArgumentType]
    with pytest.raises(ValidationError):
        Participant(id="Anna Muster")


words = st.text(st.characters(exclude_categories=["Cs"]), min_size=1, max_size=20)
file_names = st.text(st.characters(exclude_categories=["Cs"], exclude_characters="\0"), min_size=1, max_size=20)
positive = st.floats(1e-3, 1e4)


@st.composite
def studies(draw):
    trials = st.builds(
        PlannedTrial,
        condition=st.sampled_from(["natural", "exo", "slow", "static", "unknown"]),
        session=st.sampled_from([None, "before", "after"]),
        files=st.lists(file_names, min_size=1, max_size=3).map(tuple),
        speed_m_per_s=st.none() | positive,
        crop_s=st.none() | st.tuples(st.floats(0, 10), st.floats(11, 20)),
    )
    ids = draw(st.lists(st.from_regex(r"[a-z0-9_-]{1,16}", fullmatch=True), min_size=1, max_size=3, unique=True))
    group = st.sampled_from(["", "control"])
    people = [
        Participant(
            id=i,
            group=draw(group),
            excluded=draw(words),
            mass_kg=draw(st.none() | st.floats(5, 300)),
            sex=draw(st.sampled_from(["", "f", "m"])),
            trials=tuple(draw(st.lists(trials, max_size=3))),
        )
        for i in ids
    ]
    return Study(
        title=draw(words),
        sessions=("before", "after"),
        conditions=Conditions(nominal="natural", device="exo", others=("slow",)),
        treadmill=draw(
            st.none() | st.builds(Treadmill, speed_m_per_s=positive, direction=st.sampled_from(["+x", "-z"]))
        ),
        channels=dict(enumerate_labels(draw(st.lists(words, max_size=3, unique=True)))),
        filters=Filters(kinematics_hz=draw(positive), order=draw(st.sampled_from([2, 8]))),
        kinematics=draw(
            st.none()
            | st.builds(
                Kinematics,
                angles=st.sampled_from([None, "file", "markers"]),
                marker_set=st.sampled_from(["", "plug_in_gait"]),
                joints=st.sampled_from([None, "held"]),
            )
        ),
        models=Models(emg=draw(st.sampled_from([(), ("emg_sol_r", "emg_ta_l")]))),
        held_out=draw(st.sampled_from([HeldOut(), HeldOut(seconds=30.0), HeldOut(share=0.2)])),
        participants=tuple(people),
    )


def enumerate_labels(labels):
    return ((label, f"own_{i} [V]") for i, label in enumerate(labels))


@given(studies())
def test_what_is_written_is_loaded_again(tmp_path_factory, study):
    folder = tmp_path_factory.mktemp("study")
    loaded = load_study(write_study(study.placed(folder), folder))
    assert loaded.model_dump(exclude={"held_out"}) == study.model_dump(exclude={"held_out"})
    one, other = loaded.held_out, study.held_out
    assert (one.seconds, one.seconds or one.share) == (other.seconds, other.seconds or other.share)
    assert loaded.folder == folder


def _exotendon():
    trials = tuple(PlannedTrial(condition=word, files=(f"{word}.mot",)) for word in ("natural", "exotendon"))
    return Study(
        conditions=Conditions(nominal="natural", device="exotendon"),
        participants=(Participant(id="P01", trials=trials),),
    )


def test_every_default_is_written_out_and_explained():
    text = study_text(_exotendon())
    content = tomllib.loads(text)
    for section, model in Study.model_fields.items():
        default = model.get_default(call_default_factory=True)
        if hasattr(default, "model_dump"):
            written = {k: v for k, v in json.loads(default.model_dump_json()).items() if v is not None}
            assert content[section] == written, section
    assert says(text, "kinematics_hz = 6.0", "[Hz]")
    assert "# seconds = 30.0" in text
    assert "# [treadmill]" in text


def test_paths_are_relative_to_the_new_file(tmp_path):
    (tmp_path / "raw").mkdir()
    (tmp_path / "a" / "b").mkdir(parents=True)
    study = load_study(write_study(_exotendon().placed(tmp_path / "raw"), tmp_path / "a" / "b"))
    assert study.participants[0].trials[0].files == ("../../raw/natural.mot",)
    assert study.path_of(study.participants[0].trials[0].files[0]).resolve() == tmp_path / "raw" / "natural.mot"


def test_the_file_of_a_marker_set_is_relative_to_the_new_study(tmp_path):
    (tmp_path / "a").mkdir()
    study = _exotendon().model_copy(update={"kinematics": Kinematics(marker_set="ours.toml")}).placed(tmp_path)
    moved = load_study(write_study(study, tmp_path / "a"))
    assert moved.kinematics == Kinematics(marker_set="../ours.toml")


def test_an_absent_study_is_refused(tmp_path):
    with pytest.raises(ReadError, match=r"study\.toml"):
        load_study(tmp_path)


def test_the_schema_file_is_that_of_the_program_and_a_study_is_valid():
    stored = json.loads((Path(schema_folder()) / "study.schema.json").read_text(encoding="utf-8"))
    # Where it is old: write json.dumps(Study.model_json_schema(), indent=1) to data_schema/study.schema.json.
    assert stored == Study.model_json_schema()
    jsonschema.Draft202012Validator.check_schema(stored)
    content = tomllib.loads(study_text(_exotendon()))
    jsonschema.validate(content, stored)
    content["filters"]["kinematic_hz"] = 6.0
    with pytest.raises(jsonschema.ValidationError, match="kinematic_hz"):
        jsonschema.validate(content, stored)
