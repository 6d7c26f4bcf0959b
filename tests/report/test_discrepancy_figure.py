import numpy as np

from gaitdisc.report.discrepancy_figure import (
    accuracy_figure,
    cost_figure,
    error_figure,
    field_figure,
    horizon_figure,
    system_figure,
)
from gaitdisc.results.discrepancy_cell import PARTS, DiscrepancyCell, PartAccuracy

TIME = np.arange(301) / 10
TRUTH = np.column_stack([np.sin(TIME), np.cos(TIME)])


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
    both = system_figure(part, np.column_stack([0 * TIME, TIME]), ("x", "y"), "e", "Fig. 3.2")
    assert both.drawn.axes[2].get_title() == "dynamical error: rate of y"
    assert np.allclose(both.numbers["missing rate"], both.numbers["t_s"])
    assert np.allclose(both.numbers["residual"], -0.2)
    assert np.allclose(field_figure(part, (0.0, 1.0), "f", "Fig. 3.12").numbers["rmse_known"], 0.2)


def test_a_run_that_diverged_is_said_in_its_title():
    values = np.where(TIME[:, None] > 3, np.nan, TRUTH)
    names = dict.fromkeys(PARTS, PartAccuracy(TIME, TRUTH, TRUTH + 0.2, values, 3.0))
    cell = DiscrepancyCell("s", "gp", "state", "right", 0.0, 0, ("x", "y"), names, 1.0, 0.1)
    assert "diverged at t = 3.00 s" in error_figure([cell], "a", "Fig. 3.4").drawn.axes[0].get_title()


def test_bars_of_seeds_of_which_one_diverged_are_a_cross_and_no_number():
    values = np.where(TIME[:, None] > 3, np.nan, TRUTH)
    parts = [PartAccuracy(TIME, TRUTH, TRUTH + 0.2, v, d) for v, d in ((values, 3.0), (TRUTH + 0.1, None))]
    some = [
        DiscrepancyCell("s", "gp", "state", "right", 0.0, seed, ("x", "y"), dict.fromkeys(PARTS, part), 1.0, 0.1)
        for seed, part in enumerate(parts)
    ]
    figure = accuracy_figure(some, "b", "Fig. 3.4")
    assert figure.numbers["median"].isna().all()
    assert figure.numbers["diverged_s"].tolist() == [3.0, 3.0]
    assert [len(line.get_xdata()) for line in figure.drawn.axes[0].lines if line.get_marker() == "x"] == [1]
