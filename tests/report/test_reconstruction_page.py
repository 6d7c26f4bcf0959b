import io
import math
from dataclasses import replace
from html.parser import HTMLParser

import pandas as pd
import pytest
from rich.console import Console
from texts import says

from gaitdisc.reconstruction.page import (
    models_table,
    participants_table,
    reconstruction_figures,
    reconstruction_sentences,
    reconstruction_text,
    states_table,
    write_reconstruction_report,
)
from gaitdisc.reconstruction.window_model import KINDS, ON_REQUEST


def test_every_error_stands_under_its_own_name(reconstruction):
    table = models_table(reconstruction)
    assert table.columns[1:5] == ("RMSE [deg]", "relative L2 [1]", "with sensors [1]", "R² [1]")
    assert table.rows[1][0] == "delay ridge *"
    assert "MSE" not in " ".join(table.columns).replace("RMSE", "")
    assert reconstruction_text(reconstruction).row_count == 2


def test_what_has_no_angles_has_no_column_of_degrees(reconstruction):
    [state] = reconstruction.states
    emg = replace(reconstruction, states=(replace(state, unit="V"),))
    table = models_table(emg)
    assert table.columns == ("model", "relative L2 [1]", "R² [1]", "coverage [%]", "fit [s]")
    assert {len(row) for row in table.rows} == {5}
    assert "with sensors" not in table.caption


def test_units_stand_in_the_headings_that_are_printed(reconstruction):
    paper = io.StringIO()
    Console(width=80, file=paper).print(reconstruction_text(reconstruction))
    printed = paper.getvalue()
    assert all(heading in printed for heading in ("RMSE [deg]", "relative L2 [1]", "R² [1]", "fit [s]"))
    assert "coverage" not in printed


def test_states_and_participants(reconstruction):
    assert [row[1] for row in states_table(reconstruction).rows] == ["deg"]
    assert participants_table(reconstruction).rows[0][0] == "P01"


@pytest.mark.parametrize(
    ("unit", "rmse", "printed"), [("V", 2.34567e-5, "0.0000235"), ("m", 0.0412, "0.0412"), ("N", 209.4, "209")]
)
def test_a_small_unit_is_printed_with_three_digits(reconstruction, unit, rmse, printed):
    [state] = reconstruction.states
    other = replace(reconstruction, states=(replace(state, unit=unit),), errors=reconstruction.errors.assign(rmse=rmse))
    assert states_table(other).rows[0][2] == printed


def test_the_future_of_a_sensor_is_among_the_angles_that_are_tested(reconstruction):
    assert says(models_table(reconstruction).caption, "the angles that no")
    ahead = replace(reconstruction, states=(*reconstruction.states, *reconstruction.sensors))
    assert "all angles" in participants_table(ahead).caption and "no sensor measures" not in models_table(ahead).caption


def test_the_sentences_recommend_and_refuse_the_name(reconstruction):
    said = reconstruction_sentences(reconstruction)
    rmse = reconstruction.over_participants().loc["delay ridge", "rmse_deg"]
    assert math.isfinite(rmse) and says(said[0], "delay ridge", f"{rmse:.2f} deg")
    assert said[1].startswith("For comparison: linear")
    assert "describe these participants" in said[2]
    assert "calls the norm" in said[-1]


@pytest.mark.parametrize("word", ["random (leaks)"])
def test_a_split_that_leaks_is_said(reconstruction, word):
    leaking = type(reconstruction)(**{**vars(reconstruction), "split": word})
    assert any("The split leaks" in said for said in reconstruction_sentences(leaking))


def test_who_errs_least_in_whom_is_said(reconstruction):
    second = reconstruction.summary.assign(participant="P02", rmse_deg=[1.0, 1.25])
    both = replace(reconstruction, summary=pd.concat([reconstruction.summary, second]))
    assert any(says(line, "smallest error in 1 of 2") for line in reconstruction_sentences(both))
    alike = replace(both, summary=pd.concat([reconstruction.summary, second.assign(rmse_deg=[4.0, 1.0])]))
    assert any(says(line, "smallest error in all", "2") for line in reconstruction_sentences(alike))


def test_what_calibration_brings_is_said(reconstruction):
    more = reconstruction.summary[1:].assign(model="delay ridge, calibrated", rmse_deg=0.625)
    with_it = replace(
        reconstruction,
        summary=pd.concat([reconstruction.summary, more]),
        models={**reconstruction.models, "delay ridge, calibrated": "the same, corrected"},
    )
    [said] = [s for s in reconstruction_sentences(with_it) if s.startswith("After correction")]
    assert says(said, "0.62", "1.25 deg (-50 %)")


def test_one_panel_a_state_with_what_was_measured_and_reconstructed(reconstruction):
    [figure] = reconstruction_figures(reconstruction, "P01", "P01")
    assert sum(axes.get_visible() for axes in figure.drawn.axes) == 1
    assert set(figure.numbers["model"]) == {"linear", "delay ridge"}
    assert says(figure.caption, "n = 5 strides")


@pytest.mark.parametrize("kind", [*KINDS, *ON_REQUEST])
def test_every_kind_of_model_can_be_recommended_and_drawn(reconstruction, kind):
    named = {"delay ridge": kind} if kind != "linear" else {"delay ridge": "shred"}
    tables = {name: getattr(reconstruction, name).replace({"model": named}) for name in ("errors", "summary", "curves")}
    calibrated = replace(reconstruction, models=dict.fromkeys(("linear", *named.values()), ""), **tables)
    assert calibrated.recommended == named["delay ridge"]
    [figure] = reconstruction_figures(calibrated, "P01", "P01")
    assert set(figure.numbers["model"]) == {"linear", *named.values()}


def test_the_page_answers_first_and_needs_nothing_but_itself(reconstruction, tmp_path):
    page = write_reconstruction_report(reconstruction, tmp_path)
    text = page.read_text(encoding="utf-8")
    HTMLParser().feed(text)
    parts = ("reconstructs 1 other state from a", "<figure>", "How the numbers were computed")
    assert sorted(parts, key=text.index) == list(parts)
    assert "http" not in text.split("</head>")[1]
    assert {file.name for file in (tmp_path / "tables").iterdir()} >= {"models.csv", "states.csv", "participants.csv"}
    first = page.read_bytes()
    assert write_reconstruction_report(reconstruction, tmp_path).read_bytes() == first
