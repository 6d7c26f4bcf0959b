from dataclasses import replace

import numpy as np

from gaitdisc.report.reduction_figure import reduction_figure, reduction_sentences, reduction_table
from gaitdisc.response.over_participants import compare_participants


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
    assert said[0].startswith(
        "Measured as peak to peak, the Augmented model makes the stride-averaged residual smaller"
    )
    assert "medians over 11 participants" in said[1]


def test_five_participants_have_medians_and_no_test(tested):
    few = replace(tested, responses=tested.responses[:5], over=compare_participants(tested.responses[:5]))
    table = reduction_table(few)
    assert "median over participants, no test with so few" in table.caption
    assert "[" not in table.rows[0][2]


def test_nothing_without_numbers(tested, run):
    assert reduction_figure(run) is None
    assert reduction_table(run) is None
    none = tested.over.reductions.assign(rms_reduction=np.nan, peak_to_peak_reduction=np.nan)
    bare = replace(tested, over=replace(tested.over, reductions=none))
    assert reduction_figure(bare) is None
    assert reduction_sentences(bare) == []
