from dataclasses import replace

import numpy as np
import pytest
from texts import says

from gaitdisc.response.held_out import (
    WINDOW_S,
    draw_held_out,
    mean_interval,
    residual_figures,
    residual_numbers,
    tabulate_held_out,
)
from gaitdisc.response.participant_response import HeldOut

OUTPUTS = ("hip_flexion_r", "ankle_angle_l", "emg_sol_r")


@pytest.fixture
def response(response_maker):
    return response_maker("P01", outputs=OUTPUTS)


def test_the_last_seconds_are_drawn_as_the_csv_says(response):
    [figure] = draw_held_out(response, "P01")
    assert np.ptp(figure.numbers["time_s"]) == pytest.approx(WINDOW_S, abs=0.011)
    assert figure.numbers["time_s"].max() == response.held_out.time[-1]
    for panel, (_, rows) in zip(figure.drawn.axes, figure.numbers.groupby("variable", sort=False), strict=False):
        drawn = {line.get_label(): line.get_ydata() for line in panel.get_lines()}
        for label, column in (("measured", "measured"), ("Nominal", "nominal"), ("Augmented", "augmented")):
            np.testing.assert_array_equal(drawn[label], rows[column])
    assert not figure.drawn.axes[3].get_visible()


def test_words(response):
    [figure] = draw_held_out(response, "P01")
    assert says(figure.caption, "n = 400 of 749 samples", "7.5 s")
    first, _, third = figure.drawn.axes[:3]
    assert first.get_ylabel() == "[deg/s²]\n↑ flexion"
    assert third.get_ylabel() == "[V/s²]"
    r2 = response.r2_of(OUTPUTS[0], "nominal"), response.r2_of(OUTPUTS[0], "augmented")
    assert first.get_title(loc="left") == f"hip flexion, right: R² {r2[0]:.2f} → {r2[1]:.2f}"


def test_the_band_of_augmented_is_drawn_and_the_caption_says_what_each_band_holds(response):
    held = response.held_out
    bands = {
        "nominal": np.stack([held.measured + 1, held.measured + 2]),
        "augmented": np.stack([held.measured - 1, held.measured + 1]),
    }
    [figure] = draw_held_out(replace(response, held_out=replace(held, bands=bands)), "P01")
    assert says(figure.caption, "band: 0 %", "100 %")
    rows = figure.numbers[figure.numbers["variable"] == OUTPUTS[0]]
    np.testing.assert_allclose(rows["augmented_high"] - rows["augmented_low"], 2.0)
    [without] = draw_held_out(response, "P01")
    assert "band" not in without.caption


def test_no_line_bridges_samples_that_were_left_away(response):
    held = response.held_out
    keep = np.ones(len(held.time), bool)
    keep[600:650] = False
    predicted = {model: values[keep] for model, values in held.predicted.items()}
    holed = replace(response, held_out=HeldOut(held.time[keep], held.phi[keep], held.measured[keep], predicted))
    [figure] = draw_held_out(holed, "P01")
    measured = figure.drawn.axes[0].get_lines()[0].get_ydata()
    assert np.isnan(measured).sum() == 1
    assert not tabulate_held_out(holed)["measured"].isna().any()


def test_one_output_fills_the_width_and_none_is_no_figure(response_maker):
    [figure] = draw_held_out(response_maker("P01", outputs=("hip_flexion_r",)), "P01")
    assert len(figure.drawn.axes) == 1
    empty = response_maker("P01", outputs=("hip_flexion_r",))
    nothing = HeldOut(np.empty(0), np.empty(0), np.empty((0, 1)), {"nominal": np.empty((0, 1))})
    assert draw_held_out(replace(empty, held_out=nothing), "P01") == []


OUTPUTS_RESIDUAL = ("hip_flexion_r", "ankle_angle_l")


@pytest.fixture
def response_residual(response_maker):
    """Residuals of known shape: a bump of 100 deg/s2 at 40 % in Nominal, nothing in the others, 8 strides of ±1."""
    made = response_maker("P01", outputs=OUTPUTS_RESIDUAL)
    percent = np.arange(101.0)
    noise = np.where(np.arange(8) % 2, 1.0, -1.0)[:, None, None] * np.ones((8, 101, 2))
    bump = 100 * np.exp(-(((percent - 40) / 8) ** 2))[:, None]
    return replace(made, residuals={"nominal": noise + bump, "augmented": noise, "exo": noise})


def test_the_mean_and_its_interval_are_the_known_ones(response_residual):
    numbers = residual_numbers(response_residual).set_index("percent")
    nominal = numbers[(numbers["variable"] == OUTPUTS_RESIDUAL[1]) & (numbers["model"] == "nominal")]
    assert nominal.loc[40.0, "mean"] == pytest.approx(100.0)
    assert nominal.loc[90.0, "low"] < 0 < nominal.loc[90.0, "high"]
    assert nominal.loc[40.0, "low"] > 95
    assert set(nominal["n"]) == {8}
    assert set(numbers["unit"]) == {"deg/s2"}


def test_what_is_drawn_is_the_csv(response_residual):
    [figure] = residual_figures(response_residual, "P01")
    numbers, axes = figure.numbers, figure.drawn.axes
    assert len(axes) == 6
    for panel, (_, curves) in zip(axes, numbers.groupby(["variable", "model"], sort=False), strict=True):
        lines = [line for line in panel.get_lines() if len(line.get_xdata()) == 101]
        for index, line in enumerate(lines[:8]):
            np.testing.assert_array_equal(line.get_ydata(), curves[f"stride_{index + 1}"])
        np.testing.assert_array_equal(lines[8].get_ydata(), curves["mean"])
        band = panel.collections[0].get_paths()[0].get_extents()
        assert band.y0 == pytest.approx(curves["low"].min())
        assert band.y1 == pytest.approx(curves["high"].max())


def test_words_of_the_residuals(response_residual):
    [figure] = residual_figures(response_residual, "P01")
    for wanted in ("n = 8 strides", "split: last 7.5 s", "95 % confidence interval"):
        assert wanted in figure.caption
    panels = [panel for panel in figure.drawn.axes if panel.get_ylabel()]
    assert [panel.get_ylabel() for panel in panels] == ["[deg/s²]", "[deg/s²]"]
    assert says(panels[1].get_title(loc="left"), "left (up: towards dorsiflexion)")
    assert "Augmented 0 %" in figure.alt


def test_few_strides_have_a_mean_and_no_interval(response_residual):
    few = replace(response_residual, residuals={key: values[:3] for key, values in response_residual.residuals.items()})
    [figure] = residual_figures(few, "P01")
    assert figure.numbers["low"].isna().all()
    assert figure.numbers["mean"].notna().all()
    assert "n = 3 strides" in figure.caption
    assert says(figure.caption, "no", "5 complete strides")
    assert "too few strides" in figure.alt
    none = replace(response_residual, residuals={key: size[:0] for key, size in response_residual.residuals.items()})
    assert residual_figures(none, "P01") == []


def test_missing_points_stay_missing(response_residual):
    holes = response_residual.residuals["nominal"][:3].copy()
    holes[:, 10] = np.nan
    found = mean_interval(holes)
    assert np.isnan(found.mean[10]).all()
    assert found.strides[10].tolist() == [0, 0]
    holes = {**response_residual.residuals, "exo": np.full((8, 101, 2), np.nan)}
    [figure] = residual_figures(replace(response_residual, residuals=holes), "P01")
    assert figure.numbers.loc[figure.numbers["model"] == "exo", "mean"].isna().all()


def test_many_outputs_wrap(response_maker):
    response_residual = response_maker("P01", outputs=tuple(f"signal_{i}" for i in range(13)))
    figures = residual_figures(response_residual, "P01")
    assert [figure.name for figure in figures] == [f"residual-P01-{i}" for i in (1, 2, 3)]
    assert all(figure.drawn.get_figheight() < 10 for figure in figures)
