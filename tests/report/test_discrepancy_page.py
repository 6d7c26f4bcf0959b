from gaitdisc.report.block import Block
from gaitdisc.report.discrepancy_page import write_blocks
from gaitdisc.report.discrepancy_tables import statements_table


def test_the_page_holds_its_blocks_and_the_tables_lie_beside(tmp_path):
    table = statements_table([("Fig. 3.3", "no error remains", "99.7 %")], "stated")
    page = write_blocks("Chapter 3", "About.", [Block("a", "Stated", ("One sentence.",), tables=(table,))], tmp_path)
    text = page.read_text(encoding="utf-8")
    assert "One sentence." in text
    assert "99.7" in text
    assert (tmp_path / "tables" / "stated.csv").exists()
