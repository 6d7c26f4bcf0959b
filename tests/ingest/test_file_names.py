"""What names tell."""

from __future__ import annotations

from pathlib import Path

import pytest

from gaitdisc.ingest.file_names import PSEUDONYM, condition_word, person_word, walk_key


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
