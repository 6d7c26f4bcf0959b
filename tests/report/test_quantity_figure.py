from dataclasses import replace

import pandas as pd
import pytest

from gaitdisc.report.quantity_figure import quantity_figure, quantity_numbers, quantity_sentences
from gaitdisc.report.response_page import write_report
from gaitdisc.results import DataQuantity
from gaitdisc.results.data_quantity import QUANTITY_COLUMNS

ONE = ("hip_flexion_r",)  # what else the page shows is drawn of one variable


def quantity(participant, rises):
    rows = [
        (length, int(100 * length), variable, model, "network", "exo", r2 + more, 300)
        for length, r2 in rises.items()
        for variable, less in (("knee_angle_r", 0.0), ("ankle_angle_r", 0.02), ("emg_sol_r", -0.2))
        for model, more in (("nominal", less - 0.1), ("augmented", less), ("exo", less))
    ]
    table = pd.DataFrame(rows, columns=pd.Index(QUANTITY_COLUMNS))
    return DataQuantity(participant, "first", table, {180.0: "the training part has 52.2 s"})


@pytest.fixture
def run(run_maker):
    rises = {1.0: 0.2, 10.0: 0.8, 30.0: 0.894, 52.2: 0.9}
    return replace(run_maker(2, outputs=ONE), quantities=(quantity("P01", rises), quantity("P02", rises)))


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
    assert first.startswith("Over 2 participants, the Exo model comes within 0.01")
    assert "of what all 52 s of training give (R² 0.90, median over variables) from 30 s on" in first
    assert first.endswith("medians and ranges over participants.")
    assert left.endswith("180 s.")


@pytest.mark.usefixtures("unpainted")
def test_a_run_that_was_not_ablated_has_no_such_figure(run_maker, tmp_path):
    assert quantity_figure(run_maker(1, outputs=ONE)) is None
    assert quantity_sentences(run_maker(1, outputs=ONE)) == []
    assert "How much data" not in write_report(run_maker(1, outputs=ONE), tmp_path).read_text(encoding="utf-8")


@pytest.mark.usefixtures("unpainted")
def test_the_page_shows_it(run, tmp_path):
    page = write_report(run, tmp_path).read_text(encoding="utf-8")
    assert "How much data is enough" in page
    assert (tmp_path / "figures" / "quantity.csv").exists()
