import numpy as np
import pytest
from matplotlib.text import Text

from gaitdisc.report.palette import MODELS
from gaitdisc.report.r2_figure import LOWEST, r2_figures, r2_numbers

OUTPUTS = ("hip_flexion_r", "ankle_angle_l")


def drawn_marks(figure, colour, filled=True):
    axes = figure.drawn.axes[0]
    lines = [line for line in axes.get_lines() if line.get_color() == colour or line.get_markeredgecolor() == colour]
    lines = [line for line in lines if line.get_marker() not in ("None", None, "")]
    return np.concatenate([x.get_xdata() for x in lines if (x.get_markerfacecolor() != "none") == filled])


def test_one_participant_is_drawn_as_the_csv_says(run_maker):
    run = run_maker(outputs=OUTPUTS)
    [figure] = r2_figures(run)
    for model, look in MODELS.items():
        for kind in ("network", "ridge"):
            rows = figure.numbers[(figure.numbers["model"] == model) & (figure.numbers["kind"] == kind)]
            np.testing.assert_array_equal(drawn_marks(figure, look.colour, kind == "network"), rows["r2"])
            assert list(rows["r2"]) == [run.responses[0].r2_of(v, model, kind) for v in OUTPUTS]
    assert "n = 1 participant, 749 samples; split: last 7.5 s" in figure.caption
    assert "axis starts at 0.4" in figure.caption


def test_several_participants_have_points_and_boxes(run_maker):
    [figure] = r2_figures(run_maker(6, outputs=OUTPUTS))
    augmented = figure.numbers[(figure.numbers["model"] == "augmented") & (figure.numbers["kind"] == "network")]
    drawn = drawn_marks(figure, MODELS["augmented"].colour)
    assert sorted(drawn) == pytest.approx(sorted(augmented["r2"]))
    assert "n = 6 participants" in figure.caption
    assert "box of quartiles" in figure.caption


def test_a_very_negative_r2_stands_at_the_edge_with_its_value(run_maker):
    run = run_maker(outputs=OUTPUTS)
    response = run.responses[0]
    chosen = (response.r2["model"] == "nominal") & (response.r2["kind"] == "network")
    response.r2.loc[chosen & (response.r2["variable"] == OUTPUTS[0]), "r2"] = -7.5
    [figure] = r2_figures(run)
    assert "◂ −7.50" in [text.get_text() for text in figure.drawn.axes[0].texts]
    assert drawn_marks(figure, MODELS["nominal"].colour)[0] == LOWEST
    assert figure.numbers["r2"].min() == -7.5
    assert "left edge with its value" in figure.caption


def test_many_variables_wrap_and_nan_is_left_out(run_maker):
    run = run_maker(outputs=tuple(f"signal_{i}" for i in range(24)), seconds=20.0)
    run.responses[0].r2["r2"] = np.nan
    figures = r2_figures(run)
    assert [figure.name for figure in figures] == ["r2-1", "r2-2"]
    assert [figure.numbers["variable"].nunique() for figure in figures] == [12, 12]


def test_a_null_that_is_missing_is_not_in_the_key(run_maker):
    run = run_maker(outputs=OUTPUTS)
    run.responses[0].r2.loc[run.responses[0].r2["kind"] == "null", "r2"] = np.nan
    [figure] = r2_figures(run)
    assert "band-limited noise" not in [text.get_text() for text in figure.drawn.legends[0].get_texts()]
    assert "what noise would reach was not computed" in figure.caption


def test_nobody_has_no_numbers(run_maker):
    assert list(r2_numbers(run_maker(0)).columns) == ["participant", "variable", "model", "kind", "r2"]


def text_boxes(figure):
    """What is written, with the box that it covers [pixels]."""
    figure.drawn.draw_without_rendering()
    texts = [text for axes in figure.drawn.axes for text in axes.findobj(Text) if text.get_visible()]
    return [(text.get_text(), text.get_window_extent()) for text in texts if text.get_text().strip()]


@pytest.mark.parametrize("people", [2, 12])
def test_no_two_labels_lie_on_each_other(run_maker, people):
    """Every model of both variables far below the axis, in every participant: the most labels there can be."""
    run = run_maker(people, outputs=OUTPUTS)
    for number, response in enumerate(run.responses):
        response.r2["r2"] = -1.0 - 0.1 * number
    [figure] = r2_figures(run)
    boxes = text_boxes(figure)
    assert sum(words.startswith("◂") for words, _ in boxes) == 6
    over = [(one, other) for n, (one, a) in enumerate(boxes) for other, b in boxes[n + 1 :] if a.overlaps(b)]
    assert over == []
    assert all(figure.drawn.bbox.padded(1).contains(*corner) for _, box in boxes for corner in (box.min, box.max))


def test_values_left_of_the_axis_share_one_label(run_maker):
    for people, words in ((2, "◂ −1.10, −1.00"), (5, "◂ 5 values, −1.40 to −1.00")):
        run = run_maker(people, outputs=OUTPUTS)
        for number, response in enumerate(run.responses):
            response.r2["r2"] = -1.0 - 0.1 * number
        [figure] = r2_figures(run)
        assert {text.get_text() for text in figure.drawn.axes[0].texts} == {words}
