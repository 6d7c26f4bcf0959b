import numpy as np
import pandas as pd
import pytest
from manufactured_discovery import manufactured

from gaitdisc.discovery.figure import bin_values, discovery_figures, pick_stretch, typical_stretch
from gaitdisc.discovery.result import Correction, Estimate, Runs


def test_there_is_a_figure_over_the_stride_only_where_there_is_a_phase():
    whole = manufactured()
    runs = whole.runs
    without = Runs(runs.trial, runs.time, runs.phase[:, :0], runs.measured, runs.simulated, runs.augmented)
    figures = discovery_figures(whole)
    assert [one.name for one in figures] == ["held_out", "over_stride", "against_state"]
    assert figures[1].numbers["n"].min() >= 5  # few strides fill few bins, not none
    assert [one.name for one in discovery_figures(manufactured(runs=without))] == ["held_out", "against_state"]


def test_radians_are_drawn_in_degrees():
    whole = manufactured()
    numbers = discovery_figures(whole)[0].numbers
    assert numbers["theta_measured"].iloc[0] == pytest.approx(np.degrees(whole.runs.measured[0, 0, 0]))


def test_the_stretch_is_neither_the_best_nor_the_worst():
    gap = np.repeat([5.0, 1.0, 9.0], 10)
    assert typical_stretch(gap, 10) == (0, 10)
    assert typical_stretch(gap, 100) == (0, 30)


def test_no_line_is_drawn_across_an_interruption():
    runs = {f"x_{word}": np.arange(6.0) for word in ("measured", "simulated", "augmented")}
    table = pd.DataFrame({"trial": "1", "time": [0.0, 0.1, 0.2, 0.8, 0.9, 1.0], **runs})
    np.testing.assert_array_equal(pick_stretch(table, "x")["x_measured"], [0, 1, 2, np.nan, 3, 4, 5])


def test_bins_with_few_samples_are_left_out():
    along = np.array([0.1] * 6 + [0.9] * 2)
    table = bin_values(along, np.full(8, 3.0), np.array([0.0, 0.5, 1.0]))
    assert table["at"].tolist() == [0.25]
    assert table["mean"].tolist() == [3.0]


def test_each_bin_has_its_own_mean_and_spread():
    table = bin_values(np.repeat([0.1, 0.9], 8), np.r_[np.ones(8), np.tile([4.0, 6.0], 4)], np.array([0.0, 0.5, 1.0]))
    assert table["mean"].tolist() == [1.0, 5.0] and table["n"].tolist() == [8, 8]
    assert table["sd"].tolist() == pytest.approx([0.0, np.sqrt(8 / 7)])


def test_where_numbers_were_fitted_within_their_bounds_the_figure_says_so():
    moved = Correction("inertia", 0.110, Estimate(0.1126, 0.1118, 0.1134, "kg m^2"))
    said = "its parameters fitted within their"
    assert said in discovery_figures(manufactured(corrections=(moved,)))[0].caption
    assert said not in discovery_figures(manufactured())[0].caption
