"""The study file: loaded, written with every default, and equal to its JSON Schema."""

from __future__ import annotations

import json
import tomllib
from pathlib import Path

import jsonschema
import pytest
from hypothesis import given
from hypothesis import strategies as st
from texts import says

from gaitdisc.channel import schema_folder
from gaitdisc.errors import ReadError
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
from gaitdisc.ingest.study_file import load_study, study_schema, study_text, write_study

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
    assert loaded.held_out.length_s(240.0) == study.held_out.length_s(240.0)
    assert loaded.folder == folder


def _study():
    trials = tuple(PlannedTrial(condition=word, files=(f"{word}.mot",)) for word in ("natural", "exotendon"))
    return Study(
        conditions=Conditions(nominal="natural", device="exotendon"),
        participants=(Participant(id="P01", trials=trials),),
    )


def test_every_default_is_written_out_and_explained():
    text = study_text(_study())
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
    study = load_study(write_study(_study().placed(tmp_path / "raw"), tmp_path / "a" / "b"))
    assert study.participants[0].trials[0].files == ("../../raw/natural.mot",)
    assert study.path_of(study.participants[0].trials[0].files[0]).resolve() == tmp_path / "raw" / "natural.mot"


def test_the_file_of_a_marker_set_is_relative_to_the_new_study_and_must_be_there(tmp_path):
    (tmp_path / "a").mkdir()
    study = _study().model_copy(update={"kinematics": Kinematics(marker_set="ours.toml")}).placed(tmp_path)
    moved = load_study(write_study(study, tmp_path / "a"))
    assert moved.kinematics == Kinematics(marker_set="../ours.toml")
    assert "../ours.toml" in moved.missing_files()
    (tmp_path / "ours.toml").write_text("")
    assert "../ours.toml" not in moved.missing_files()


def test_an_absent_study_is_refused(tmp_path):
    with pytest.raises(ReadError, match=r"study\.toml"):
        load_study(tmp_path)


def test_the_schema_file_is_that_of_the_program_and_a_study_is_valid():
    stored = json.loads((Path(schema_folder()) / "study.schema.json").read_text(encoding="utf-8"))
    # Where it is old: write json.dumps(study_schema(), indent=1) to data_schema/study.schema.json.
    assert stored == Study.model_json_schema() == study_schema()
    jsonschema.Draft202012Validator.check_schema(stored)
    content = tomllib.loads(study_text(_study()))
    jsonschema.validate(content, stored)
    content["filters"]["kinematic_hz"] = 6.0
    with pytest.raises(jsonschema.ValidationError, match="kinematic_hz"):
        jsonschema.validate(content, stored)
