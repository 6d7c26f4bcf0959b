from dataclasses import replace

import numpy as np
import pytest

from gaitdisc.report.held_out_figure import WINDOW_S, held_out_figures, held_out_numbers
from gaitdisc.results import HeldOut

OUTPUTS = ("hip_flexion_r", "ankle_angle_l", "emg_sol_r")


@pytest.fixture
def response(response_maker):
    return response_maker("P01", outputs=OUTPUTS)


def test_the_last_seconds_are_drawn_as_the_csv_says(response):
    [figure] = held_out_figures(response, "P01")
    assert np.ptp(figure.numbers["time_s"]) == pytest.approx(WINDOW_S, abs=0.011)
    assert figure.numbers["time_s"].max() == response.held_out.time[-1]
    for panel, (_, rows) in zip(figure.drawn.axes, figure.numbers.groupby("variable", sort=False), strict=False):
        drawn = {line.get_label(): line.get_ydata() for line in panel.get_lines()}
        for label, column in (("measured", "measured"), ("Nominal", "nominal"), ("Augmented", "augmented")):
            np.testing.assert_array_equal(drawn[label], rows[column])
    assert not figure.drawn.axes[3].get_visible()


def test_words(response):
    [figure] = held_out_figures(response, "P01")
    assert "n = 400 samples drawn of 749; split: last 7.5 s held out" in figure.caption
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
    [figure] = held_out_figures(replace(response, held_out=replace(held, bands=bands)), "P01")
    assert "measured inside such a band: 0 % for Nominal, 100 % for Augmented" in figure.caption
    rows = figure.numbers[figure.numbers["variable"] == OUTPUTS[0]]
    np.testing.assert_allclose(rows["augmented_high"] - rows["augmented_low"], 2.0)
    [without] = held_out_figures(response, "P01")
    assert "band" not in without.caption


def test_no_line_bridges_samples_that_were_left_away(response):
    held = response.held_out
    keep = np.ones(len(held.time), bool)
    keep[600:650] = False
    predicted = {model: values[keep] for model, values in held.predicted.items()}
    holed = replace(response, held_out=HeldOut(held.time[keep], held.phi[keep], held.measured[keep], predicted))
    [figure] = held_out_figures(holed, "P01")
    measured = figure.drawn.axes[0].get_lines()[0].get_ydata()
    assert np.isnan(measured).sum() == 1
    assert not held_out_numbers(holed)["measured"].isna().any()


def test_one_output_fills_the_width_and_none_is_no_figure(response_maker):
    [figure] = held_out_figures(response_maker("P01", outputs=("hip_flexion_r",)), "P01")
    assert len(figure.drawn.axes) == 1
    empty = response_maker("P01", outputs=("hip_flexion_r",))
    nothing = HeldOut(np.empty(0), np.empty(0), np.empty((0, 1)), {"nominal": np.empty((0, 1))})
    assert held_out_figures(replace(empty, held_out=nothing), "P01") == []
