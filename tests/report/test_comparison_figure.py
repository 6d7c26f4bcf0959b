import numpy as np
import pandas as pd
import pytest

from gaitdisc.report.comparison_figure import PLACES, comparison_figures
from gaitdisc.report.palette import MODELS


def bars(axes):
    """Ends of the bars, as (variable, models)."""
    found = set()
    for line in axes.get_lines():
        x = np.asarray(line.get_xdata())
        if len(x) == 4 and line.get_color() == "#111111":
            place = round((x[0] + x[-1]) / 2 + 0.01)
            ends = [min(PLACES, key=lambda m: abs(PLACES[m] + place - end)) for end in (x[0], x[-1])]
            found.add((place, *ends))
    return found


def test_a_bar_stands_where_the_test_finds_a_difference(tested):
    [figure] = comparison_figures(tested)
    wanted = {
        (tested.responses[0].outputs.index(row.variable), row.first, row.second)
        for row in tested.tests.tests.itertuples()
        if row.different and row.second != "perfect"
    }
    assert bars(figure.drawn.axes[0]) == wanted
    assert (1, "augmented", "exo") in wanted and (0, "augmented", "exo") not in wanted


def test_the_marks_are_the_numbers_of_the_csv(tested):
    [figure] = comparison_figures(tested)
    for model, look in MODELS.items():
        drawn = [
            line.get_ydata()
            for line in figure.drawn.axes[0].get_lines()
            if line.get_marker() == look.mark and line.get_color() == look.colour
        ]
        rows = figure.numbers[figure.numbers["model"] == model]
        assert sorted(np.concatenate(drawn)) == pytest.approx(sorted(rows["r2"]))
    assert len(figure.numbers) == 11 * 3 * 3


def test_words(tested):
    [figure] = comparison_figures(tested)
    assert "n = 11 participants; split: last 7.5 s" in figure.caption
    assert "Nominal and Exo differ in 3" in figure.alt
    assert "cut off" not in figure.caption


def test_what_lies_below_the_axis_is_counted(tested_maker):
    run = tested_maker(6, ("hip_flexion_r",))
    chosen = (run.responses[0].r2["model"] == "nominal") & (run.responses[0].r2["kind"] == "network")
    run.responses[0].r2.loc[chosen & (run.responses[0].r2["walk"] == "exo"), "r2"] = -7.5
    [figure] = comparison_figures(run)
    assert "1 value below −0.25 is cut off" in figure.caption
    assert figure.numbers["r2"].min() == -7.5


def test_many_variables_fill_several_figures(tested_maker):
    figures = comparison_figures(tested_maker(6, tuple(f"signal_{i}" for i in range(12))))
    assert [figure.name for figure in figures] == ["comparison-1", "comparison-2"]
    assert pd.concat([figure.numbers for figure in figures])["variable"].nunique() == 12


def test_without_tests_there_is_no_figure(tested_maker, run):
    assert comparison_figures(tested_maker(5)) == comparison_figures(run) == []
