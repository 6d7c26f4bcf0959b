"""Residual acceleration over the stride: what each model leaves, mean with its interval and every stride."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np
import pandas as pd
from numpy.typing import NDArray

from gaitdisc.channel import side_of
from gaitdisc.recording import PERCENT
from gaitdisc.recording.arrays import mean_where_known
from gaitdisc.report.figure import Figure
from gaitdisc.report.palette import MODELS, SIDES
from gaitdisc.report.panels import Room, in_style, panels, sheets
from gaitdisc.report.wording import MODEL_WORDS, counted, label, unit_text, upwards
from gaitdisc.results import ParticipantResponse
from gaitdisc.statistics.stride_residuals import LEAST_STRIDES, StrideMean, mean_over_strides

if TYPE_CHECKING:
    from matplotlib.axes import Axes

CONFIDENCE = 0.95
MOST_VECTOR_POINTS = 6_000  # faint strides beyond this are drawn as pixels, or the page grows by megabytes


@in_style
def residual_figures(response: ParticipantResponse, name: str) -> list[Figure]:
    """Measured minus predicted over 0-100 % of the stride: one row an output, one column a model."""
    models = [model for model in MODELS if model in response.residuals]
    if not models or not len(response.residuals[models[0]]):
        return []
    numbers = residual_numbers(response)
    parts = sheets(response.outputs, 6, f"residual-{name}")
    return [_figure(response, numbers[numbers["variable"].isin(part)], sheet) for sheet, part in parts.items()]


def residual_numbers(response: ParticipantResponse) -> pd.DataFrame:
    """Mean residual with its interval, and every stride, point by point.

    returns: variable, unit, model, percent, n (strides with a value there), mean, low, high, stride_1, stride_2, ..
    """
    means = {model: mean_interval(response.residuals[model]) for model in MODELS if model in response.residuals}
    tables = []
    for column, variable in enumerate(response.outputs):
        for model, found in means.items():
            strides = response.residuals[model][:, :, column]
            table = pd.DataFrame(
                {
                    "variable": variable,
                    "unit": response.units[column],
                    "model": model,
                    "percent": PERCENT,
                    "n": found.strides[:, column],
                    "mean": found.mean[:, column],
                    "low": found.low[:, column],
                    "high": found.high[:, column],
                }
            )
            each = pd.DataFrame(strides.T, columns=pd.Index([f"stride_{i + 1}" for i in range(len(strides))]))
            tables.append(pd.concat([table, each], axis=1))
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
    return StrideMean(mean, none, none, count, np.full(mean.shape[1], float(len(residuals))), CONFIDENCE)


def _figure(response: ParticipantResponse, numbers: pd.DataFrame, name: str) -> Figure:
    names = list(dict.fromkeys(numbers["variable"]))
    models = list(dict.fromkeys(numbers["model"]))
    drawn, grid = panels(len(names), len(models), 0.95, Room(across=0.25, down=0.33, top=0.5))
    each = [column for column in numbers.columns if column.startswith("stride_")]
    as_pixels = len(numbers) * len(each) > MOST_VECTOR_POINTS
    for row, (variable, of_variable) in enumerate(numbers.groupby("variable", sort=False)):
        low, high = _limits(of_variable, each)
        for column, (model, curves) in enumerate(of_variable.groupby("model", sort=False)):
            axes = grid[row][column]
            _draw(axes, curves, each, str(model), as_pixels)
            axes.set_ylim(low, high)
            axes.set_xlim(0, 100)
            axes.set_xticks([0, 25, 50, 75, 100])
            axes.tick_params(labelleft=column == 0)
            if row == len(names) - 1:
                axes.set_xlabel("stride [%]")
            else:
                axes.tick_params(labelbottom=False)
        grid[row][0].set_ylabel(f"[{unit_text(str(of_variable['unit'].iloc[0]))}]")
        grid[row][0].set_title(_title(str(variable)), loc="left", color=SIDES[side_of(str(variable))].colour)
    for column, model in enumerate(models):
        x = grid[0][column].get_position()
        drawn.text(
            (x.x0 + x.x1) / 2,
            1 - 0.05 / drawn.get_figheight(),
            f"measured − {MODEL_WORDS[model]}",
            ha="center",
            va="top",
            fontsize=9,
            fontweight="bold",
            color=MODELS[model].colour,
        )
    return Figure(name, _caption(response, numbers), _alt(response, numbers), numbers, drawn)


def _draw(axes: Axes, curves: pd.DataFrame, each: list[str], model: str, as_pixels: bool) -> None:
    look = MODELS[model]
    percent = curves["percent"].to_numpy()
    faint = axes.plot(percent, curves[each].to_numpy(), color=look.colour, alpha=0.28, linewidth=0.5, zorder=1)
    for line in faint:
        line.set_rasterized(as_pixels)
    axes.axhline(0.0, color="#888888", linewidth=0.6, zorder=0)
    axes.fill_between(percent, curves["low"], curves["high"], color=look.colour, alpha=0.35, linewidth=0, zorder=2)
    axes.plot(percent, curves["mean"], color="#111111", linewidth=1.2, zorder=3)


def _limits(numbers: pd.DataFrame, each: list[str]) -> tuple[float, float]:
    values = numbers[["mean", *each]].to_numpy()
    values = values[np.isfinite(values)]
    reach = 1.05 * float(np.max(np.abs(values))) if len(values) else 1.0
    return -(reach or 1.0), reach or 1.0


def _title(variable: str) -> str:
    up = upwards(variable)
    return f"{label(variable)} (up: towards {up})" if up else label(variable)


def _caption(response: ParticipantResponse, numbers: pd.DataFrame) -> str:
    count = len([column for column in numbers.columns if column.startswith("stride_")])
    interval = (
        f"shaded: its {100 * CONFIDENCE:.0f} % interval at each point by itself (Student's t over strides, allowing "
        f"for the likeness of neighbouring strides)"
        if count >= LEAST_STRIDES
        else f"no interval, which needs {LEAST_STRIDES} whole strides"
    )
    return (
        f"{response.participant}: residual of the second derivative, measured minus predicted, over the stride of the "
        f"held-out device walk, n = {counted(count, 'stride')}; split: last {response.held_out_s:.4g} s held out. "
        f"Black: mean; {interval}; faint: every stride. A model that misses nothing leaves a mean of zero. Rows share "
        f"one scale; each row has its unit. Titles in red: left; in blue: right."
    )


def _alt(response: ParticipantResponse, numbers: pd.DataFrame) -> str:
    start = (
        f"Residuals over the stride of {response.participant}, {counted(numbers['variable'].nunique(), 'variable')}. "
    )
    if not numbers["low"].notna().any():
        return f"{start}Too few strides for an interval of the mean."
    parts = [
        f"{MODEL_WORDS[str(model)]} {100 * ((curves['low'] > 0) | (curves['high'] < 0)).mean():.0f} %"
        for model, curves in numbers.groupby("model", sort=False)
    ]
    return f"{start}Share of the stride where the interval of the mean excludes zero: {', '.join(parts)}."
