from dataclasses import replace

import numpy as np

from gaitdisc.chapters.fields.field_cell import FieldCell, error_counts
from gaitdisc.chapters.pages.field_table import field_table, medians_table

COUNTS = error_counts(np.zeros(3), 1.0)
FIRST = FieldCell(
    "sea", "sst", "degC", "1 fixed", "temporal", "linear", 0.8, 0.52, 0, 1, 0.3, 100, 20, 1.0, 0, COUNTS
)  # fmt: skip


def test_a_row_a_route_and_a_star_for_the_least():
    cells = [
        replace(FIRST, model="POD ceiling", relative_l2=0.2), FIRST, replace(FIRST, model="shred", relative_l2=0.7),
        replace(FIRST, route="3 fixed", relative_l2=0.5), replace(FIRST, route="3 fixed", model="shred"),
    ]  # fmt: skip
    table = field_table(cells, "t", {("1 fixed", "temporal"): 0.0481})
    assert table.columns == ("route", "linear", "shred", "printed")
    assert table.groups == (("", 1), ("temporal", 3))
    assert table.rows[0] == ("1 fixed", "0.800 (0.52; 0.30)", "0.700* (0.52; 0.30)", "0.0481")
    assert table.rows[1] == ("3 fixed", "0.500* (0.52; 0.30)", "0.800 (0.52; 0.30)", "")
    assert "Bounds: temporal, POD ceiling: 0.200 (0.52; 0.30)." in table.caption
    assert "Test snapshots: temporal 20." in table.caption
    assert len(table.numbers) == 5


def test_medians_over_runs_with_their_range():
    runs = [replace(FIRST, run=k, relative_l2=0.1 * k, seconds=2.0) for k in (1, 2, 6)]
    ceiling = replace(FIRST, model="POD ceiling", relative_l2=0.05)
    table = medians_table([ceiling, ceiling, *runs], "m")
    assert table.rows[0][:6] == ("temporal", "POD ceiling", "", "1", "0.050", "0.050 to 0.050")
    assert table.rows[1] == (
        "temporal", "linear", "1 fixed", "3", "0.200", "0.100 to 0.600", "0.300", "+0.0000", "1.0000", "2.0"
    )  # fmt: skip
