from dataclasses import replace

import numpy as np
import pytest
from matplotlib.figure import Figure

from gaitdisc.channel import Channel
from gaitdisc.processing.curves_figure import (
    course_numbers,
    curve_numbers,
    curves_figures,
    draw_course,
    draw_recording,
    find_walk,
    sides_together,
)
from gaitdisc.processing.pooled_cycles import WALK
from gaitdisc.recording import Recording
from gaitdisc.report.panels import SIDES

OUTPUTS = ("hip_flexion_r", "ankle_angle_l", "pelvis_tilt")


def test_mean_and_spread_of_known_curves(run_maker):
    run = run_maker(outputs=OUTPUTS)
    walk = find_walk(run, "P01", "exo")
    numbers = curve_numbers(run, "P01")
    rows = numbers[(numbers["channel"] == "ankle_angle_l") & (numbers["walk"] == "exo")]
    np.testing.assert_allclose(rows["mean"], walk.curves[:, :, 1].mean(0))
    np.testing.assert_allclose(rows["sd"], walk.curves[:, :, 1].std(0, ddof=1))
    assert set(rows["n"]) == {len(walk.curves)}


def test_missing_strides_lower_n_not_the_mean(run_maker):
    run = run_maker(outputs=OUTPUTS)
    holed = np.array(run.walks[1].curves)
    holed[5:, :, 0] = np.nan
    run = run.with_units(WALK, (run.walks[0], replace(run.walks[1], curves=holed)))
    numbers = curve_numbers(run, "P01")
    rows = numbers[(numbers["channel"] == "hip_flexion_r") & (numbers["walk"] == "exo")]
    np.testing.assert_allclose(rows["mean"], holed[:5, :, 0].mean(0))
    [figure] = curves_figures(run, "P01", "P01")
    assert f"5-{len(holed)} strides (spring)" in figure.caption


def test_what_is_drawn_is_the_csv(run_maker):
    [figure] = curves_figures(run_maker(outputs=OUTPUTS), "P01", "P01")
    groups = list(figure.numbers.groupby("channel", sort=False))
    assert len(groups) == len(figure.drawn.axes) == 3
    for panel, (channel, curves) in zip(figure.drawn.axes, groups, strict=True):
        lines = [line for line in panel.get_lines() if len(line.get_xdata()) == 101]
        for line, walk in zip(lines, ("nominal", "exo"), strict=True):
            np.testing.assert_array_equal(line.get_ydata(), curves.loc[curves["walk"] == walk, "mean"])
        side = "l" if channel.endswith("_l") else "r" if channel.endswith("_r") else ""
        assert lines[1].get_color() == SIDES[side].colour
        assert lines[0].get_linestyle() == "--"
    assert "n = " in figure.caption
    assert "spring" in figure.caption


def test_left_and_right_of_a_joint_stand_together_on_one_scale(run_maker):
    assert sides_together(["a_r", "b", "c_r", "a_l", "c_l"]) == ["a_l", "a_r", "c_l", "c_r", "b"]
    [figure] = curves_figures(run_maker(outputs=("hip_flexion_r", "knee_angle_r", "hip_flexion_l")), "P01", "P01")
    left, right = figure.drawn.axes[:2]
    assert left.get_title() == "hip flexion, left"
    assert left.get_ylim() == right.get_ylim()
    assert right.get_ylabel() == "[deg] ↑ flexion"


def test_a_walk_that_is_missing(run_maker):
    run = run_maker(outputs=OUTPUTS)
    alone = run.with_units(WALK, run.walks[:1])
    assert set(curve_numbers(alone, "P01")["walk"]) == {"nominal"}
    assert len(curves_figures(alone, "P01", "P01")) == 1
    assert curves_figures(run.with_units(WALK, ()), "P01", "P01") == []


@pytest.mark.parametrize("empty", [np.empty((0, 101, 3)), np.full((2, 101, 3), np.nan)])
def test_a_walk_without_strides(run_maker, empty):
    run = run_maker(outputs=OUTPUTS)
    run = run.with_units(WALK, tuple(replace(walk, curves=empty) for walk in run.walks))
    assert len(curves_figures(run, "P01", "P01")) == (1 if len(empty) else 0)


def test_every_channel_has_its_line_and_the_axis_every_unit():
    channels = (Channel("knee_angle_r", "angle", "deg", "r"), Channel("pelvis_tx", "translation", "m"))
    axes = Figure().subplots()
    draw_recording(
        axes, Recording(np.arange(3.0), np.arange(6.0).reshape(3, 2), channels), ["pelvis_tx", "knee_angle_r"]
    )
    np.testing.assert_array_equal(axes.lines[0].get_ydata(), [1.0, 3.0, 5.0])
    assert axes.get_ylabel() == "[m, deg]"


def test_a_mean_course_and_its_spread_by_percent_of_the_stride():
    phi = np.append(np.tile(np.arange(0.5, 100.0), 4), np.nan)
    up = np.append(np.repeat([0.0, 0.0, 2.0, 2.0], 100), 99.0)  # the sample outside of strides is left out
    numbers = course_numbers(phi, np.column_stack([up, np.nan_to_num(phi)]))
    first, second = (rows for _, rows in numbers.groupby("component"))
    np.testing.assert_allclose(first["mean"], 1.0)
    np.testing.assert_allclose(first["sd"], np.std([0.0, 0.0, 2.0, 2.0] * 2, ddof=1))
    np.testing.assert_allclose(second["mean"], second["percent"])
    axes = Figure().subplots()
    draw_course(axes, numbers)
    assert [line.get_label() for line in axes.get_lines()] == ["component 1", "component 2"]
