import numpy as np
import pandas as pd

from gaitdisc.recording import Finding
from gaitdisc.report.table import (
    flattened,
    left_out_table,
    provenance_rows,
    provenance_tables,
    save_table,
    save_tables,
    seen_table,
    words_table,
)
from gaitdisc.results.provenance import Refusal


def test_tables_are_written_without_index(tmp_path):
    save_table(pd.DataFrame({"a": [1.0, np.nan]}), tmp_path / "t.csv")
    assert (tmp_path / "t.csv").read_text() == 'a\n1\n""\n'


def test_words():
    assert words_table("files", "Files.", ("file", "SHA-256"), [("a.c3d", "ff")]).rows == (("a.c3d", "ff"),)


def test_the_numbers_lie_under_the_name_of_their_table(tmp_path):
    tables = [words_table(name, "", ("what", "value"), [("a", name)]) for name in ("first", "second")]
    save_tables(tables, tmp_path)
    assert (tmp_path / "tables" / "second.csv").read_text() == "what,value\na,second\n"
    assert len(list((tmp_path / "tables").iterdir())) == 2


def test_a_finding_is_written_in_five_cells_and_as_csv():
    gap = Finding("warning", "gap", "a.c3d", "0.2 s missing", "the windows", "knee_angle_r")
    table = seen_table([gap], "Seen, n = 1.", "finding")
    assert table.rows == (("warning", "a.c3d", "knee_angle_r", "gap: 0.2 s missing", "the windows"),)
    assert table.columns[3] == "finding"
    assert table.numbers["finding"].tolist() == ["gap: 0.2 s missing"]


def test_who_is_left_out_as_a_whole_is_left_out_of_all_walks():
    table = left_out_table([Refusal("P01", "exo", "too short"), Refusal("P02", "", "excluded")], "refusals", "n = 2.")
    assert table.rows == (("P01", "exo", "too short"), ("P02", "all", "excluded"))
    assert table.name == "refusals"


def test_nothing_seen_leaves_the_headings():
    assert list(seen_table([], "Seen, n = 0.").numbers.columns) == ["severity", "file", "channel", "what", "spoils"]


def test_settings_become_rows():
    settings = {"a": {"b": [1, 2], "c": None}, "d": [{"e": 1}, {"e": 2}]}
    files = ["/home/someone/a.mot", "C:\\Users\\someone\\b.mot"]
    assert flattened({"files": files}) == [("files", "a.mot, b.mot")]
    assert flattened(settings) == [("a.b", "1, 2"), ("a.c", "None"), ("d.1.e", "1"), ("d.2.e", "2")]


def test_provenance(run):
    rows = dict(provenance_rows(run.provenance))
    assert rows["follows section"] == "4.2"
    assert rows["version of numpy"] == "2.4.6"


def test_every_page_has_the_same_three_tables(run):
    tables = provenance_tables(run.provenance)
    assert list(tables) == [table.name for table in tables.values()] == ["settings", "versions", "files"]
    assert tables["files"].rows == tuple(sorted(run.provenance.files.items()))
    assert tables["files"].caption == f"Files read, n = {len(run.provenance.files)}, with their SHA-256."
    assert tables["versions"].rows[0] == ("follows section", "4.2")
