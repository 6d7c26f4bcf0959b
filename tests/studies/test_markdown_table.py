from markdown_table import markdown_table


def test_headings_are_parted_and_every_row_is_a_line():
    lines = markdown_table("walk | n|p [1]", [("straight", 6, "0.03"), ("turn", 5, "")]).splitlines()
    assert lines == ["| walk | n | p [1] |", "|---|---|---|", "| straight | 6 | 0.03 |", "| turn | 5 |  |"]
    assert markdown_table("a", []).splitlines() == ["| a |", "|---|"]
