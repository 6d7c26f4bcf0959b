from dataclasses import replace

import pandas as pd
import pytest
from texts import says

from gaitdisc.report.data_quantity import (
    length_sentences,
    length_table,
    quantity_figure,
    quantity_numbers,
    quantity_sentences,
)
from gaitdisc.report.response_page import write_report
from gaitdisc.response.over_participants import compare_lengths
from gaitdisc.results.over_participants import OVER
from gaitdisc.results.participant_response import QUANTITY, QUANTITY_COLUMNS, DataQuantity

ONE = ("hip_flexion_r",)  # what else the page shows is drawn of one variable


def quantity(participant, rises):
    rows = [
        (length, int(100 * length), variable, model, "network", "exo", r2 + more, 300)
        for length, r2 in rises.items()
        for variable, less in (("knee_angle_r", 0.0), ("ankle_angle_r", 0.02), ("emg_sol_r", -0.2))
        for model, more in (("nominal", less - 0.1), ("augmented", less), ("exo", less))
    ]
    table = pd.DataFrame(rows, columns=pd.Index(QUANTITY_COLUMNS))
    return DataQuantity(participant, "first", table, {180.0: "the training part is 52.2 s"})


@pytest.fixture
def run(run_maker):
    rises = {1.0: 0.2, 10.0: 0.8, 30.0: 0.894, 52.2: 0.9}
    return run_maker(2, outputs=ONE).with_units(QUANTITY, (quantity("P01", rises), quantity("P02", rises)))


def test_numbers_are_medians_over_the_variables_of_a_group(run):
    numbers = quantity_numbers(run)
    chosen = numbers[(numbers["participant"] == "P01") & (numbers["model"] == "exo") & (numbers["length_s"] == 10.0)]
    by_group = chosen.set_index("variables")
    assert by_group.loc["angles", "r2"] == pytest.approx(0.81)
    assert by_group.loc["EMG", "r2"] == pytest.approx(0.6)
    assert by_group.loc["angles", "count"] == 2


def test_what_is_drawn_is_what_lies_beside_it(run):
    figure = quantity_figure(run)
    drawn = {tuple(line.get_ydata()) for axes in figure.drawn.axes for line in axes.get_lines()}
    for _, one in figure.numbers.groupby(["variables", "participant", "model"]):
        assert tuple(one["r2"]) in drawn
    assert "n = 2 participants" in figure.caption and "Fig. 4.4" in figure.caption


def test_sentences_say_how_much_is_enough_and_what_was_left_away(run):
    first, left = quantity_sentences(run)
    assert says(first, "2 participants", "0.01")
    assert says(first, "52 s", "0.90", "30 s")
    assert first.endswith("medians and ranges over participants.")
    assert left.endswith("180 s.")


@pytest.mark.usefixtures("unpainted")
def test_a_run_that_was_not_ablated_has_no_such_figure(run_maker, tmp_path):
    assert quantity_figure(run_maker(1, outputs=ONE)) is None
    assert quantity_sentences(run_maker(1, outputs=ONE)) == []
    assert "How much data" not in write_report(run_maker(1, outputs=ONE), tmp_path).read_text(encoding="utf-8")


LOSS = {1.0: 0.1, 60.0: 0.0, 210.0: 0.0}


def quantity_length(i, lower_at_1):
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
        quantities = tuple(quantity_length(i, lower_at_1) for i in range(people))
        over = replace(tested.over, lengths=compare_lengths(quantities))
        return tested.with_units(QUANTITY, quantities).with_units(OVER, (over,))

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
    assert says(said, "1 s", "60 s", "not")
    assert says(said, "entire training part", "60 s", "no")
    assert says(said, "n = 11 participants", "non-significant", "not")
    assert says(" ".join(length_sentences(ablated(0.0))), "do not differ significantly")


def test_too_few_get_a_reason(ablated):
    few = ablated(people=5)
    few = few.with_units(OVER, (replace(few.over, lengths_said="5 participants are too few"),))
    assert length_table(few) is None
    (said,) = length_sentences(few)
    assert says(said, "not tested", "5 participants are too few")


def test_nothing_where_nothing_was_ablated(tested, run):
    assert length_sentences(tested) == []
    assert length_table(run) is None
