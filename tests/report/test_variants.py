import re

import numpy as np
import pandas as pd
import pytest
from texts import says

from gaitdisc.report.variants import (
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
from gaitdisc.results.provenance import Refusal
from gaitdisc.results.variants import VARIANT_TEST_COLUMNS, VariantRun, Variants

VARIABLES = ("knee_angle_r", "ankle_angle_r", "emg_sol_r")
FALLS = {ALL: 0.0, "percent stride": 0.0, "ankle_angle": 0.05, "emg_sol": 0.2}


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
    assert "exceed the noise null" in sensitivity_sentences(variant_run_sensitivity(four_hz=0.4))[1]


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
