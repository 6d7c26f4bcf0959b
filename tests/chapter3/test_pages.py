from dataclasses import replace
from functools import partial

import numpy as np
from chapter3.cell import PARTS, DiscrepancyCell, PartAccuracy
from chapter3.pages import (
    accuracy_figure,
    answered,
    blocks_of,
    cost_figure,
    error_figure,
    field_figure,
    grid_table,
    horizon_figure,
    system_figure,
)
from markdown_table import as_markdown
from texts import says

TIME = np.arange(301) / 10
TRUTH = np.column_stack([np.sin(TIME), np.cos(TIME)])
SINE = TRUTH[:, :1]
LOST = np.where(TIME[:, None] > 3, np.nan, SINE)


def cell(augmented, diverged=None, seed=0, **others):
    """Of one channel, known to 0.2."""
    parts = dict.fromkeys(PARTS, PartAccuracy(TIME, SINE, SINE + 0.2, augmented, diverged))
    plain = DiscrepancyCell("s", "gp", "state", "right", 0.1, seed, ("x",), parts, 1.0, 0.0)
    return replace(plain, **others)


def cells():
    found = []
    for approach in ("dynamics", "state"):
        for k, method in enumerate(("sindy", "dmd", "gp", "nn")):
            part = PartAccuracy(TIME, TRUTH, TRUTH + 0.2, TRUTH + 0.05 * k, None)
            names = dict.fromkeys(PARTS, part)
            found.append(DiscrepancyCell("s", method, approach, "right", 0.0, 0, ("x", "y"), names, 1.0 + k, 0.1))
    return found


def test_each_figure_carries_the_numbers_drawn():
    some = cells()
    lines = error_figure(some[:4], "a", "Fig. 3.3").numbers
    assert np.allclose(lines["known"], -0.2)
    bars = accuracy_figure(some, "b", "Fig. 3.5").numbers
    assert bars.groupby("method")["median"].median().round(6).to_dict() == {"sindy": 100, "dmd": 75, "gp": 50, "nn": 25}
    assert np.allclose(horizon_figure(some, "c", "Fig. 3.9").numbers.groupby("method")["accuracy"].first()["gp"], 50)
    assert cost_figure(some, "d", "Fig. 3.11").numbers["fit_s"].tolist() == [1, 2, 3, 4] * 2
    part = some[0].parts["forecast"]
    both = system_figure(some[0], np.column_stack([0 * TIME, TIME]), "e", "Fig. 3.2")
    assert both.drawn.axes[2].get_title() == "dynamical error: rate of y"
    assert np.allclose(both.numbers["missing rate"], both.numbers["t_s"])
    assert np.allclose(both.numbers["residual"], -0.2)
    assert np.allclose(field_figure(part, (0.0, 1.0), "f", "Fig. 3.12").numbers["rmse_known"], 0.2)


def test_a_run_that_diverged_is_said_in_its_title():
    assert says(error_figure([cell(LOST, 3.0)], "a", "Fig. 3.4").drawn.axes[0].get_title(), "diverged", "3.00 s")


def test_bars_of_seeds_of_which_one_diverged_are_a_cross_and_no_number():
    figure = accuracy_figure([cell(LOST, 3.0), cell(SINE + 0.1, seed=1)], "b", "Fig. 3.4")
    assert figure.numbers["median"].isna().all()
    assert figure.numbers["diverged_s"].tolist() == [3.0, 3.0, 3.0]
    assert [len(line.get_xdata()) for line in figure.drawn.axes[0].lines if line.get_marker() == "x"] == [1]


def begun(at_s, units=("m", "1")):
    part = PartAccuracy(TIME, TRUTH, TRUTH + 0.2, TRUTH + 0.1, None, at_s)
    parts = dict.fromkeys(PARTS, part) | {PARTS[0]: PartAccuracy(TIME, TRUTH, TRUTH + 0.2, TRUTH + 0.1, None)}
    return DiscrepancyCell("s", "gp", "dynamics", "right", 0.0, 0, ("x", "y"), parts, 1.0, 0.1, units=units)


def test_errors_have_a_quantity_and_a_unit_and_a_forecast_begins_where_the_record_has_got_to():
    figure = error_figure([begun(30.0)], "a", "Fig. 3.3")
    first, oracle, forecast = figure.drawn.axes
    assert first.get_ylabel() == "Gaussian process\nerror of x [m]"
    assert error_figure([begun(30.0)], "a", "", channel=1).drawn.axes[0].get_ylabel().endswith("\nerror of y [1]")
    assert {axes.get_xlabel() for axes in figure.drawn.axes} == {"time in the record [s]"}
    assert [axes.get_xlim() for axes in (first, oracle, forecast)] == [(0.0, 30.0), (30.0, 60.0), (30.0, 60.0)]
    for axes in (oracle, forecast):
        assert all((line.get_xdata()[0], line.get_xdata()[-1]) == (30.0, 60.0) for line in axes.lines)
    assert [axes.get_title() for axes in (oracle, forecast)] == [
        "forecast, oracle start", "forecast, estimated start",
    ]  # fmt: skip
    assert "an oracle" in figure.caption
    assert figure.numbers.groupby("part", sort=False)["t_s"].min().tolist() == [0.0, 30.0, 30.0]


def test_a_horizon_ends_with_the_forecast():
    short = PartAccuracy(TIME[:81], TRUTH[:81], TRUTH[:81] + 0.2, TRUTH[:81] + 0.1, None, 12.0)
    cell = DiscrepancyCell("s", "gp", "dynamics", "right", 0.0, 0, ("x",), dict.fromkeys(PARTS, short), 1.0, 0.1)
    figure = horizon_figure([cell], "c", "Fig. 3.9")
    assert figure.numbers["horizon_s"].max() == 8.0
    assert figure.drawn.axes[0].get_xlim()[1] == 8.0
    assert max(figure.drawn.axes[0].lines[0].get_xdata()) == 8.0
    assert figure.drawn.axes[0].get_ylabel() == "less RMSE than known [%]"
    assert max(horizon_figure(cells(), "c", "Fig. 3.9").numbers["horizon_s"]) == 30.0


def test_a_field_has_a_bar_of_its_colours_and_the_records_time():
    part = PartAccuracy(TIME, TRUTH, TRUTH + 0.2, TRUTH + 0.5, None, 30.0)
    figure = field_figure(part, (0.0, 1.0), "f", "Fig. 3.12")
    known, _, bar = figure.drawn.axes
    assert (known.get_xlabel(), known.get_ylabel()) == ("place [1]", "time in the record [s]")
    assert bar.get_ylabel() == "error of u [1]"
    assert np.allclose(bar.get_ylim(), (-0.2, 0.2))
    assert figure.numbers["t_s"].iloc[[0, -1]].tolist() == [30.0, 60.0]
    assert np.allclose([mesh.get_clim() for axes in figure.drawn.axes[:2] for mesh in axes.collections], (-0.2, 0.2))


def test_every_panel_of_the_other_figures_has_a_quantity_and_a_unit():
    cell = begun(30.0)
    system = system_figure(cell, np.column_stack([0 * TIME, TIME]), "e", "Fig. 3.2").drawn
    labels = [(axes.get_xlabel(), axes.get_ylabel()) for axes in system.axes]
    assert labels == [
        ("x [m]", "y [1]"), ("time [s]", "x [m]"), ("time [s]", "missing rate of y [1/s]"),
        ("x [m]", "y [1]"), ("time [s]", "y [1]"), ("time [s]", "truth − known, x [m]"),
    ]  # fmt: skip
    fast = system_figure(begun(30.0, ("m", "m/s")), np.column_stack([0 * TIME, TIME]), "e", "Fig. 3.2").drawn
    assert fast.axes[2].get_ylabel() == "missing rate of y [m/s²]"
    bars = accuracy_figure([cell], "b", "Fig. 3.5").drawn.axes
    assert bars[0].get_ylabel() == "less RMSE than known [%]"
    assert all(says(axes.get_xlabel(), "noise", "SD]") for axes in bars)
    assert cost_figure([cell], "d", "Fig. 3.11").drawn.axes[0].get_ylabel() == "processor time [s]"


def test_a_cell_that_diverged_is_a_time_and_never_a_number():
    table = grid_table([cell(LOST, 3.0), cell(SINE + 0.1, seed=1)], "t")
    assert says(table.rows[0][6], "diverged", "3.00 s", "1 of 2 seeds")


def test_a_cell_is_its_accuracy_and_a_table_is_markdown():
    table = grid_table([cell(SINE + 0.1, None)], "t")
    assert table.rows[0][6] == "50.0"
    assert as_markdown(table).count("\n") == 2


def test_what_was_refused_says_so():
    refused = DiscrepancyCell("s", "gp", "state", "right", 0.1, 0, ("x",), {}, 1.0, 0.0, refused="40 too few")
    row = grid_table([refused], "t").rows[0]
    assert row[5] == "not fitted"
    assert row[-1] == "40 too few"


def test_seeds_are_stated_as_median_and_range_and_their_terms_are_counted():
    cells = [replace(cell(SINE + off, None, k), terms=terms) for k, (off, terms) in enumerate(
        [(0.1, "x: -0.01*x**3"), (0.05, "x: -0.0101*x**3"), (0.15, "x: 1e-05*1")])]  # fmt: skip
    row = grid_table(cells, "t").rows[0]
    assert (row[4], row[6]) == ("3", "50.0 [25.0, 75.0]")
    assert says(row[-1], "-0.01*x**3", "2 of 3 seeds")


def test_what_some_seeds_refused_is_counted():
    refused = replace(cell(SINE, None, 1), parts={}, refused="40 too few")
    row = grid_table([cell(SINE + 0.1, None), refused], "t").rows[0]
    assert row[6] == "50.0 (1 of 2 seeds)"
    assert says(row[-1], "40 too few", "1 of 2 seeds")


def test_an_error_of_many_times_the_known_one_is_no_number_to_four_digits():
    cells = [cell(SINE + off, None, k) for k, off in enumerate((0.1, 0.05, 2.1, 2.3, 9e3))]  # known: 0.2
    assert grid_table(cells, "t").rows[0][6] == "-950.0 [below -1000, 75.0]"


of_rates = partial(cell, approach="dynamics", noise=0.0)


def test_a_statement_without_cells_is_not_answered():
    assert answered({"text": ()}, "dynamics", 0.0) == "not computed"


def test_seeds_are_median_and_range_and_one_that_diverged_is_a_time():
    quiet = [of_rates(SINE + off, seed=seed) for seed, off in enumerate((0.1, 0.05))]
    assert "62.5 [50.0, 75.0]" in answered({"text": tuple(quiet)}, "dynamics", 0.0)
    said = answered({"text": (quiet[0], of_rates(LOST, 3.0, 1))}, "dynamics", 0.0)
    assert says(said, "diverged", "3.00 s", "1 of 2 seeds")
    assert "50.0" not in said


def test_captions_are_answered_with_cost_and_horizon():
    cells = {"text": (of_rates(SINE + 0.1, fit_s=5.0), of_rates(SINE + 0.05, method="sindy"))}
    figures = {"cost": "Fig. 3.11", "horizon": "Fig. 3.9", "system": "Fig. 3.2", "noise": "Fig. 3.10"}
    said = blocks_of(cells, figures, ())[0].tables[0].rows
    assert [where for where, _, _ in said] == ["Fig. 3.2", "Fig. 3.9", "Fig. 3.11"]
    assert says(said[2][2], "SINDy 1.0 s", "Gaussian process 5.0 s")
    assert "Gaussian process 50/50/50/50" in said[1][2]
