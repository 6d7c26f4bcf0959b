import re

import numpy as np
import pandas as pd
import pytest

from gaitdisc.report.figure import save_figure
from gaitdisc.report.modalities_figure import (
    ALL,
    falls,
    family_words,
    modalities_figure,
    modalities_sentences,
    modalities_table,
)
from gaitdisc.response.modalities import compare_modalities
from gaitdisc.results.variants import VariantRun, Variants

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
    return VariantRun("study", "exo", "modalities", tuple(people), compare_modalities(people), (), (7.5, 7.5))


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
    assert first.startswith("Of joint angles")
    assert "EMG soleus (0.2" in second
    assert "cannot replace" in last


def test_the_figure_says_n_and_split(tmp_path):
    figure = modalities_figure(variant_run())
    assert figure is not None
    assert "n = 8 participants" in figure.caption
    assert "last 7.5 s" in figure.caption
    save_figure(figure, tmp_path)
    assert (tmp_path / "modalities.csv").is_file()


def test_nobody_is_no_figure():
    assert modalities_figure(variant_run(0)) is None
    assert modalities_sentences(variant_run(0)) == ("Nobody's models could be fitted.",)


def test_families_are_named_as_they_are_read():
    assert family_words("hip_flexion") == "hip flexion"
