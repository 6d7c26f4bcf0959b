from dataclasses import replace

import numpy as np
import pandas as pd
import pytest
from texts import says

from gaitdisc.report.pair_tests import PLACES, comparison_figures, comparison_sentences, comparison_tables, p_text
from gaitdisc.report.panels import MODELS
from gaitdisc.results.over_participants import TESTS
from gaitdisc.results.participant_response import RESPONSE


def test_a_table_a_pair_and_one_of_the_families(tested):
    tables = {table.name: table for table in comparison_tables(tested)}
    assert list(tables) == [
        "tests-nominal-augmented",
        "tests-nominal-exo",
        "tests-augmented-exo",
        "tests-exo-perfect",
        "tests-families",
    ]
    for table in list(tables.values())[:4]:
        assert sum(span for _, span in table.groups) == len(table.columns) == len(table.rows[0])
        assert says(table.caption, "n = 11 participants", "3 tests")
    explained, *others = [table.caption for table in list(tables.values())[:4]]
    assert "Hodges-Lehmann" in explained
    assert all(says(caption, "columns as for", "Nominal and Augmented") for caption in others)
    row = dict(zip(tables["tests-augmented-exo"].columns, tables["tests-augmented-exo"].rows[1], strict=True))
    assert row["variable"] == "ankle angle, left"
    assert (row["n"], row["zeros"], row["W"], row["p"], row["adjusted p"]) == ("11", "0", "0", "0.000977", "0.00293")
    assert (row["level of its step"], row["Exo is"], row["rank-biserial"]) == ("0.0170", "higher", "1.00")
    assert abs(float(row["shift [95 %]"].split()[0]) - 0.02) < 0.001


def test_the_families_say_how_many_tests_and_which_level(tested):
    rows = comparison_tables(tested)[-1].rows
    assert [row[2] for row in rows] == ["3", "3", "3", "9", "9", "9", "3", "3", "3"]
    assert rows[0][3:5] == ("0.0500", "3 of 3")
    assert rows[2][5] == "ankle angle, left"


def test_what_is_said(tested):
    said = " ".join(comparison_sentences(tested))
    assert says(said, "more", "1 of 3 variables", "left")
    assert says(said, "more", "3 of 3 variables")
    assert says(said, "A difference that", "not", "not")
    assert says(said, "n = 11", "0.000977", "3 tests 0.00293")
    assert says(said, "9 tests", "7 over")


def test_a_model_that_is_worse_is_said_to_be_worse(tested):
    worse = replace(tested.tests, tests=tested.tests.tests.assign(rank_biserial=-1.0))
    said = comparison_sentences(tested.with_units(TESTS, (worse,)))
    assert says(said[0], "less", "3 of 3 variables")


def test_no_difference_is_said_plainly(tested):
    none = replace(tested.tests, tests=tested.tests.tests.assign(different=False))
    said = comparison_sentences(tested.with_units(TESTS, (none,)))
    assert says(said[2], "no", "3 variables")
    row = comparison_tables(tested.with_units(TESTS, (none,)))[0].rows[0]
    assert "not shown" in row


def test_too_few_are_said_and_not_tabled(tested_maker, run):
    few = tested_maker(4)
    assert comparison_tables(few) == []
    assert says(comparison_sentences(few)[0], "4 participants", "0.125")
    assert comparison_sentences(run) == comparison_tables(run) == []


def test_a_variable_that_was_not_tested_says_so(tested_maker):
    run = tested_maker(6)
    from gaitdisc.response.over_participants import compare_models

    def without_soleus(response):
        return replace(
            response, r2=response.r2.assign(r2=response.r2["r2"].where(response.r2["variable"] != "emg_sol_r"))
        )

    responses = (*(without_soleus(one) for one in run.responses[:2]), *run.responses[2:])
    run = run.with_units(RESPONSE, responses).with_units(TESTS, (compare_models(responses),))
    table = comparison_tables(run)[0]
    assert table.rows[2][3:5] == ("4", "not tested")
    assert "Holm-Sidak over 2 tests" in table.caption
    assert says(table.caption, "EMG", "right: not", "P01, P02")


def test_p_in_three_figures():
    assert [p_text(p) for p in (1.0, 0.04199, 2e-6)] == ["1", "0.042", "<0.0001"]


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
    assert says(figure.caption, "n = 11 participants", "7.5 s")
    assert says(figure.alt, "Nominal and Exo", "3")
    assert "cut off" not in figure.caption


def test_what_lies_below_the_axis_is_counted(tested_maker):
    run = tested_maker(6, ("hip_flexion_r",))
    chosen = (run.responses[0].r2["model"] == "nominal") & (run.responses[0].r2["kind"] == "network")
    run.responses[0].r2.loc[chosen & (run.responses[0].r2["walk"] == "exo"), "r2"] = -7.5
    [figure] = comparison_figures(run)
    assert says(figure.caption, "1 value below −0.25")
    assert figure.numbers["r2"].min() == -7.5


def test_many_variables_fill_several_figures(tested_maker):
    figures = comparison_figures(tested_maker(6, tuple(f"signal_{i}" for i in range(12))))
    assert [figure.name for figure in figures] == ["comparison-1", "comparison-2"]
    assert pd.concat([figure.numbers for figure in figures])["variable"].nunique() == 12


def test_without_tests_there_is_no_figure(tested_maker, run):
    assert comparison_figures(tested_maker(5)) == comparison_figures(run) == []
