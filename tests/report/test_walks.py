"""The variance explained, and the walks that it rests on."""

from dataclasses import replace

import numpy as np
import pandas as pd
import pytest
from matplotlib.text import Text
from texts import says

from gaitdisc.processing.pooled_cycles import WALK
from gaitdisc.recording import Finding
from gaitdisc.report.panels import MODELS
from gaitdisc.report.table import findings_table, refusals_table
from gaitdisc.response.r2_tables import (
    LOWEST,
    R2_TABLE,
    not_computed,
    participant_medians,
    participants_table,
    quartiles_over_participants,
    r2_by_variable,
    r2_figures,
    r2_numbers,
    r2_table,
    sample_counts,
    study_r2_table,
    tail_words,
    variables,
)
from gaitdisc.response.walks_page import (
    fits_table,
    reason_kind,
    stride_numbers,
    strides_figure,
    tabulate_dropped,
    walks_table,
)

OUTPUTS = ("hip_flexion_r", "ankle_angle_l")


def test_every_column_stands_where_the_response_says(response_maker):
    response = response_maker("P01", outputs=OUTPUTS)
    table = r2_by_variable(response)
    for column in R2_TABLE:
        model = column.model or "nominal"
        for variable in OUTPUTS:
            wanted = response.r2_of(variable, model, column.kind, column.walk)
            assert table.loc[variable, column.key] == pytest.approx(wanted)
    assert [column.title for column in R2_TABLE][:2] == ["Nominal, no device", "Nominal"]


def test_what_was_not_computed_is_nan_and_leaves_the_median_alone(response_maker):
    response = response_maker("P01", outputs=OUTPUTS)
    response.r2.loc[response.r2["variable"] == "ankle_angle_l", "r2"] = np.nan
    table = r2_by_variable(response)
    assert table.loc["ankle_angle_l"].isna().all()
    assert table.median()["exo_on_exo"] == table.loc["hip_flexion_r", "exo_on_exo"]


def test_quartiles_over_participants_count_who_has_the_variable(run_maker):
    run = run_maker(3, outputs=OUTPUTS)
    long = quartiles_over_participants(run).set_index(["variable", "column"])
    values = [r.r2_of("ankle_angle_l", "augmented") for r in run.responses]
    row = long.loc[("ankle_angle_l", "augmented_on_exo")]
    assert row["median"] == pytest.approx(np.median(values))
    assert row["q1"] == pytest.approx(np.quantile(values, 0.25))
    assert row["n"] == 3
    people = participant_medians(run)
    assert people.loc["P02", "exo_on_exo"] == pytest.approx(
        np.median([run.responses[1].r2_of(v, "exo") for v in OUTPUTS])
    )


def test_counts_and_lengths_in_words(run_maker, response_maker):
    assert variables(run_maker(2, outputs=OUTPUTS)) == OUTPUTS
    response = response_maker("P01", outputs=OUTPUTS)
    assert sample_counts(response) == "749"
    response.r2.loc[0, "n"] = 700
    assert sample_counts(response) == "700-749"
    assert tail_words(run_maker(2, outputs=OUTPUTS, held_out_s=10.0)) == "10"
    assert tail_words(run_maker(0)) == ""


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
    assert says(figure.caption, "n = 1 participant, 749", "samples", "7.5 s")
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
    assert says(figure.caption, "band-limited noise was not")


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
    for people, words in ((2, ("−1.10, −1.00",)), (5, ("5 values", "−1.40 to −1.00"))):
        run = run_maker(people, outputs=OUTPUTS)
        for number, response in enumerate(run.responses):
            response.r2["r2"] = -1.0 - 0.1 * number
        [figure] = r2_figures(run)
        [label] = {text.get_text() for text in figure.drawn.axes[0].texts}
        assert says(label, "◂", *words)


def test_r2_of_one_participant(run_maker):
    [response] = run_maker(outputs=OUTPUTS).responses
    table = r2_table(response, "P01")
    assert [row[0] for row in table.rows] == ["hip flexion, right [deg/s²]", "ankle angle, left [deg/s²]", "median"]
    assert table.rows[1][3] == f"{response.r2_of('ankle_angle_l', 'augmented'):.3f}"
    assert table.rows[-1][-1] == "0.510"
    assert sum(span for _, span in table.groups) == len(table.columns) == len(table.rows[0])
    assert says(table.caption, "n = 749 samples", "749")
    assert "split: last 7.5 s" in table.caption
    assert table.numbers.loc[1, "augmented_on_exo"] == response.r2_of("ankle_angle_l", "augmented")


def test_a_number_that_is_missing_says_so_and_why(run_maker):
    run = run_maker(outputs=OUTPUTS)
    [response] = run.responses
    rows = response.r2["variable"] == "ankle_angle_l"
    response.r2.loc[rows, "r2"] = np.nan
    assert r2_table(response, "P01").rows[1][1] == "not computed"
    (line,) = not_computed(run, response)
    assert says(line, "ankle angle, left", "reason")
    response.r2.loc[rows, "n"] = 0
    (line,) = not_computed(run, response)
    assert says(line, "ankle angle, left", "n = 0")
    dead = Finding("warning", "dead", "a.mot", "constant 0 deg", "this channel", "ankle_angle_l")
    run = run.with_units(WALK, (replace(run.walks[0], findings=(dead,)),))
    (line,) = not_computed(run, response)
    assert says(line, "ankle angle, left", "a.mot, ankle_angle_l: dead", "constant 0 deg", "this channel")


def test_several_participants(run_maker):
    run = run_maker(3, outputs=OUTPUTS)
    people = participants_table(run)
    assert [row[0] for row in people.rows] == ["P01", "P02", "P03", "median"]
    assert people.rows[0][1] == "749"
    study = study_r2_table(run)
    values = [r.r2_of("hip_flexion_r", "exo") for r in run.responses]
    q1, middle, q3 = np.quantile(values, [0.25, 0.5, 0.75])
    assert study.rows[0][5] == f"{middle:.3f}\n[{q1:.3f}, {q3:.3f}]"
    assert study.rows[0][1] == "3"
    assert "n = 3 participants" in study.caption


STRIDES = pd.DataFrame(
    [
        ("r", 0.0, 1.0, True, ""),
        ("r", 1.0, 2.9, False, "lasts 1.90 s, the median is 1.00 s"),
        ("r", 2.9, 3.9, True, ""),
        ("l", 0.5, 1.5, False, "0.2 s are missing"),
        ("l", 1.5, 2.5, True, ""),
        ("l", 2.5, 4.1, False, "lasts 1.60 s, the median is 1.00 s"),
    ],
    columns=["side", "start_s", "end_s", "kept", "reason"],
)


def test_like_reasons_have_one_letter(run_maker):
    run = run_maker(outputs=("hip_flexion_r",))
    run = run.with_units(WALK, tuple(replace(walk, strides=STRIDES) for walk in run.walks))
    numbers = stride_numbers(run, "P01")
    assert list(numbers["code"]) == ["", "A", "", "B", "", "A"] * 2
    assert says(walks_table(run).rows[0][6], "right 2 / 1", "left 1 / 2")
    np.testing.assert_allclose(numbers["duration_s"][:3], [1.0, 1.9, 1.0])
    assert reason_kind("") == "no reason was given"


def test_every_stride_is_drawn(run_maker):
    run = run_maker(outputs=("hip_flexion_r",))
    figure = strides_figure(run, "P01", "P01")
    strip, durations = figure.drawn.axes[:2]
    of_walk = figure.numbers[figure.numbers["condition"] == "natural"]
    bars = [path.get_extents() for collection in strip.collections for path in collection.get_paths()]
    np.testing.assert_allclose(sorted(bar.x0 for bar in bars), sorted(of_walk["start_s"]))
    np.testing.assert_allclose(sorted(bar.width for bar in bars), sorted(of_walk["duration_s"]))
    drawn = np.concatenate([line.get_ydata() for line in durations.get_lines()])
    np.testing.assert_allclose(np.sort(drawn), np.sort(of_walk["duration_s"]))
    letters = [text.get_text() for text in strip.texts]
    assert sorted(letters) == sorted(of_walk.loc[~of_walk["kept"], "code"])
    assert f"n = {len(of_walk)} strides (natural: {int(of_walk['kept'].sum())} kept" in figure.caption


def test_nobody_and_no_strides(run_maker):
    run = run_maker(outputs=("hip_flexion_r",))
    assert strides_figure(run, "P99", "P99") is None
    run = run.with_units(WALK, tuple(replace(walk, strides=STRIDES[:0]) for walk in run.walks))
    assert strides_figure(run, "P01", "P01") is None


def test_all_dropped(run_maker):
    run = run_maker(outputs=("hip_flexion_r",))
    dropped = STRIDES.assign(kept=False, reason="")
    run = run.with_units(WALK, tuple(replace(walk, strides=dropped) for walk in run.walks))
    figure = strides_figure(run, "P01", "P01")
    assert "natural: 0 kept, 6 dropped" in figure.caption
    assert set(figure.numbers["code"]) == {"A"}


def test_walks_have_their_light(run_maker):
    table = walks_table(run_maker(outputs=OUTPUTS))
    assert [row[0] for row in table.rows] == ["light:green:notes only", "light:amber:warnings"]
    kept = table.numbers.loc[0, "kept_r"]
    assert table.rows[0][6].startswith(f"right {kept} / ")


def test_refusals_findings_and_drops(run_maker, refusal):
    run = run_maker(outputs=OUTPUTS, refusals=(refusal,))
    assert refusals_table(run).rows == (("P13", "spring", refusal.reason),)
    findings = findings_table(run)
    assert findings.rows[0][0] == "warning"
    assert findings.rows[0][1:3] == ("P01 spring", "P01_spring.mot, knee_angle_r")
    assert says(findings.rows[0][3], "gap: 0.12 s", "12.31-12.43; 40.10-40.22 s")
    assert len(findings.rows) == 3
    dropped = tabulate_dropped(run, "P01", "P01")
    assert sum(int(row[3]) for row in dropped.rows) == len(dropped.numbers)
    clean = run.with_units(WALK, tuple(replace(w, strides=w.strides.assign(kept=True)) for w in run.walks))
    assert tabulate_dropped(clean, "P01", "P01") is None


def test_fits(run_maker):
    table = fits_table(run_maker(outputs=OUTPUTS))
    assert table.rows[0] == ("P01", "Nominal", "network", "0.1", "40", "5214", "782")
    assert "n = 6" in table.caption
    assert fits_table(run_maker(0)).rows == ()


@pytest.mark.parametrize("participants", [1, 2])
def test_every_table_has_cells_for_its_columns(run_maker, refusal, participants):
    run = run_maker(participants, outputs=OUTPUTS, refusals=(refusal,))
    for table in (walks_table(run), refusals_table(run), findings_table(run), fits_table(run), study_r2_table(run)):
        assert {len(row) for row in table.rows} == {len(table.columns)}
