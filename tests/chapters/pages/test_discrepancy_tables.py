from dataclasses import replace

import numpy as np

from gaitdisc.chapters.discrepancy.discrepancy_cell import PARTS, DiscrepancyCell, PartAccuracy
from gaitdisc.chapters.pages.discrepancy_tables import grid_table
from gaitdisc.report.table import as_markdown

TIME = np.arange(301) / 10
TRUTH = np.sin(TIME)[:, None]


def cell(augmented, diverged, seed=0):
    names = dict.fromkeys(PARTS, PartAccuracy(TIME, TRUTH, TRUTH + 0.2, augmented, diverged))
    return DiscrepancyCell("s", "gp", "state", "right", 0.1, seed, ("x",), names, 1.0, 0.1)


def test_a_cell_that_diverged_is_a_time_and_never_a_number():
    lost = np.where(TIME[:, None] > 3, np.nan, TRUTH)
    table = grid_table([cell(lost, 3.0), cell(TRUTH + 0.1, None, seed=1)], "t")
    assert table.rows[0][6] == "diverged at t = 3.00 s (1 of 2 seeds)"


def test_a_cell_is_its_accuracy_and_a_table_is_markdown():
    table = grid_table([cell(TRUTH + 0.1, None)], "t")
    assert table.rows[0][6] == "50.0"
    assert as_markdown(table).count("\n") == 2


def test_what_was_refused_says_so():
    refused = DiscrepancyCell("s", "gp", "state", "right", 0.1, 0, ("x",), {}, 1.0, 0.0, refused="40 too few")
    row = grid_table([refused], "t").rows[0]
    assert row[5] == "not fitted"
    assert row[-1] == "40 too few"


def test_seeds_are_told_as_median_and_range_and_their_terms_are_counted():
    cells = [replace(cell(TRUTH + off, None, k), terms=terms) for k, (off, terms) in enumerate(
        [(0.1, "x: -0.01*x**3"), (0.05, "x: -0.0101*x**3"), (0.15, "x: 1e-05*1")])]  # fmt: skip
    row = grid_table(cells, "t").rows[0]
    assert (row[4], row[6]) == ("3", "50.0 [25.0, 75.0]")
    assert row[-1] == "x: -0.01*x**3 (the same terms in 2 of 3 seeds)"


def test_what_some_seeds_refused_is_counted():
    refused = replace(cell(TRUTH, None, 1), parts={}, refused="40 too few")
    row = grid_table([cell(TRUTH + 0.1, None), refused], "t").rows[0]
    assert row[6] == "50.0 (1 of 2 seeds)"
    assert row[-1] == "40 too few (1 of 2 seeds)"


def test_an_error_of_many_times_the_known_one_is_no_number_to_four_digits():
    cells = [cell(TRUTH + off, None, k) for k, off in enumerate((0.1, 0.05, 2.1, 2.3, 9e3))]  # known: 0.2
    assert grid_table(cells, "t").rows[0][6] == "-950.0 [below -1000, 75.0]"
