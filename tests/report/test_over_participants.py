from dataclasses import replace

import numpy as np
from texts import says

from gaitdisc.report.over_participants import (
    baseline_sentences,
    baseline_table,
    over_blocks,
    reduction_figure,
    reduction_sentences,
    reduction_table,
    responder_sentences,
    responder_table,
)
from gaitdisc.response.over_participants import compare_participants
from gaitdisc.results.over_participants import OVER
from gaitdisc.results.participant_response import RESPONSE


def test_the_blocks_that_have_something_to_say(tested, run):
    assert [block.anchor for block in over_blocks(tested)] == ["reduced", "baselines", "responders"]
    assert over_blocks(run) == []


def test_none_is_said_with_n_and_with_what_it_is_worth(tested):
    none = replace(
        tested.over, responders=tested.over.responders.assign(group=0), responders_said="No sub-groups (n = 11)"
    )
    said = responder_sentences(tested.with_units(OVER, (none,)))
    assert said[0] == "No sub-groups (n = 11)."
    assert "no proof of one kind" in said[1]
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
    assert says(said[0], "makes the stride-averaged", "smaller")
    assert "medians over 11 participants" in said[1]


def test_five_participants_have_medians_and_no_test(tested):
    few = tested.with_units(RESPONSE, tested.responses[:5])
    few = few.with_units(OVER, (compare_participants(few.responses),))
    table = reduction_table(few)
    assert says(table.caption, "median over participants, no")
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
    assert says(said[2], "The Exo network beats")


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
