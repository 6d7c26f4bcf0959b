"""The page and its tables, as read and as numbers beside it."""

import os

import numpy as np
import pandas as pd
import pytest
from chapter3.pages import statements_table
from fresh_process import where, written
from further import write_page as write_study_page
from texts import says

import gaitdisc
from gaitdisc.own_files import claim_folder, guard
from gaitdisc.recording import Finding
from gaitdisc.report.page import Block, draw_side_by_side, save_block, write_page
from gaitdisc.report.table import (
    Table,
    flatten,
    provenance_rows,
    provenance_tables,
    save_table,
    save_tables,
    tabulate_findings,
    tabulate_refusals,
    words_table,
)
from gaitdisc.saved.provenance import Refusal


def test_a_page_lies_in_its_folder_and_says_the_version(tmp_path):
    page = write_page("blocks", {"title": "T", "about": "6 Hz & 30 s.", "blocks": []}, tmp_path / "new")
    assert page == tmp_path / "new" / "report.html"
    text = page.read_text(encoding="utf-8")
    assert says(text, "6 Hz", "30 s", f"{gaitdisc.__version__}.")
    assert "\r" not in page.read_bytes().decode()


def test_a_block_lies_on_disk_as_it_is_shown(tmp_path):
    table = Table("sizes", "n = 1", ("a",), (("1",),), pd.DataFrame({"a": [1]}))
    saved = save_block(Block("here", "Heading", ("Said.",), (), (table,)), tmp_path)
    assert (saved.anchor, saved.heading, saved.sentences, saved.figures) == ("here", "Heading", ("Said.",), ())
    assert (tmp_path / "tables" / "sizes.csv").read_text() == "a\n1\n"


def test_the_page_of_a_study_holds_its_blocks_and_all_tables_lie_beside_once_more_as_markdown(tmp_path):
    tables = tuple(statements_table([("3.4", "no error remains", "99.7 %")], name) for name in "st")
    blocks = [Block("a", "Stated", ("One sentence.",), tables=tables), Block("b", "Nothing", ("None.",))]
    page = write_study_page({}, blocks, "Chapter 3", "section 3.4", tmp_path).page
    text = page.read_text(encoding="utf-8")
    assert "One sentence." in text and "99.7" in text
    assert (tmp_path / "tables" / "s.csv").exists()
    table = "Stated\n\n| where | dissertation | ours |\n|---|---|---|\n| 3.4 | no error remains | 99.7 % |"
    assert (tmp_path / "tables.md").read_text(encoding="utf-8") == f"{table}\n\n{table}\n"


def test_few_are_drawn_here_and_many_elsewhere_in_order(monkeypatch):
    monkeypatch.setattr("gaitdisc.report.page.os.cpu_count", lambda: 2)
    few = draw_side_by_side(where, [("a",), ("b",)], 2)
    assert few == [("a", os.getpid()), ("b", os.getpid())]
    many = draw_side_by_side(where, [("a",), ("b",), ("c",)], 2)
    assert [word for word, _ in many] == ["a", "b", "c"] and os.getpid() not in {at for _, at in many}


@pytest.mark.parametrize("breaks", [False, True])  # the first in the processes of the test above
def test_what_other_processes_wrote_may_be_written_again(monkeypatch, tmp_path, breaks):
    monkeypatch.setattr("gaitdisc.report.page.os.cpu_count", lambda: 2)
    each = [(tmp_path, number, breaks, os.getpid()) for number in range(8)]
    with guard("gaitdisc test"):
        claim_folder(tmp_path)
        assert [draw_side_by_side(written, each, most) for most in (2, 8)] == [[None] * 8] * 2
    assert {path.read_text() for path in tmp_path.glob("*.txt")} == {"drawn"}


def test_one_processor_draws_alone(monkeypatch):
    monkeypatch.setattr("gaitdisc.report.page.MOST_PROCESSES", 1)
    assert {at for _, at in draw_side_by_side(where, [(k,) for k in range(4)], 2)} == {os.getpid()}


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
    table = tabulate_findings([gap], "Seen, n = 1.", "finding")
    assert table.rows == (("warning", "a.c3d", "knee_angle_r", "gap: 0.2 s missing", "the windows"),)
    assert table.columns[3] == "finding"
    assert table.numbers["finding"].tolist() == ["gap: 0.2 s missing"]


def test_who_is_left_out_as_a_whole_is_left_out_of_all_walks():
    table = tabulate_refusals(
        [Refusal("P01", "exo", "too short"), Refusal("P02", "", "excluded")], "refusals", "n = 2."
    )
    assert table.rows == (("P01", "exo", "too short"), ("P02", "all", "excluded"))
    assert table.name == "refusals"


def test_nothing_seen_leaves_the_headings():
    assert list(tabulate_findings([], "Seen, n = 0.").numbers.columns) == [
        "severity",
        "file",
        "channel",
        "what",
        "spoils",
    ]


def test_settings_become_rows():
    settings = {"a": {"b": [1, 2], "c": None}, "d": [{"e": 1}, {"e": 2}]}
    files = ["/home/someone/a.mot", "C:\\Users\\someone\\b.mot"]
    assert flatten({"files": files}) == [("files", "a.mot, b.mot")]
    assert flatten(settings) == [("a.b", "1, 2"), ("a.c", "None"), ("d.1.e", "1"), ("d.2.e", "2")]


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
