from gaitdisc.recording import Finding
from gaitdisc.report.seen_tables import left_out_table, seen_table
from gaitdisc.results import Refusal


def test_a_finding_is_told_in_five_cells_and_as_csv():
    gap = Finding("warning", "gap", "a.c3d", "0.2 s missing", "the windows", "knee_angle_r")
    table = seen_table([gap], "Seen, n = 1.", "what was seen")
    assert table.rows == (("warning", "a.c3d", "knee_angle_r", "gap: 0.2 s missing", "the windows"),)
    assert table.columns[3] == "what was seen"
    assert table.numbers["what was seen"].tolist() == ["gap: 0.2 s missing"]


def test_who_is_left_out_as_a_whole_is_left_out_of_all_walks():
    table = left_out_table([Refusal("P01", "exo", "too short"), Refusal("P02", "", "excluded")], "refusals", "n = 2.")
    assert table.rows == (("P01", "exo", "too short"), ("P02", "all", "excluded"))
    assert table.name == "refusals"


def test_nothing_seen_leaves_the_headings():
    assert list(seen_table([], "Seen, n = 0.").numbers.columns) == ["severity", "file", "channel", "what", "spoils"]
