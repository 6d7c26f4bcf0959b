from dataclasses import replace

import numpy as np
import pytest

from gaitdisc.report.residual_figure import mean_interval, residual_figures, residual_numbers

OUTPUTS = ("hip_flexion_r", "ankle_angle_l")


@pytest.fixture
def response(response_maker):
    """Residuals of known shape: a bump of 100 deg/s2 at 40 % in Nominal, nothing in the others, 8 strides of ±1."""
    made = response_maker("P01", outputs=OUTPUTS)
    percent = np.arange(101.0)
    noise = np.where(np.arange(8) % 2, 1.0, -1.0)[:, None, None] * np.ones((8, 101, 2))
    bump = 100 * np.exp(-(((percent - 40) / 8) ** 2))[:, None]
    return replace(made, residuals={"nominal": noise + bump, "augmented": noise, "exo": noise})


def test_the_mean_and_its_interval_are_the_known_ones(response):
    numbers = residual_numbers(response)
    nominal = numbers[(numbers["variable"] == OUTPUTS[1]) & (numbers["model"] == "nominal")].set_index("percent")
    assert nominal.loc[40.0, "mean"] == pytest.approx(100.0)
    assert nominal.loc[90.0, "low"] < 0 < nominal.loc[90.0, "high"]
    assert nominal.loc[40.0, "low"] > 95
    assert set(nominal["n"]) == {8}
    assert set(numbers["unit"]) == {"deg/s2"}


def test_what_is_drawn_is_the_csv(response):
    [figure] = residual_figures(response, "P01")
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


def test_words(response):
    [figure] = residual_figures(response, "P01")
    for wanted in ("n = 8 strides", "split: last 7.5 s held out", "95 % interval"):
        assert wanted in figure.caption
    panels = [panel for panel in figure.drawn.axes if panel.get_ylabel()]
    assert [panel.get_ylabel() for panel in panels] == ["[deg/s²]", "[deg/s²]"]
    assert panels[1].get_title(loc="left") == "ankle angle, left (up: towards dorsiflexion)"
    assert "Augmented 0 %" in figure.alt


def test_few_strides_have_a_mean_and_no_interval(response):
    few = replace(response, residuals={key: values[:3] for key, values in response.residuals.items()})
    [figure] = residual_figures(few, "P01")
    assert figure.numbers["low"].isna().all()
    assert figure.numbers["mean"].notna().all()
    assert "n = 3 strides" in figure.caption
    assert "no interval, which needs 5 whole strides" in figure.caption
    assert "Too few strides" in figure.alt
    none = replace(response, residuals={key: values[:0] for key, values in response.residuals.items()})
    assert residual_figures(none, "P01") == []


def test_missing_points_stay_missing(response):
    holes = response.residuals["nominal"][:3].copy()
    holes[:, 10] = np.nan
    found = mean_interval(holes)
    assert np.isnan(found.mean[10]).all()
    assert found.strides[10].tolist() == [0, 0]
    holes = {**response.residuals, "exo": np.full((8, 101, 2), np.nan)}
    [figure] = residual_figures(replace(response, residuals=holes), "P01")
    assert figure.numbers.loc[figure.numbers["model"] == "exo", "mean"].isna().all()


def test_many_outputs_wrap(response_maker):
    response = response_maker("P01", outputs=tuple(f"signal_{i}" for i in range(24)))
    figures = residual_figures(response, "P01")
    assert [figure.name for figure in figures] == [f"residual-P01-{i}" for i in (1, 2, 3, 4)]
    assert all(figure.drawn.get_figheight() < 10 for figure in figures)
