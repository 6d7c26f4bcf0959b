"""Sensors: how many are enough and which, every set and model beside Table 5.2, and noise and missing readings."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import numpy as np
import pandas as pd

from gaitdisc.report.figure import Figure
from gaitdisc.report.palette import RECONSTRUCTED
from gaitdisc.report.panels import Room, decades, draw_box, in_style, legend, panels
from gaitdisc.report.table import Table
from gaitdisc.report.wording import counted, label, listed, number, unit_text
from gaitdisc.results.reconstruction import WORTH, enough_sensors, mean_over_people

if TYPE_CHECKING:
    from matplotlib.axes import Axes

STEP, PITCH = 0.23, 1.4  # from one box to the next, and from one sensor set to the next
MEASURES = ("rmse_deg", "relative_l2", "relative_l2_whole", "r2", "coverage", "seconds")
NOT_MSE = (
    "The dissertation calls the norm of the error by the norm of the measured values “MSE” (Eq. 2.21, Table 5.2) and "
    "prints it in degrees; it has no unit. It is compared with the relative L2 here, and with no number in degrees."
)
LESS_THAN_NOTHING = (
    "A relative L2 above 1 is worse than estimating zero; the table prints such values for linear and SDN, so its norm "
    "may be of something else than angles about zero. It has no model that sees history without being a network, and "
    "does not say how time was split or how long the history was: no claim of better or worse is made."
)
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


def sensor_sets_table(summary: pd.DataFrame, printed: pd.DataFrame, name: str, rule: str) -> Table:
    """One row a data set, sensor set and model.

    summary: `summary` of reconstructions, with columns `data` and `sensors`
    printed: sensors, model, mean, sd: of the dissertation
    """
    numbers = pd.DataFrame(
        [
            {"data": data, "sensors": sensors, "model": model, "n": len(own), **_over(own)}
            for (data, sensors, model), own in summary.groupby(["data", "sensors", "model"], sort=False)
        ]
    ).merge(printed, "left", ["sensors", "model"])
    rows: Any = numbers.itertuples()
    cells = tuple(
        (str(row.data), str(row.sensors), str(row.model), str(row.n), *_measures(row), f"{row.seconds:.2f}")
        for row in rows
    )
    columns = (
        "data", "sensors", "model", "n", "RMSE [deg]", "relative L2 [1]", "R² [1]", "relative L2 with sensors ± sd [1]",
        "printed “MSE” ± sd", "fit [s]",
    )  # fmt: skip
    caption = (
        f"Mean over participants [95 % interval of the mean, from three participants], angles that no sensor measures; "
        f"R²: median of the angles. Split: {rule}. {NOT_MSE} {LESS_THAN_NOTHING}"
    )
    return Table(name, caption, columns, cells, numbers)


def _over(own: pd.DataFrame) -> dict[str, float]:
    found: dict[str, float] = {}
    for measure in MEASURES:
        mean, sd, half = mean_over_people(own[measure].to_numpy(float))
        found |= {measure: mean, f"{measure}_sd": sd, f"{measure}_low": mean - half, f"{measure}_high": mean + half}
    return found


def _measures(row: Any) -> tuple[str, ...]:
    return (
        _spread(row.rmse_deg, row.rmse_deg_low, row.rmse_deg_high, 2),
        number(row.relative_l2, 3),
        number(row.r2, 3),
        _with_sd(row.relative_l2_whole, row.relative_l2_whole_sd),
        _with_sd(row.mean, row.sd),
    )


def _spread(mean: float, low: float, high: float, digits: int) -> str:
    return number(mean, digits) + (f" [{number(low, digits)}, {number(high, digits)}]" if np.isfinite(low) else "")


def _with_sd(mean: float, sd: float) -> str:
    if not np.isfinite(mean):
        return "–"
    return number(mean, 3) + (f" ± {number(sd, 3)}" if np.isfinite(sd) else "")


def search_table(found: pd.DataFrame) -> Table:
    """Best set of every size.

    found: `search` of a reconstruction
    """
    chosen = enough_sensors(found)
    rows = tuple(
        (
            f"{row['sensors']}{' *' if k == chosen else ''}",
            listed([label(name) for name in str(row["names"]).split(", ")]),
            number(float(row["loss"]) ** 0.5, 3),
            number(float(row["rmse_deg"]), 2),
            str(row["fits"]),
            f"{row['seconds']:.1f}",
        )
        for k, row in found.reset_index(drop=True).iterrows()
    )
    caption = (
        "Best set of sensors of every size, by ridge regression on their history, all participants together: all sets "
        "of up to three, then the sensor that helps most. Chosen by the RMSE of all angles on the checked windows, "
        "sensors counted as exact; beside it that of the angles that no sensor measures, on the test windows. * the "
        f"smallest set that one more sensor improves by less than {100 * WORTH:.0f} %; without one, the largest."
    )
    columns = ("sensors", "which", "all angles [deg]", "not measured [deg]", "regressions", "processor time [s]")
    return Table("search", caption, columns, rows, found)


def search_sentences(found: pd.DataFrame) -> list[str]:
    """How many sensors are enough, and what one more would bring.

    found: `search` of a reconstruction
    """
    chosen = enough_sensors(found)
    row = found.iloc[chosen]
    names = listed([label(name) for name in str(row["names"]).split(", ")])
    size = int(row["sensors"])
    if chosen + 1 < len(found):
        less = 1 - (float(found["loss"].iloc[chosen + 1]) / float(row["loss"])) ** 0.5
        said = f"{counted(size, 'sensor').capitalize()} {'is' if size == 1 else 'are'} enough: {names}; one more "
        said += f"takes {100 * less:.0f} % off the error of all angles"
    else:
        said = (
            f"The best set of {counted(size, 'sensor')} is {names}; whether it is enough is not known, no larger one "
        )
        said += "was tried"
    cost = f"{counted(int(found['fits'].sum()), 'regression')}, {found['seconds'].sum():.1f} s"
    return [f"{said} (search: {cost})."]


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
