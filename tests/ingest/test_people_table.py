"""Mass, sex and stature from the table of people beside the recordings."""

from __future__ import annotations

from pathlib import Path

import pytest
from texts import says

from gaitdisc.ingest.people_table import Measured, measured_people


def _read(tmp_path, text, name="participants.tsv"):
    (tmp_path / name).write_text(text, encoding="utf-8")
    notes: list[str] = []
    return measured_people(tmp_path, [Path(name)], notes), notes


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
    assert says(heavy, "manifest.csv, line 2", "body mass", "700", "5 to 300 kg")
    assert says(small, "manifest.csv, line 2", "stature", "1.7 cm", "0.4 to 2.5 m")
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
