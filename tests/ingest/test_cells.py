"""Numbers of a table, and the words for what is none."""

from __future__ import annotations

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from hypothesis.extra.numpy import arrays

from gaitdisc.errors import ReadError
from gaitdisc.ingest.cells import Form, parsed_cells

LABELS = ["time", "a", "b"]


@given(arrays(float, st.tuples(st.integers(1, 6), st.just(3)), elements=st.floats(allow_infinity=False)))
def test_every_number_comes_back_to_the_last_bit(table):
    lines = ["\t".join(map(repr, row)) for row in table.tolist()]
    np.testing.assert_array_equal(parsed_cells(lines, LABELS, 1, Form("a.mot")).values, table)


@pytest.mark.parametrize("blank", ["", "  ", "nan", "NaN", "-nan(ind)", "1.#QNAN"])
def test_blank_cells_and_all_spellings_of_nan_are_missing(blank):
    cells = parsed_cells([f"0\t{blank}\t1", f"1\t2\t{blank}"], LABELS, 1, Form("a.mot"))
    np.testing.assert_array_equal(cells.values, [[0, np.nan, 1], [1, 2, np.nan]])


def test_trailing_tabs_and_blank_lines_are_passed_over():
    cells = parsed_cells(["0\t1\t2\t", "", "1\t2\t3\t\t", "2\t3\t4"], LABELS, 5, Form("a.mot"))
    assert cells.values[:, 2].tolist() == [2, 3, 4]
    assert cells.lines.tolist() == [5, 7, 8]
    assert cells.first_column == ["0", "1", "2"]


def test_blanks_separate_and_a_comma_may_be_the_decimal_sign():
    assert parsed_cells([" 0  1\t2"], LABELS, 1, Form("a", " ")).values.tolist() == [[0, 1, 2]]
    assert parsed_cells(["0,5;1;2,25"], LABELS, 1, Form("a", ";", ",")).values.tolist() == [[0.5, 1, 2.25]]
    assert parsed_cells(["0,5;-nan(ind);2,25"], LABELS, 1, Form("a", ";", ",")).values[0, 2] == 2.25


@pytest.mark.parametrize("word", ["abc", "1.2.3", "inf", "-Infinity", "1e999", "1_000", "0x10", "--"])
def test_a_cell_that_is_no_number_is_named_with_line_and_column(word):
    with pytest.raises(ReadError, match=r"a\.mot.*line 12.*'b'"):
        parsed_cells(["0\t1\t2", f"1\t2\t{word}"], LABELS, 11, Form("a.mot"))


def test_short_and_long_rows_are_named():
    with pytest.raises(ReadError, match=r"3 cells.*line 12.*2"):
        parsed_cells(["0\t1\t2", "1\t2"], LABELS, 11, Form("a.mot"))
    with pytest.raises(ReadError, match=r"line 11 has 2"):
        parsed_cells(["0\t1", "1\t2\t3"], LABELS, 11, Form("a.mot"))
    with pytest.raises(ReadError, match=r"line 12 has 4"):
        parsed_cells(["0\t1\t2", "1\t2\t3\t4"], LABELS, 11, Form("a.mot"))


def test_no_rows_are_refused():
    with pytest.raises(ReadError, match="none follow line 10"):
        parsed_cells(["", "  "], LABELS, 11, Form("a.mot"))
