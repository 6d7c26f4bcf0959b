from dataclasses import replace

import pandas as pd
import pytest

from gaitdisc.report.length_table import length_sentences, length_table
from gaitdisc.response.length_comparison import compare_lengths
from gaitdisc.results.data_quantity import QUANTITY_COLUMNS, DataQuantity

LOSS = {1.0: 0.1, 60.0: 0.0, 210.0: 0.0}


def quantity(i, lower_at_1):
    either_way = (-1) ** i * (0.001 + 0.0001 * i)  # as many above as below
    rows = []
    for length, loss in LOSS.items():
        for variable in ("hip_flexion_r", "knee_angle_r"):
            exo = 0.95 - loss + (either_way if length < 210.0 else 0.0)
            augmented = exo + either_way - (lower_at_1 if length == 1.0 else 0.0)
            rows += [(length, 100, variable, m, "network", "exo", r2, 3000)
                     for m, r2 in (("exo", exo), ("augmented", augmented))]  # fmt: skip
    return DataQuantity(f"P{i + 1:02d}", "first", pd.DataFrame(rows, columns=list(QUANTITY_COLUMNS)), {})


@pytest.fixture(scope="module")
def ablated(tested):
    def made(lower_at_1=0.05, people=11):
        quantities = tuple(quantity(i, lower_at_1) for i in range(people))
        over = replace(tested.over, lengths=compare_lengths(quantities))
        return replace(tested, quantities=quantities, over=over)

    return made


def test_one_row_a_length_with_what_differs(ablated):
    table = length_table(ablated())
    assert [row[:2] for row in table.rows] == [("1", "11"), ("60", "11")]
    assert table.rows[0][2:4] == ("2 of 2", "all")
    assert table.rows[0][5:7] == ("2 of 2", "all")
    assert table.rows[1][2:4] == ("0 of 2", "none")
    assert table.rows[0][7].startswith("0.10")
    assert "n = 11 participants" in table.caption


def test_what_is_enough_is_said_with_n(ablated):
    said = " ".join(length_sentences(ablated()))
    assert "(i) Augmented against Exo at the same length: a difference is shown at 1 s. From 60 s on none" in said
    assert "(ii) Exo against the Exo of the whole training part: from 60 s on no variable is shown to differ" in said
    assert "n = 11 participants: that no difference is shown is no equality" in said
    assert "no difference is shown at any length" in " ".join(length_sentences(ablated(0.0)))


def test_too_few_are_told_why(ablated):
    few = ablated(people=5)
    few = replace(few, over=replace(few.over, lengths_said="5 participants are too few"))
    assert length_table(few) is None
    assert length_sentences(few) == ["Training lengths are not tested: 5 participants are too few."]


def test_nothing_where_nothing_was_ablated(tested, run):
    assert length_sentences(tested) == []
    assert length_table(run) is None
