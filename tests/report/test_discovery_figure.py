import numpy as np
import pytest
from manufactured_discovery import manufactured

from gaitdisc.report.discovery_figure import binned, discovery_figures, typical_stretch
from gaitdisc.results.discovery import Runs


def test_there_is_a_figure_over_the_stride_only_where_there_is_a_phase():
    whole = manufactured()
    runs = whole.runs
    without = Runs(runs.trial, runs.time, runs.phase[:, :0], runs.measured, runs.simulated, runs.augmented)
    assert [one.name for one in discovery_figures(whole)] == ["held_out", "over_stride", "against_state"]
    assert [one.name for one in discovery_figures(manufactured(runs=without))] == ["held_out", "against_state"]


def test_radians_are_drawn_in_degrees():
    whole = manufactured()
    numbers = discovery_figures(whole)[0].numbers
    assert numbers["theta_measured"].iloc[0] == pytest.approx(np.degrees(whole.runs.measured[0, 0, 0]))


def test_the_stretch_is_neither_the_best_nor_the_worst():
    gap = np.repeat([5.0, 1.0, 9.0], 10)
    assert typical_stretch(gap, 10) == (0, 10)
    assert typical_stretch(gap, 100) == (0, 30)


def test_bins_with_few_samples_are_left_out():
    along = np.array([0.1] * 6 + [0.9] * 2)
    table = binned(along, np.full(8, 3.0), np.array([0.0, 0.5, 1.0]))
    assert table["at"].tolist() == [0.25]
    assert table["mean"].tolist() == [3.0]
