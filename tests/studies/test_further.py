"""Tables of chapters 4 and 5 beyond their figures: what is printed is what was kept, and a table is computed once."""

import importlib
from argparse import Namespace
from pathlib import Path

import further
import numpy as np
import pandas as pd
import pytest
from markdown_table import markdown_table
from texts import says

STUDIES = Path(__file__).parents[2] / "studies"


def given(folder, **other):
    return Namespace(**{"folder": folder, "tables": ["one"], "quick": True, "keep": True, "print": "", **other})


def test_a_table_is_computed_once_kept_and_printed_again(tmp_path, capsys):
    calls = []

    def computed(quick):
        calls.append(quick)
        for who, value in (("a", 1.0), ("b", 3.0), ("c", np.nan)):
            yield further.Number("ridge", "RMSE [deg]", who, value)
        yield further.Number("null", "RMSE [deg]", "", 4.0)

    tables = {"one": further.Made(computed, "running")}
    further.main(given(tmp_path / "out"), tables, tmp_path / "kept.csv")
    first = capsys.readouterr().out
    further.main(given(tmp_path / "out"), tables, tmp_path / "kept.csv")
    further.main(given(tmp_path / "elsewhere", print="one"), tables, tmp_path / "kept.csv")
    assert capsys.readouterr().out == first * 2
    assert calls == [True]
    further.main(given(tmp_path / "later", tables=["two"]), {"two": tables["one"]}, tmp_path / "kept.csv")
    assert set(pd.read_csv(tmp_path / "kept.csv")["table"]) == {"one", "two"}  # what is kept of others stays
    assert says(first, "ridge | 2 [1, 3]", "n = 2 people", "1 diverged |")
    assert "| null | 4 |" in first


@pytest.mark.parametrize("name", ["ch4_further", "ch5_further"])
def test_every_table_of_a_study_is_kept(name):
    tables = importlib.import_module(name).TABLES
    kept = pd.read_csv(STUDIES / f"{name}.csv")
    assert set(kept["table"]) == set(tables)
    assert list(kept) == ["table", *further.Number._fields]


def test_power_is_told_within_people_better_than_by_shuffled_settings(gait_data):
    rows = pd.DataFrame(importlib.import_module("ch4_further").energy(True)).set_index(["row", "column"])["value"]
    found = rows["both, means"]
    within = "within persons: R2 [1]"
    [highest] = [value for name, value in found.items() if says(str(name), "95 %", "shuffled")]
    [known] = [value for (row, column), value in rows.items() if row.startswith("setting known") and column == within]
    assert highest < found[within] < known


def test_headings_are_parted_and_every_row_is_a_line():
    lines = markdown_table("walk | p [1]", [("straight", "0.03"), ("turn", "")]).splitlines()
    assert lines == ["| walk | p [1] |", "|---|---|", "| straight | 0.03 |", "| turn |  |"]
    assert markdown_table("a", []).splitlines() == ["| a |", "|---|"]
