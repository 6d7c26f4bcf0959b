from markdown_table import markdown_table


def test_headings_are_parted_and_every_row_is_a_line():
    lines = markdown_table("walk | p [1]", [("straight", "0.03"), ("turn", "")]).splitlines()
    assert lines == ["| walk | p [1] |", "|---|---|", "| straight | 0.03 |", "| turn |  |"]
    assert markdown_table("a", []).splitlines() == ["| a |", "|---|"]
