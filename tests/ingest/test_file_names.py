"""What names tell."""

from __future__ import annotations

from pathlib import Path

import pytest

from gaitdisc.ingest.people_table import (
    PSEUDONYM,
    condition_word,
    group_word,
    kind_of_trial,
    person_word,
    session_word,
    walk_key,
    walk_place,
    walk_word,
)


@pytest.mark.parametrize(
    ("path", "which"),
    [
        ("c3d_Trimmed_running_exotendon3_manual_scaling_ik.mot", "device"),
        ("c3d_Trimmed_running_natural2_manual_scaling_ik.mot", "nominal"),
        ("P01/walk_no_exo.mot", "nominal"),
        ("P01/noexo/exo_trial.mot", "device"),
        ("P01/NoExo/walk.mot", "nominal"),
        ("S1/ExoOff.c3d", "nominal"),
        ("S1/spring_on.c3d", "device"),
        ("S1/Baseline/ik.mot", "nominal"),
        ("welk002/manual_ik.mot", ""),
        ("extra/expo.mot", ""),
    ],
)
def test_conditions(path, which):
    assert condition_word(Path(path))[1] == which


def test_people_are_the_first_folder_that_is_no_condition_or_a_part_of_the_name():
    assert person_word(Path("raw/sub-01/exo/walk.mot")) == "sub-01"
    assert person_word(Path("exo/walk_P03.mot")) == "P03"
    assert person_word(Path("natural.mot")) == ""


def test_a_pseudonym_has_a_digit_and_no_blank():
    assert PSEUDONYM.fullmatch("welk002") and PSEUDONYM.fullmatch("sub-01")
    assert not any(map(PSEUDONYM.fullmatch, ("Anna", "Anna 01", "a" * 16 + "1")))


def test_files_of_one_walk_share_a_key():
    assert {walk_key(Path(name)) for name in ("IK_gait.mot", "gait-GRF.mot", "EMG_gait.sto", "gait.trc")} == {"gait"}
    assert walk_key(Path("coordinates.sto")) == ""
    assert walk_key(Path("walk1_ik.mot")) != walk_key(Path("walk2_ik.mot"))


@pytest.mark.parametrize(
    ("path", "person", "group", "session", "kind", "word"),
    [
        ("HC002D/Straight/HC002D06.c3d", "HC002D", "", "", "", "straight"),
        ("HC002D/Static/HC002D02.c3d", "HC002D", "", "", "static", ""),
        ("P01/pre/walk_fast3.c3d", "P01", "", "pre", "", "fast"),
        ("P01_post_walk1.c3d", "P01", "", "post", "", "walking"),
        ("controls/S07/Marble floor/12.c3d", "S07", "controls", "", "", "marble floor"),
        ("P01/visit2/cal01.c3d", "P01", "", "visit 2", "static", ""),
        ("P01/hipROM.c3d", "P01", "", "", "other", ""),
        ("controls/walk1.c3d", "controls", "", "", "", "walking"),
        ("natural2_ik.mot", "", "", "", "", ""),
    ],
)
def test_names_of_laboratories(path, person, group, session, kind, word):
    at = Path(path)
    assert (person_word(at), group_word(at)) == (person, group)
    assert (session_word(at)[0], kind_of_trial(at), walk_word(at)) == (session, kind, word)


def test_a_date_orders_sessions_and_is_no_part_of_a_person():
    first, second = (Path(f"P01_{date}/a.c3d") for date in ("2024-03-01", "2024-06-01"))
    assert person_word(first) == person_word(second) == "P01"
    assert session_word(first)[0] == "" and session_word(first)[1] < session_word(second)[1]


def test_a_word_counts_before_a_date_and_the_inner_date_before_one_of_birth():
    assert session_word(Path("Erika_1987-06-05/before/walk.c3d")) == ("before", "a01")
    assert session_word(Path("Erika_1987-06-05/2024-03-01/walk.c3d")) == ("", "d20240301")


def test_files_of_one_stem_may_lie_in_folders_of_their_kind():
    assert walk_place(Path("P01/IK/a.mot")) == walk_place(Path("P01/EMG/a.sto")) == ("P01",)
    assert walk_place(Path("P01/turn/a.mot")) != walk_place(Path("P01/straight/a.mot"))
