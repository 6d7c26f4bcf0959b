"""Who walked: what file names tell, and mass, sex and stature from a table beside the recordings."""

from pathlib import Path

import pytest
from texts import says

from gaitdisc.ingest.people_table import (
    PSEUDONYM,
    Measured,
    condition_word,
    group_word,
    kind_of_trial,
    person_word,
    read_people,
    session_word,
    walk_key,
    walk_place,
    walk_word,
)


def _read(tmp_path, text, name="participants.tsv"):
    (tmp_path / name).write_text(text, encoding="utf-8")
    notes: list[str] = []
    return read_people(tmp_path, [Path(name)], notes), notes


def test_a_table_as_bids_has_it(tmp_path):
    one, other = ("sub-01", "24", "F", "61.3", "172"), ("sub-02", "30", "n/a", "n/a", "1.81")
    lines = [("participant_id", "age", "sex", "weight", "height"), one, other]
    found, notes = _read(tmp_path, "\n".join(map("\t".join, lines)))
    assert found == {"01": Measured(61.3, 1.72, "f", 24), "02": Measured(None, 1.81, "", 30)}
    assert notes == []


@pytest.mark.parametrize(
    ("label", "text", "age"), [("Age [years]", "8.7", 8), ("age", "n/a", None), ("age (yr)", "41", 41)]
)
def test_age_in_whole_years(tmp_path, label, text, age):
    found, notes = _read(tmp_path, f"id,sex,{label},birth_date\nS1,f,{text},1999-02-03\n")
    assert found == {"s1": Measured(None, None, "f", age)} and notes == []


def test_an_age_in_months_or_of_nobody_is_not_taken_for_years(tmp_path):
    found, notes = _read(tmp_path, "id,sex,age (months)\nS1,f,96\n")
    assert found == {"s1": Measured(None, None, "f")} and notes == []
    found, notes = _read(tmp_path, "id,age\nS1,1999\n")
    assert found == {"s1": Measured()}
    assert len(notes) == 1 and says(notes[0], "participants.tsv, line 2", "age", "1999", "120 years")


@pytest.mark.parametrize(
    ("label", "text", "height_m"),
    [
        ("height [cm]", "172", 1.72),
        ("Stature (mm)", "1720", 1.72),
        ("height_m", "1.72", 1.72),
        ("height", "1720", 1.72),
    ],
)
def test_stature_in_the_unit_of_its_label(tmp_path, label, text, height_m):
    found, _ = _read(tmp_path, f"id;{label};Body mass (kg)\nS01;{text};58,5\n")
    assert found == {"s01": Measured(58.5, height_m)}


def test_what_can_be_no_persons_is_named_with_its_line(tmp_path):
    found, notes = _read(tmp_path, "subject,mass_kg,height_cm,sex\nS1,700,1.7,x\nS2,sixty,,f\n", "manifest.csv")
    assert found == {"s1": Measured(), "s2": Measured(sex="f")}
    heavy, small, sex, words = notes
    assert says(heavy, "manifest.csv, line 2", "body mass", "700", "5 and 300 kg")
    assert says(small, "manifest.csv, line 2", "stature", "1.7 cm", "2.5 m")
    assert says(sex, "manifest.csv, line 2", "sex 'x'")
    assert says(words, "manifest.csv, line 3", "body mass 'sixty'")


def test_a_person_of_several_rows(tmp_path):
    """Of a session each: what agrees is taken."""
    found, notes = _read(tmp_path, "id,mass_kg,sex\nS1,40,f\nS1,44,f\n")
    assert found == {"s1": Measured(None, None, "f")}
    assert len(notes) == 1 and says(notes[0], "participants.tsv", "mass_kg of 's1'", "40.0, 44.0")


def test_a_mass_in_pounds_is_not_taken_for_kg(tmp_path):
    found, notes = _read(tmp_path, "id,weight (lb)\nS1,140\n")
    assert found == {} and says(notes[0], "columns are id")


def test_a_table_of_nobody(tmp_path):
    assert _read(tmp_path, "a,b\n1,2\n")[0] == {}
    found, notes = _read(tmp_path, "\n")
    assert found == {} and says(notes[-1], "left", "participants.tsv: participants.tsv")


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
