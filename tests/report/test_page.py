import os

import pandas as pd
from chapter3.pages import statements_table
from texts import says

import gaitdisc
from gaitdisc.report.page import Block, drawn_side_by_side, save_block, write_blocks, write_markdown, write_page
from gaitdisc.report.table import Table


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


def test_the_page_holds_its_blocks_and_the_tables_lie_beside(tmp_path):
    table = statements_table([("Fig. 3.3", "no error remains", "99.7 %")], "stated")
    page = write_blocks("Chapter 3", "About.", [Block("a", "Stated", ("One sentence.",), tables=(table,))], tmp_path)
    text = page.read_text(encoding="utf-8")
    assert "One sentence." in text
    assert "99.7" in text
    assert (tmp_path / "tables" / "stated.csv").exists()


def test_all_tables_once_more_as_markdown(tmp_path):
    block = Block("a", "Stated", (), tables=tuple(statements_table([("3.4", "a", "b")], name) for name in "st"))
    text = write_markdown([block, Block("b", "Nothing", ("One sentence.",))], tmp_path).read_text(encoding="utf-8")
    table = "Stated\n\n| where | dissertation | ours |\n|---|---|---|\n| 3.4 | a | b |"
    assert text == f"{table}\n\n{table}\n"


def _where(word):
    return word, os.getpid()


def test_few_are_drawn_here_and_many_elsewhere_in_order(monkeypatch):
    monkeypatch.setattr("gaitdisc.report.page.os.cpu_count", lambda: 2)
    few = drawn_side_by_side(_where, [("a",), ("b",)], 2)
    assert few == [("a", os.getpid()), ("b", os.getpid())]
    many = drawn_side_by_side(_where, [("a",), ("b",), ("c",)], 2)
    assert [word for word, _ in many] == ["a", "b", "c"] and os.getpid() not in {at for _, at in many}


def test_one_processor_draws_alone(monkeypatch):
    monkeypatch.setattr("gaitdisc.report.page.MOST_PROCESSES", 1)
    assert {at for _, at in drawn_side_by_side(_where, [(k,) for k in range(4)], 2)} == {os.getpid()}
