"""Chapter 5: the error of every sensor set and model as boxes, and against noise and missing readings as lines."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import numpy as np
import pandas as pd

from gaitdisc.report.figure import Figure
from gaitdisc.report.palette import RECONSTRUCTED
from gaitdisc.report.panels import Room, decades, draw_box, in_style, legend, panels
from gaitdisc.words import counted, listed, unit_text

if TYPE_CHECKING:
    from matplotlib.axes import Axes

STEP, PITCH = 0.23, 1.4  # from one box to the next, and from one sensor set to the next
AXES = {
    "noise": "noise of the sensors [% of their standard deviation]",
    "missing": "missing readings [%]",
}


@in_style
def sensor_sets_figure(errors: pd.DataFrame, data: str, name: str, rule: str) -> Figure:
    """One panel a unit, one group of boxes a sensor set, one box a model.

    errors: `errors` of reconstructions, with a column `sensors`
    """
    from matplotlib.lines import Line2D

    shown = errors[errors["model"].isin(list(RECONSTRUCTED))]
    units = [unit for unit in ("deg", "m") if (shown["unit"] == unit).any()]
    models = [model for model in RECONSTRUCTED if (shown["model"] == model).any()]
    drawn, grid = panels(1, len(units), 2.3, Room(left=0.6, across=0.7, bottom=0.5))
    for axes, unit in zip(grid[0], units, strict=True):
        _draw(axes, shown[shown["unit"] == unit], models)
        axes.set_ylabel(f"RMSE of a state [{unit_text(unit)}]")
    legend(drawn, [Line2D([], [], color=RECONSTRUCTED[model].colour, label=model) for model in models])
    people = shown["participant"].nunique()
    caption = (
        f"{data}, n = {counted(people, 'participant')}: RMSE of every state that no sensor measures, by sensor set and "
        f"model; a box over participants and states, median and quartiles, whiskers to the smallest and the largest. "
        f"Split: {rule}. Note the logarithmic axis, and that angles and translations have one each."
    )
    alt = f"Boxes of the error of {listed(models)} for {counted(shown['sensors'].nunique(), 'sensor set')}."
    kept = ["sensors", "participant", "model", "state", "unit", "rmse"]
    return Figure(name, caption, alt, shown[kept], drawn)


def _draw(axes: Axes, errors: pd.DataFrame, models: list[str]) -> None:
    sets = list(dict.fromkeys(errors["sensors"]))
    for place, sensors in enumerate(sets):
        for order, model in enumerate(models):
            rows = errors[(errors["sensors"] == sensors) & (errors["model"] == model)]
            values = rows["rmse"].to_numpy(float)
            if np.isfinite(values).any():
                at = PITCH * place + STEP * (order - (len(models) - 1) / 2)
                draw_box(axes, values[np.isfinite(values)], at, RECONSTRUCTED[model].colour)
    decades(axes)
    axes.set_xticks([PITCH * place for place in range(len(sets))], sets)
    axes.set_xlim(-PITCH / 2, PITCH * (len(sets) - 0.5))


@in_style
def disturbance_figure(found: pd.DataFrame, whose: str, name: str) -> Figure:
    """One panel a disturbance, one line a model.

    found: disturbance, level, model, rmse_deg
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
