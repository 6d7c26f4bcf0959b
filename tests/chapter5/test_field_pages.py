"""Figures and tables of fields."""

from dataclasses import replace

import numpy as np
import pandas as pd
from chapter5.pages import (
    boxes_figure,
    field_table,
    flow_figure,
    histograms_figure,
    latent_figure,
    maps_figure,
    medians_table,
    routes_figure,
)
from chapter5.reconstruct_field import FieldCell, error_counts
from manufactured_field import travelling_wave
from texts import says

from gaitdisc.recording.field import Axis, Field
from gaitdisc.report.figure import save_figure

WAVE = travelling_wave(20)


def test_maps_share_one_scale_about_zero_and_carry_their_numbers(tmp_path):
    shown = {"measured": WAVE.values[3, :, 0], "reconstructed": 0.5 * WAVE.values[3, :, 0]}
    figure = maps_figure(WAVE, shown, "maps", "As Fig. 5.3")
    assert figure.numbers["points"].tolist() == [WAVE.points] * 2
    assert np.isclose(figure.numbers["sd"][0], 2 * figure.numbers["sd"][1])
    limits = {collection.get_clim() for axes in figure.drawn.axes[:2] for collection in axes.collections}
    assert len(limits) == 1
    low, high = limits.pop()
    assert low == -high
    assert figure.caption == "As Fig. 5.3. h [m]."
    save_figure(figure, tmp_path)
    assert (tmp_path / "maps.png").stat().st_size > 5_000


def test_of_a_volume_the_middle_plane_is_shown():
    axes = tuple(Axis(name, np.arange(4.0)) for name in "zyx")
    values = np.repeat(np.arange(4.0), 16)[None, :, None]
    flow = Field(np.zeros(1), values, axes, np.ones((4, 4, 4), bool), ("u",), ("1",))
    figure = maps_figure(flow, {"flow": flow.values[0, :, 0]}, "maps", "As Fig. 5.2")
    assert figure.numbers["mean"][0] == 2
    assert figure.caption.endswith("Middle plane.")


def test_routes_are_lines_and_fixed_sensors_points():
    places = {"1 fixed": np.tile([[0.0, 4.0]], (5, 1)), "ship": np.column_stack([np.zeros(5), np.arange(5.0)])}
    figure = routes_figure(WAVE, places, "routes", "Routes")
    assert [line.get_linestyle() for line in figure.drawn.axes[0].lines] == ["None", "-"]
    assert figure.numbers.groupby("route")["lon"].max().to_dict() == {"1 fixed": 4, "ship": 4}


def test_the_mean_spectrum_stands_beside_the_slope():
    k = np.arange(1, 16)
    numbers = pd.DataFrame({f"e_{n}": [2.0 * n ** (-5 / 3), 4.0 * n ** (-5 / 3)] for n in k})
    numbers = numbers.assign(snapshot=[0, 10], dissipation=[0.09, 0.11], re_lambda=25.0, kmax_eta=1.3, turnover=3.4)
    figure = flow_figure(numbers, 0.1)
    spectrum, slope = figure.drawn.axes[0].lines[:2]
    np.testing.assert_allclose(spectrum.get_ydata(), 3.0 * k ** (-5 / 3))
    np.testing.assert_allclose(slope.get_ydata(), spectrum.get_ydata())
    labels = [axis.get_label_text() for axes in figure.drawn.axes for axis in (axes.xaxis, axes.yaxis)]
    assert [label for label in labels if not label.endswith("]")] == ["snapshot"]  # a count
    assert "microscale 25.0" in figure.caption
    assert "dissipation 0.1000, power 0.1" in figure.caption


def cell(route, split, run=0, relative_l2=0.5, errors=(0.0, 0.1, -3.0)):
    counts = error_counts(np.array(errors), 1.0)
    return FieldCell("sea", "sst", "degC", route, split, "shred", relative_l2, 1, 0, 1, 0.7, 100, 20, 1.0, run, counts)


def test_runs_of_one_route_are_added_up():
    cells = [cell("fixed", "random"), cell("fixed", "random", run=1), cell("walk", "temporal")]
    numbers = histograms_figure(cells, "a", "As Fig. 5.3").numbers
    assert numbers.groupby(["split", "route"])["count"].sum().to_dict() == {
        ("random", "fixed"): 6,
        ("temporal", "walk"): 3,
    }
    width = 8 / 121
    assert np.isclose(numbers[numbers["split"] == "random"]["density"].sum() * width, 1)


def test_open_ended_bins_are_not_drawn_and_their_share_is_said():
    """Of two errors in three that lie beyond the axis a bin would be made that looks like a peak."""
    errors = (0.0, 0.1, 0.2, -30.0, 30.0, 40.0)
    figure = histograms_figure([cell("fixed", "random", errors=errors)], "a", "As Fig. 5.3")
    [line] = [line for line in figure.drawn.axes[0].lines if len(line.get_xdata()) > 2]
    numbers, width = figure.numbers, 8 / 121
    assert len(line.get_xdata()) == len(numbers) - 2
    assert np.nanmax(np.abs(line.get_xdata())) < 4 - width
    assert numbers["count"].iloc[[0, -1]].tolist() == [1, 2]
    assert says(figure.caption, "below −3.93", "above 3.93 degC, 50 %")
    inner = np.nansum(line.get_ydata()) * width
    assert np.isclose(inner, 0.5)


def test_every_model_is_a_point_and_the_ceiling_a_line():
    cells = [cell(route, split, k, 0.1 * k) for route in ("fixed", "walk") for split in ("a", "b") for k in (1, 2, 3)]
    figure = boxes_figure(cells, "b", "As Fig. 5.2", {"a": 0.05, "b": 0.8})
    assert len(figure.numbers) == 12
    assert 0.8 in [line.get_ydata()[0] for line in figure.drawn.axes[1].lines]
    assert [tick.get_text() for tick in figure.drawn.axes[0].get_xticklabels()] == ["fixed\nn = 3", "walk\nn = 3"]


def test_both_curves_of_the_latent_size():
    found = pd.DataFrame(
        {"nodes": [1, 5, 1, 5], "split": ["a", "a", "b", "b"], "relative_l2": [0.9, 0.5, 1.0, 0.9], "energy_left": 0.3}
    )
    left, right = latent_figure(found, "c", "As Fig. 5.1").drawn.axes
    assert [line.get_label() for line in left.lines[:2]] == ["a", "b"]
    assert left.get_ylabel().endswith("[1]") and right.get_ylabel().endswith("[1]")
    assert right.lines[0].get_ydata().tolist() == [0.3, 0.3]


COUNTS = error_counts(np.zeros(3), 1.0)
FIRST = FieldCell(
    "sea", "sst", "degC", "1 fixed", "temporal", "linear", 0.8, 0.52, 0, 1, 0.3, 100, 20, 1.0, 0, COUNTS
)  # fmt: skip


def test_a_row_a_route_and_a_star_for_the_least():
    cells = [
        replace(FIRST, model="POD ceiling", relative_l2=0.2), FIRST, replace(FIRST, model="shred", relative_l2=0.7),
        replace(FIRST, route="3 fixed", relative_l2=0.5), replace(FIRST, route="3 fixed", model="shred"),
    ]  # fmt: skip
    table = field_table(cells, "t", {("1 fixed", "temporal"): 0.0481})
    assert table.columns == ("route", "linear", "shred", "printed")
    assert table.groups == (("", 1), ("temporal", 3))
    assert table.rows[0] == ("1 fixed", "0.800 (0.52; 0.30)", "0.700* (0.52; 0.30)", "0.0481")
    assert table.rows[1] == ("3 fixed", "0.500* (0.52; 0.30)", "0.800 (0.52; 0.30)", "")
    assert says(table.caption, "temporal, POD", "0.200 (0.52; 0.30)")
    assert "Test snapshots: temporal 20." in table.caption
    assert len(table.numbers) == 5


def test_medians_over_runs_with_their_range():
    runs = [replace(FIRST, run=k, relative_l2=0.1 * k, seconds=2.0) for k in (1, 2, 6)]
    ceiling = replace(FIRST, model="POD ceiling", relative_l2=0.05)
    table = medians_table([ceiling, ceiling, *runs], "m")
    assert table.rows[0][:6] == ("temporal", "POD ceiling", "", "1", "0.050", "0.050 to 0.050")
    assert table.rows[1] == (
        "temporal", "linear", "1 fixed", "3", "0.200", "0.100 to 0.600", "0.300", "+0.0000", "1.0000", "2.0"
    )  # fmt: skip
