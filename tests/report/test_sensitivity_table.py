import pandas as pd
import pytest

from gaitdisc.report.sensitivity_table import orders, sensitivity_sentences, sensitivity_table, setting_medians
from gaitdisc.response.sensitivity import AS_STUDIED, compare_settings
from gaitdisc.results.variants import VariantRun, Variants

MODELS = {"nominal": 0.8, "augmented": 0.9, "exo": 0.91}


def variant_run(count=8, four_hz=0.0):
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
    return VariantRun("study", "exo", "sensitivity", tuple(people), compare_settings(people), (), (7.5, 7.5))


def test_medians_of_a_setting():
    medians = setting_medians(variant_run()).set_index(["variant", "variables"])
    assert medians.loc[(AS_STUDIED, "angles"), "augmented"] == pytest.approx(0.9035)
    assert medians.loc[("angles 4 Hz", "EMG"), "nominal"] == pytest.approx(0.6035)
    assert set(medians["null"]) == {0.5}
    assert set(medians["participants"]) == {8}


def test_the_order_is_counted_in_people_and_in_variables():
    found = orders(variant_run(four_hz=0.2)).set_index("variant")
    assert found.loc[AS_STUDIED, ["participants", "holds", "variables", "different"]].tolist() == [8, 8, 3, 3]
    assert found.loc["angles 4 Hz", ["holds", "different"]].tolist() == [0, 0]


def test_the_table_has_a_row_a_setting():
    table = sensitivity_table(variant_run())
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
    assert sensitivity_table(variant_run(2)).rows[0][-2:] == ("2 of 2", "not tested")


def test_the_sentences_say_where_the_order_fails():
    assert sensitivity_sentences(variant_run())[0].startswith("In the medians, Nominal < Augmented holds in all of 4")
    said = sensitivity_sentences(variant_run(four_hz=0.2))
    assert "fails in 2 of 4 cases: angles 4 Hz (angles), angles 4 Hz (EMG)" in said[0]
    assert said[-1].startswith("EMG 4 Hz is left away for P00, P01, ")
    assert said[-1].endswith("too short; found 3 s")
    assert "rise above what noise reaches" in sensitivity_sentences(variant_run(four_hz=0.4))[1]
