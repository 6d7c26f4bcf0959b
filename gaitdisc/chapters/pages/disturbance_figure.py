"""Error of every model against noise of the sensors and against missing readings."""

from __future__ import annotations

from typing import Any

import pandas as pd

from gaitdisc.report.figure import Figure
from gaitdisc.report.palette import RECONSTRUCTED
from gaitdisc.report.panels import Room, decades, in_style, legend, panels
from gaitdisc.report.wording import listed

AXES = {
    "noise": "noise of the sensors [% of their standard deviation]",
    "missing": "missing readings [%]",
}


@in_style
def disturbance_figure(found: pd.DataFrame, whose: str, name: str) -> Figure:
    """One panel a disturbance, one line a model.

    Parameters
    ----------
    found : DataFrame
        disturbance, level, model, rmse_deg.
    """
    from matplotlib.lines import Line2D

    kinds = [word for word in AXES if (found["disturbance"] == word).any()]
    models = list(dict.fromkeys(found["model"]))
    drawn, grid = panels(1, len(kinds), 2.1, Room(left=0.6, across=0.6))
    for axes, kind in zip(grid[0], kinds, strict=True):
        for model, rows in found[found["disturbance"] == kind].groupby("model", sort=False):
            axes.plot(100 * rows["level"], rows["rmse_deg"], markersize=3, linewidth=1.1, **_look(str(model)))
        axes.set_xlabel(AXES[kind])
        axes.set_ylabel("RMSE [deg]")
        decades(axes)
    legend(drawn, [Line2D([], [], label=model, markersize=3, **_look(model)) for model in models])
    caption = (
        f"{whose}: RMSE of the angles that no sensor measures, temporal split. Left: white noise on the sensors, in "
        f"the fitted and the test part alike. Right: readings lost one by one in the test part; models were "
        f"fitted to walks that lack none, the last known reading stands for a lost one, and masked shred is "
        f"given which are lost."
    )
    return Figure(name, caption, f"Error of {listed(models)} against noise and missing readings.", found, drawn)


def _look(model: str) -> dict[str, Any]:
    look = RECONSTRUCTED[model]
    return {"color": look.colour, "linestyle": look.line, "marker": look.mark}
