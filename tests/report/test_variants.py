"""Pages of what is varied: inputs left away, settings, training lengths."""

import re
from dataclasses import replace
from functools import cache

import numpy as np
import pandas as pd
import pytest
from texts import says

from gaitdisc.response.data_quantity_page import (
    length_sentences,
    length_table,
    quantity_figure,
    quantity_numbers,
    quantity_sentences,
)
from gaitdisc.response.over_participants import compare_lengths
from gaitdisc.response.page import write_report
from gaitdisc.response.participant_response import QUANTITY, QUANTITY_COLUMNS, DataQuantity
from gaitdisc.response.participants_result import OVER
from gaitdisc.response.variants import VARIANT_TEST_COLUMNS, VariantRun, Variants
from gaitdisc.response.variants_page import (
    ALL,
    falls,
    modalities_figure,
    modalities_sentences,
    modalities_table,
    orders,
    sensitivity_sentences,
    sensitivity_table,
    setting_medians,
    variant_sentences,
    variant_tables,
    write_variants,
)
from gaitdisc.response.vary import AS_STUDIED, compare_variants
from gaitdisc.saved.provenance import Refusal

VARIABLES = ("knee_angle_r", "ankle_angle_r", "emg_sol_r")
FALLS = {ALL: 0.0, "percent stride": 0.0, "ankle_angle": 0.05, "emg_sol": 0.2}


@cache
def variant_run(count=8):
    people = []
    for number in range(count):
        rng = np.random.default_rng(number)
        rows = [
            (variant, variable, model, kind, 0.9 - fall * (variable == "emg_sol_r" or 0.1) + 0.001 * rng.normal(), 99)
            for variant, fall in FALLS.items()
            for variable in VARIABLES
            for model in ("augmented", "exo")
            for kind in ("network", "ridge")
        ]
        table = pd.DataFrame(rows, columns=["variant", "variable", "model", "kind", "r2", "n"])
        people.append(Variants(f"P{number:02d}", "modalities", table, {}))
    return VariantRun(
        "study", "exo", "modalities", tuple(people), compare_variants(people, "modalities"), (), (7.5, 7.5)
    )


def test_falls_are_medians_over_the_variables_of_a_group():
    table = falls(variant_run())
    middle = table.groupby(["variables", "without", "model"])["fall"].median()
    assert middle["EMG", "emg_sol", "augmented"] == pytest.approx(0.2, abs=0.005)
    assert middle["angles", "emg_sol", "exo"] == pytest.approx(0.02, abs=0.005)
    assert ALL not in set(table["without"])
    assert len(table) == 8 * 2 * 2 * 3


def test_the_table_stars_what_is_shown_to_differ():
    table = modalities_table(variant_run())
    rows = {row[0]: row[1:] for row in table.rows}
    assert table.columns == ("without", "knee angle, right", "ankle angle, right", "EMG soleus, right")
    assert re.fullmatch(r"−0.(19|20)\d\*", rows["EMG soleus"][2])
    assert not rows["percent stride"][2].endswith("*")
    assert "n = 8 participants" in table.caption


def test_the_sentences_name_the_largest_falls_and_what_they_cannot_say():
    first, second, last = modalities_sentences(variant_run())
    assert first.startswith("Among joint angles")
    assert "EMG soleus (0.2" in second
    assert "cannot replace" in last


def test_nobody_is_no_figure():
    assert modalities_figure(variant_run(0)) is None
    assert modalities_sentences(variant_run(0)) == ("No participant's models could be fitted.",)


MODELS = {"nominal": 0.8, "augmented": 0.9, "exo": 0.91}


@cache
def variant_run_sensitivity(count=8, four_hz=0.0):
    """Under 4 Hz the Augmented model gets `four_hz` less."""
    people = []
    for number in range(count):
        rows = []
        for variant in (AS_STUDIED, "angles 4 Hz"):
            for place, variable in enumerate(("knee_angle_r", "hip_flexion_r", "emg_sol_r")):
                for model, value in MODELS.items():
                    less = four_hz if (variant, model) == ("angles 4 Hz", "augmented") else 0.0
                    own = value - less + 0.001 * number - 0.2 * (place == 2)
                    rows += [(variant, variable, model, kind, own, 99) for kind in ("network", "ridge")]
                rows.append((variant, variable, "nominal", "null", 0.5, 99))
        table = pd.DataFrame(rows, columns=["variant", "variable", "model", "kind", "r2", "n"])
        people.append(Variants(f"P{number:02d}", "sensitivity", table, {"EMG 4 Hz": "too short; found 3 s"}))
    return VariantRun(
        "study", "exo", "sensitivity", tuple(people), compare_variants(people, "sensitivity"), (), (7.5, 7.5)
    )


def test_medians_of_a_setting():
    medians = setting_medians(variant_run_sensitivity()).set_index(["variant", "variables"])
    assert medians.loc[(AS_STUDIED, "angles"), "augmented"] == pytest.approx(0.9035)
    assert medians.loc[("angles 4 Hz", "EMG"), "nominal"] == pytest.approx(0.6035)
    assert set(medians["null"]) == {0.5}
    assert set(medians["participants"]) == {8}


def test_the_order_is_counted_in_people_and_in_variables():
    found = orders(variant_run_sensitivity(four_hz=0.2)).set_index("variant")
    assert found.loc[AS_STUDIED, ["participants", "holds", "variables", "different"]].tolist() == [8, 8, 3, 3]
    assert found.loc["angles 4 Hz", ["holds", "different"]].tolist() == [0, 0]


def test_the_table_has_a_row_a_setting():
    table = sensitivity_table(variant_run_sensitivity())
    assert [row[0] for row in table.rows] == [AS_STUDIED, "angles 4 Hz"]
    assert table.rows[0] == (
        AS_STUDIED,
        "0.80",
        "0.90",
        "0.91",
        "0.50",
        "0.60",
        "0.70",
        "0.71",
        "0.50",
        "8 of 8",
        "3 of 3",
    )
    assert sum(span for _, span in table.groups) == len(table.columns) == len(table.rows[0])


def test_few_people_are_not_tested():
    assert sensitivity_table(variant_run_sensitivity(2)).rows[0][-2:] == ("2 of 2", "not tested")


def test_the_sentences_say_where_the_order_fails():
    assert says(sensitivity_sentences(variant_run_sensitivity())[0], "Nominal < Augmented", "4")
    said = sensitivity_sentences(variant_run_sensitivity(four_hz=0.2))
    assert says(said[0], "fails", "2 of 4 cases", "4 Hz", "4 Hz (EMG)")
    assert says(said[-1], "EMG 4 Hz", "left", "P00, P01")
    assert said[-1].endswith("too short; found 3 s")
    assert "exceed band-limited noise" in sensitivity_sentences(variant_run_sensitivity(four_hz=0.4))[1]


NO_TESTS = pd.DataFrame(columns=pd.Index(VARIANT_TEST_COLUMNS))


def variant_run_page(question, variants):
    rows = [
        (variant, variable, model, "network", 0.5 + 0.1 * place, 99)
        for variant in variants
        for variable in ("knee_angle_r", "emg_sol_r")
        for place, model in enumerate(("nominal", "augmented", "exo"))
    ]
    table = pd.DataFrame(rows, columns=["variant", "variable", "model", "kind", "r2", "n"])
    people = (Variants("P01", question, table, {}),)
    refusals = (Refusal("P02", "exo", "the gait <changes>"),)
    return VariantRun("a study", "exo", question, people, NO_TESTS, refusals, (7.5, 7.5))


def test_a_page_stands_alone_and_is_the_same_each_time(tmp_path):
    for question, variants in (("modalities", ("all inputs", "EMG")), ("sensitivity", ("as in the study", "EMG 4 Hz"))):
        run = variant_run_page(question, variants)
        page = write_variants(run, tmp_path / question)
        text = page.read_text(encoding="utf-8")
        assert "the gait &lt;changes&gt;" in text
        assert "<script" not in text
        assert 'src="http' not in text
        assert (tmp_path / question / "tables" / "r2.csv").is_file()
        assert write_variants(run, tmp_path / question).read_text(encoding="utf-8") == text


def test_nobody_is_said(tmp_path):
    run = VariantRun("a study", "exo", "sensitivity", (), NO_TESTS, (), (0.0, 0.0))
    assert variant_tables(run) == []
    assert variant_sentences(run) == ("No participant's models could be fitted.",)
    assert "No participant" in write_variants(run, tmp_path).read_text(encoding="utf-8")


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
    assert says(" ".join(length_sentences(ablated(0.0))), "no variable differs significantly")


def test_too_few_get_a_reason(ablated):
    few = ablated(people=5)
    few = few.with_units(OVER, (replace(few.over, lengths_said="5 participants are too few"),))
    assert length_table(few) is None
    (said,) = length_sentences(few)
    assert says(said, "not tested", "5 participants are too few")


def test_nothing_where_nothing_was_ablated(tested, run):
    assert length_sentences(tested) == []
    assert length_table(run) is None
