from gaitdisc.chapters.pages.blocks_page import write_blocks, write_markdown
from gaitdisc.chapters.pages.discrepancy_tables import statements_table
from gaitdisc.report.block import Block


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
