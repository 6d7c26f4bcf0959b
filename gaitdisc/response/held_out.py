"""The held-out walk: measured against predicted in its last seconds, and what each model leaves over the stride."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np
import pandas as pd
from numpy.typing import NDArray

from gaitdisc.channel import find_side
from gaitdisc.recording import PERCENT
from gaitdisc.recording.arrays import mean_where_known
from gaitdisc.report.figure import Figure
from gaitdisc.report.panels import MEASURED, MODELS, SIDES, Room, in_style, legend, panels, panels_for, sheets
from gaitdisc.response.participant_response import ParticipantResponse
from gaitdisc.response.r2_tables import r2_by_variable
from gaitdisc.statistics.stride_residuals import LEAST_STRIDES, StrideMean, mean_over_strides
from gaitdisc.words import MODEL_WORDS, counted, label, number, unit_text, upwards

if TYPE_CHECKING:
    from matplotlib.axes import Axes

WINDOW_S = 4.0
_DRAWN = ("nominal", "augmented")
_BANDED, _BAND = "augmented", ("augmented_low", "augmented_high")
CONFIDENCE = 0.95
MOST_VECTOR_POINTS = 6_000  # faint strides beyond this are drawn as pixels, or the page grows by megabytes


@in_style
def draw_held_out(response: ParticipantResponse, name: str) -> list[Figure]:
    """Measured against predicted in the last seconds of the held-out device walk, one panel an output."""
    numbers = tabulate_held_out(response)
    if not len(numbers):
        return []
    pages = sheets(response.outputs, 12, f"held-out-{name}")
    return [_figure(response, numbers[numbers["variable"].isin(part)], sheet) for sheet, part in pages.items()]


def tabulate_held_out(response: ParticipantResponse) -> pd.DataFrame:
    """Measured and predicted second derivatives of the last `WINDOW_S` seconds, a band where there is one."""
    held = response.held_out
    shown = held.time >= (held.time[-1] - WINDOW_S if len(held.time) else 0.0)
    known = {"measured": held.measured, **{model: held.predicted[model] for model in _DRAWN if model in held.predicted}}
    if _BANDED in held.bands:
        known |= dict(zip(_BAND, held.bands[_BANDED], strict=True))
    tables = [
        pd.DataFrame(
            {"variable": variable, "unit": unit, "time_s": held.time[shown], "percent": held.phi[shown]}
        ).assign(**{name: values[shown, column] for name, values in known.items()})
        for column, (variable, unit) in enumerate(zip(response.outputs, response.units, strict=True))
    ]
    return pd.concat(tables, ignore_index=True)


def _figure(response: ParticipantResponse, numbers: pd.DataFrame, name: str) -> Figure:
    groups = list(numbers.groupby("variable", sort=False))
    drawn, cells = panels_for(len(groups), 2, 1.05, Room(left=0.82, across=0.82, top=0.5))
    r2 = r2_by_variable(response)[[f"{model}_on_exo" for model in _DRAWN]]
    for axes, (variable, rows) in zip(cells, groups, strict=True):
        _draw(axes, rows)
        nominal, augmented = (float(r2[column].loc[str(variable)]) for column in r2)
        known = np.isfinite(nominal) and np.isfinite(augmented)
        title = label(str(variable)) + (f": R² {number(nominal)} → {number(augmented)}" if known else "")
        axes.set_title(title, loc="left", color=SIDES[find_side(str(variable))].colour)
        up = upwards(str(variable))
        axes.set_ylabel(f"[{unit_text(str(rows['unit'].iloc[0]))}]" + (f"\n↑ {up}" if up else ""))
        axes.set_xlim(rows["time_s"].iloc[0], rows["time_s"].iloc[-1])
    for axes in cells[-2:]:
        axes.set_xlabel("time in the trial [s]")
    legend(drawn, cells[0].get_lines())
    alt = (
        f"Measured and predicted accelerations of {response.participant} in {counted(len(groups), 'panel')}; median R² "
        f"{number(r2['nominal_on_exo'].median())} for Nominal and {number(r2['augmented_on_exo'].median())} "
        f"for Augmented."
    )
    return Figure(name, _caption(response, groups[0][1]), alt, numbers, drawn)


def _draw(axes: Axes, rows: pd.DataFrame) -> None:
    rows = _broken(rows)
    time, measured = rows["time_s"], rows["measured"]
    low, high = _BAND
    if low in rows:
        axes.fill_between(time, rows[low], rows[high], color=MODELS[_BANDED].colour, alpha=0.25, linewidth=0)
    axes.plot(time, measured, color=MEASURED.colour, linewidth=1.4, label="measured")
    for model in _DRAWN:
        if model not in rows:
            continue
        look = MODELS[model]
        axes.fill_between(
            time, measured, rows[model], color=look.colour, alpha=0.3 if model == "nominal" else 0.5, linewidth=0
        )
        axes.plot(time, rows[model], color=look.colour, linestyle=look.line, linewidth=0.9, label=MODEL_WORDS[model])


def _broken(rows: pd.DataFrame) -> pd.DataFrame:
    # samples that were left away are not bridged by a line
    time = rows["time_s"].to_numpy()
    step = np.diff(time)
    after = np.flatnonzero(step > 1.5 * np.median(step)) if len(step) else np.array([], int)
    if not len(after):
        return rows
    holes = rows.iloc[after].copy()
    holes["time_s"] += float(np.median(step))
    holes[[str(name) for name in rows if name not in ("variable", "unit", "time_s", "percent")]] = np.nan
    return pd.concat([rows, holes]).sort_values("time_s", kind="stable")


def _caption(response: ParticipantResponse, rows: pd.DataFrame) -> str:
    looks = {"nominal": "orange, dashed: Nominal", "augmented": "green, solid: Augmented"}
    models = "; ".join(words for model, words in looks.items() if model in rows)
    held, band = response.held_out, ""
    if _BANDED in held.bands:  # what the bands hold of all held-out samples, in the mean over variables
        inside = {m: 100 * np.mean((b[0] <= held.measured) & (held.measured <= b[1])) for m, b in held.bands.items()}
        shares = ", ".join(f"{value:.0f} % for {MODEL_WORDS[model]}" for model, value in inside.items())
        band = f"Pale green: 90 % band of Augmented, from refits on blocks; share of samples in such a band: {shares}. "
    return (
        f"{response.participant}: the last {WINDOW_S:g} s of the held-out device walk, n = "
        f"{len(rows)} of {counted(len(held.time), 'sample')} shown; split: last {response.held_out_s:.4g} s held out, "
        f"used by no model. Black: measured second derivative; {models}. Shaded: the residual of each model. {band}R² "
        "(Nominal → Augmented) is over all held-out samples. Each panel has its own unit. Red titles: left "
        "side; blue: right."
    )


@in_style
def residual_figures(response: ParticipantResponse, name: str) -> list[Figure]:
    """Measured minus predicted over 0-100 % of the stride: one row an output, one column a model."""
    models = [model for model in MODELS if model in response.residuals]
    if not models or not len(response.residuals[models[0]]):
        return []
    numbers = residual_numbers(response)
    pages = sheets(response.outputs, 6, f"residual-{name}")
    return [_residual_figure(response, numbers[numbers["variable"].isin(part)], sheet) for sheet, part in pages.items()]


def residual_numbers(response: ParticipantResponse) -> pd.DataFrame:
    """Mean residual and its interval by variable, model and percent with n; each stride in a column of its own."""
    means = {model: mean_interval(response.residuals[model]) for model in MODELS if model in response.residuals}
    tables = []
    for column, (variable, unit) in enumerate(zip(response.outputs, response.units, strict=True)):
        for model, interval in means.items():
            table = pd.DataFrame({"variable": variable, "unit": unit, "model": model, "percent": PERCENT})
            table["n"] = interval.strides[:, column]
            for bound in ("mean", "low", "high"):
                table[bound] = getattr(interval, bound)[:, column]
            strides = response.residuals[model][:, :, column]
            columns = pd.DataFrame(strides.T, columns=pd.Index([f"stride_{i + 1}" for i in range(len(strides))]))
            tables.append(pd.concat([table, columns], axis=1))
    return pd.concat(tables, ignore_index=True)


def mean_interval(residuals: NDArray[np.float64]) -> StrideMean:
    """Mean over strides with its interval; with too few strides for an interval, the mean alone.

    residuals (stride, phase, output) [unit/s2]: in order of time; NaN where a stride has no value

    >>> found = mean_interval(np.ones((2, 101, 1)))
    >>> float(found.mean[0, 0]), float(found.low[0, 0])
    (1.0, nan)
    """
    if len(residuals) >= LEAST_STRIDES:
        return mean_over_strides(residuals, CONFIDENCE)
    mean, count = mean_where_known(residuals), np.isfinite(residuals).sum(axis=0)
    none = np.full_like(mean, np.nan)
    return StrideMean(mean, none, none, count, CONFIDENCE)


def _residual_figure(response: ParticipantResponse, numbers: pd.DataFrame, name: str) -> Figure:
    names = list(dict.fromkeys(numbers["variable"]))
    models = list(dict.fromkeys(numbers["model"]))
    drawn, grid = panels(len(names), len(models), 0.95, Room(across=0.25, down=0.33, top=0.5))
    columns = [column for column in numbers.columns if column.startswith("stride_")]
    as_pixels = len(numbers) * len(columns) > MOST_VECTOR_POINTS
    for row, (variable, of_variable) in zip(grid, numbers.groupby("variable", sort=False), strict=True):
        _draw_residuals(row, str(variable), of_variable, columns, as_pixels)
        for axes in row:
            if row is grid[-1]:
                axes.set_xlabel("stride [%]")
            else:
                axes.tick_params(labelbottom=False)
    for axes, model in zip(grid[0], models, strict=True):
        place = axes.get_position()
        centre, top = (place.x0 + place.x1) / 2, 1 - 0.05 / drawn.get_figheight()
        style = {"ha": "center", "va": "top", "fontsize": 9, "fontweight": "bold", "color": MODELS[model].colour}
        drawn.text(centre, top, f"measured − {MODEL_WORDS[model]}", **style)
    interval = (
        f"shaded: {100 * CONFIDENCE:.0f} % confidence interval of the mean at each point (Student's t over strides, "
        "corrected for the correlation of neighbouring strides)"
        if len(columns) >= LEAST_STRIDES
        else f"no interval, because it requires {LEAST_STRIDES} complete strides"
    )
    caption = (
        f"{response.participant}: residual of the second derivative, measured minus predicted, over the stride of the "
        f"held-out device walk, n = {counted(len(columns), 'stride')}; split: last {response.held_out_s:.4g} s held "
        f"out. Black: mean; {interval}. Faint: every stride. A perfect model has a mean of zero. Each row has one "
        "scale and one unit. Red titles: left side; blue: right."
    )
    percents = [
        f"{MODEL_WORDS[str(model)]} {100 * ((curves['low'] > 0) | (curves['high'] < 0)).mean():.0f} %"
        for model, curves in numbers.groupby("model", sort=False)
    ]
    shares = f"Share of the stride in which the confidence interval of the mean excludes zero: {', '.join(percents)}."
    few = "There are too few strides for a confidence interval of the mean."
    alt = (
        f"Residuals over the stride of {response.participant}, {counted(len(names), 'variable')}. "
        f"{shares if numbers['low'].notna().any() else few}"
    )
    return Figure(name, caption, alt, numbers, drawn)


def _draw_residuals(
    row: list[Axes], variable: str, of_variable: pd.DataFrame, columns: list[str], as_pixels: bool
) -> None:
    """Draw what every model leaves of one variable, a panel a model, on one scale."""
    values = of_variable[["mean", *columns]].to_numpy()
    values = values[np.isfinite(values)]
    reach = (1.05 * float(np.max(np.abs(values))) if len(values) else 1.0) or 1.0
    for axes, (model, curves) in zip(row, of_variable.groupby("model", sort=False), strict=True):
        _draw_residual(axes, curves, columns, str(model), as_pixels)
        axes.set_ylim(-reach, reach)
        axes.set_xlim(0, 100)
        axes.set_xticks([0, 25, 50, 75, 100])
        axes.tick_params(labelleft=axes is row[0])
    row[0].set_ylabel(f"[{unit_text(str(of_variable['unit'].iloc[0]))}]")
    up = f" (up: towards {towards})" if (towards := upwards(variable)) else ""
    row[0].set_title(f"{label(variable)}{up}", loc="left", color=SIDES[find_side(variable)].colour)


def _draw_residual(axes: Axes, curves: pd.DataFrame, columns: list[str], model: str, as_pixels: bool) -> None:
    look = MODELS[model]
    percent = curves["percent"].to_numpy()
    faint = axes.plot(percent, curves[columns].to_numpy(), color=look.colour, alpha=0.28, linewidth=0.5, zorder=1)
    for line in faint:
        line.set_rasterized(as_pixels)
    axes.axhline(0.0, color="#888888", linewidth=0.6, zorder=0)
    axes.fill_between(percent, curves["low"], curves["high"], color=look.colour, alpha=0.35, linewidth=0, zorder=2)
    axes.plot(percent, curves["mean"], color="#111111", linewidth=1.2, zorder=3)
