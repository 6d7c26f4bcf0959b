"""What all participants say together: tests of pairs, other comparisons, their tables and figures."""

from dataclasses import replace

import numpy as np
import pandas as pd
import pytest
from texts import says

from gaitdisc.report.panels import MODELS
from gaitdisc.response.over_participants import compare_participants
from gaitdisc.response.over_participants_page import (
    baseline_sentences,
    baseline_table,
    over_blocks,
    reduction_figure,
    reduction_sentences,
    reduction_table,
    responder_sentences,
    responder_table,
)
from gaitdisc.response.pair_tests import PLACES, comparison_figures, comparison_sentences, comparison_tables, p_text
from gaitdisc.response.participant_response import RESPONSE
from gaitdisc.response.participants_result import OVER, TESTS


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
    assert (row["Holm-Sidak level"], row["Exo is"], row["rank-biserial"]) == ("0.0170", "higher", "1.00")
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
    assert says(said, "non-significant difference", "not")
    assert says(said, "n = 11", "0.000977", "tests")
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
    assert "not significant" in row


def test_too_few_are_said_and_not_tabled(tested_maker, run):
    few = tested_maker(4)
    assert comparison_tables(few) == []
    assert says(comparison_sentences(few)[0], "4 participants", "0.125")
    assert comparison_sentences(run) == comparison_tables(run) == []


def test_a_variable_that_was_not_tested_says_so(tested_maker):
    run = tested_maker(6)
    from gaitdisc.response.over_participants import compare_models

    def without_soleus(response):
        table = response.r2
        return replace(response, r2=table.assign(r2=table["r2"].where(table["variable"] != "emg_sol_r")))

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
    figures = comparison_figures(tested_maker(6, tuple(f"signal_{i}" for i in range(11))))
    assert [figure.name for figure in figures] == ["comparison-1", "comparison-2"]
    assert pd.concat([figure.numbers for figure in figures])["variable"].nunique() == 11


def test_without_tests_there_is_no_figure(tested_maker, run):
    assert comparison_figures(tested_maker(5)) == comparison_figures(run) == []


def test_the_blocks_that_have_something_to_say(tested, run):
    assert [block.anchor for block in over_blocks(tested)] == ["reduced", "baselines", "responders"]
    assert over_blocks(run) == []


def test_none_is_said_with_n_and_with_what_it_is_worth(tested):
    none = replace(tested.over, responders=tested.over.responders.assign(group=0), responders_said="No groups (n = 11)")
    said = responder_sentences(tested.with_units(OVER, (none,)))
    assert said[0] == "No groups (n = 11)."
    assert "does not prove homogeneity" in said[1]
    assert responder_table(tested.with_units(OVER, (none,))) is None


def test_groups_are_listed_by_participant(tested):
    groups = tested.over.responders.assign(group=[1 + i % 2 for i in range(11)])
    table = responder_table(tested.with_units(OVER, (replace(tested.over, responders=groups),)))
    assert table.rows[0] == ("1", ", ".join(f"P{i:02}" for i in range(1, 12, 2)))
    assert "n = 11" in table.caption


def test_the_manufactured_reduction_is_found(tested):
    """Augmented leaves a tenth of a bump, and noise averaged over strides beside it."""
    table = reduction_table(tested)
    assert [group for group, _ in table.groups] == ["", "peak to peak", "root mean square"]
    assert sum(span for _, span in table.groups) == len(table.columns) == len(table.rows[0])
    assert table.rows[0][:2] == ("hip flexion, right", "11")
    middle, low, high = (float(x.strip("*[],")) for x in table.rows[0][4].replace("\n", " ").split())
    assert 70 < low < middle < high < 92
    assert "n = 11 participants" in table.caption
    assert len(table.numbers) == 2 * 2 * 3


def test_the_figure_draws_every_participant(tested):
    figure = reduction_figure(tested)
    assert figure.name == "reduction"
    assert len(figure.numbers) == 11 * 3 * 3
    assert "n = 11 participants" in figure.caption
    assert "52.8 %" in figure.caption


def test_what_is_said_names_the_least_and_the_most(tested):
    said = reduction_sentences(tested)
    assert len(said) == 2
    assert says(said[0], "reduces the stride-averaged")
    assert "medians over 11 participants" in said[1]


def test_five_participants_have_medians_and_no_test(tested):
    few = tested.with_units(RESPONSE, tested.responses[:5])
    few = few.with_units(OVER, (compare_participants(few.responses),))
    table = reduction_table(few)
    assert says(table.caption, "median over participants")
    assert "[" not in table.rows[0][2]


def test_nothing_without_numbers(tested, run):
    assert reduction_figure(run) is None
    assert reduction_table(run) is None
    none = tested.over.reductions.assign(rms_reduction=np.nan, peak_to_peak_reduction=np.nan)
    bare = tested.with_units(OVER, (replace(tested.over, reductions=none),))
    assert reduction_figure(bare) is None
    assert reduction_sentences(bare) == []


def test_each_variable_and_model_has_its_baselines(tested):
    table = baseline_table(tested)
    assert len(table.rows) == 3 * 3
    assert table.rows[0][:3] == ("hip flexion, right", "Nominal", "11")
    assert all(cell.split()[1] == "higher" for cell in table.rows[2][3:])
    assert sum(span for _, span in table.groups) == len(table.columns)


def test_a_network_that_beats_everything_is_said_to(tested):
    every = tested.over.baselines.assign(different=True, rank_biserial=1.0)
    said = baseline_sentences(tested.with_units(OVER, (replace(tested.over, baselines=every),)))
    assert says(said[2], "The Exo network")


def test_where_it_does_not_the_variables_are_named(tested):
    tests = tested.over.baselines.assign(different=True, rank_biserial=1.0)
    mine = (tests["model"] == "exo") & (tests["first"] == "ridge")
    tests.loc[mine & (tests["variable"] == "ankle_angle_l"), "different"] = False
    tests.loc[mine & (tests["variable"] == "emg_sol_r"), "rank_biserial"] = -1.0
    said = baseline_sentences(tested.with_units(OVER, (replace(tested.over, baselines=tests),)))
    assert says(said[2], "not", "ridge", "left; EMG", "right")


def test_nothing_where_nothing_was_compared(run):
    assert baseline_table(run) is None
    assert baseline_sentences(run) == []
