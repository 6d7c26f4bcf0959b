"""R2 of every variable: Nominal, Augmented and Exo, network and ridge, and what noise alone would reach."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np
import pandas as pd

from gaitdisc.report.figure import Figure
from gaitdisc.report.palette import MODELS, NULL
from gaitdisc.report.panels import Room, draw_box, in_style, legend, panels, sheets
from gaitdisc.report.r2_summary import R2_TABLE, held_out_text, r2_by_variable, variables
from gaitdisc.report.wording import MODEL_WORDS, counted, label, number
from gaitdisc.results import ResponseRun

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.lines import Line2D

LOWEST = -0.25  # R2 below this is drawn as an arrow at the edge, with its value
FEWEST_FOR_BOXES = 5
MOST_VALUES = 3  # that are written one by one
ROW_IN, LABELLED_ROW_IN = 0.36, 0.5  # a row's height; three lines of labels need more
_OFFSETS = {"nominal": -0.24, "augmented": 0.0, "exo": 0.24}


@in_style
def r2_figures(run: ResponseRun) -> list[Figure]:
    """R2 on the held-out device walk, one row a variable; points for one participant, boxes for several."""
    numbers = r2_numbers(run)
    parts = sheets(variables(run), 12, "r2")
    return [_figure(run, numbers[numbers["variable"].isin(part)], name) for name, part in parts.items()]


def r2_numbers(run: ResponseRun) -> pd.DataFrame:
    """R2 of every participant and variable on the held-out device walk.

    returns: participant, variable, model (empty for the null), kind, r2
    """
    tables = []
    for response in run.responses:
        table = r2_by_variable(response)
        for column in R2_TABLE:
            if column.walk == "exo" and column.kind != "linear":
                tables.append(
                    pd.DataFrame(
                        {
                            "participant": response.participant,
                            "variable": table.index,
                            "model": column.model,
                            "kind": column.kind,
                            "r2": table[column.key].to_numpy(),
                        }
                    )
                )
    columns = pd.Index(["participant", "variable", "model", "kind", "r2"])
    return pd.concat(tables, ignore_index=True) if tables else pd.DataFrame(columns=columns)


def _figure(run: ResponseRun, numbers: pd.DataFrame, name: str) -> Figure:
    names = list(dict.fromkeys(numbers["variable"]))
    low = _limit(numbers)
    row_in = LABELLED_ROW_IN if numbers["r2"].min() < low else ROW_IN
    drawn, [[axes]] = panels(1, 1, row_in * len(names) + 0.1, Room(left=1.75, right=0.25, top=0.45))
    draw_r2(axes, numbers)
    null = _has_null(numbers)
    legend(drawn, r2_key(len(run.responses), null))
    return Figure(name, _caption(run, low, null), _alt(run, numbers), numbers, drawn)


def draw_r2(axes: Axes, numbers: pd.DataFrame) -> None:
    """Draw R2 of every variable, a row each.

    numbers: of `r2_numbers`
    """
    names, low = list(dict.fromkeys(numbers["variable"])), _limit(numbers)
    for row, variable in enumerate(names):
        _draw_variable(axes, numbers[numbers["variable"] == variable], row, low)
    axes.set_yticks(range(len(names)), [label(variable) for variable in names])
    axes.set_ylim(len(names) - 0.5, -0.5)
    axes.set_xlim(low, 1.0)
    axes.set_xlabel("R² on the held-out device walk [1]; 1: all of the variance, 0: no better than the mean")
    for edge in np.arange(len(names) - 1) + 0.5:
        axes.axhline(edge, color="#e4e4e4", linewidth=0.6, zorder=0)
    if low < 0:
        axes.axvline(0.0, color="#bbbbbb", linewidth=0.8, zorder=0)


def _has_null(numbers: pd.DataFrame) -> bool:
    return bool(numbers.loc[numbers["kind"] == "null", "r2"].notna().any())


def _draw_variable(axes: Axes, rows: pd.DataFrame, row: int, low: float) -> None:
    null = rows.loc[rows["kind"] == "null", "r2"].median()
    if np.isfinite(null):
        axes.vlines(max(null, low), row - 0.42, row + 0.42, color=NULL.colour, linestyle=NULL.line, linewidth=1.1)
    for model, offset in _OFFSETS.items():
        look, y = MODELS[model], row + offset
        of_model = rows[rows["model"] == model]
        network = of_model.loc[of_model["kind"] == "network", "r2"].dropna().to_numpy()
        ridge = of_model.loc[of_model["kind"] == "ridge", "r2"].dropna().to_numpy()
        if len(ridge):
            middle = float(np.median(ridge))
            axes.plot([max(middle, low)], [y], look.mark, mfc="none", mec=look.colour, mew=1.1, ms=6.5, clip_on=False)
        if len(network) >= FEWEST_FOR_BOXES:
            draw_box(axes, network, y, look.colour, "horizontal")
        small = 2.2 if len(network) >= FEWEST_FOR_BOXES else 4.6
        shown = np.maximum(network, low)
        axes.plot(shown, np.full(len(shown), y), look.mark, color=look.colour, ms=small, mew=0, clip_on=False, zorder=3)
        if below := _below(network, low):
            axes.annotate(f"◂ {below}", (low, y), (5, 0), textcoords="offset points", va="center", fontsize=6)


def _below(values: np.ndarray, low: float) -> str:
    """One label for all values of a row that lie left of the axis."""
    left = np.sort(values[values < low])
    if len(left) > MOST_VALUES:
        return f"{len(left)} values, {number(left[0])} to {number(left[-1])}"
    return ", ".join(number(value) for value in left)


def r2_key(people: int, null: bool) -> list[Line2D]:
    """Handles of the legend."""
    from matplotlib.lines import Line2D

    models = [
        Line2D([], [], marker=look.mark, color=look.colour, linestyle="", ms=5, mew=0, label=MODEL_WORDS[model])
        for model, look in MODELS.items()
    ]
    hollow = "ridge" if people == 1 else "ridge, median"
    return [
        *models,
        Line2D([], [], marker="o", mfc="none", mec="#333333", linestyle="", ms=6.5, label=hollow),
        *([Line2D([], [], color=NULL.colour, linestyle=NULL.line, label="band-limited noise")] if null else []),
    ]


def _limit(numbers: pd.DataFrame) -> float:
    lowest = float(numbers["r2"].min())
    if not np.isfinite(lowest):
        return 0.0
    return max(LOWEST, float(np.floor(10 * (lowest - 0.02)) / 10))


def _caption(run: ResponseRun, low: float, null: bool) -> str:
    people = len(run.responses)
    marks = (
        "Filled marks: networks; hollow marks of the same shape: ridge regression with phase harmonics"
        if people == 1
        else f"Small filled marks: networks, one a participant, with a box of quartiles from {FEWEST_FOR_BOXES} "
        "participants on (thick line: median, whiskers: all); hollow marks: median of ridge regression with phase "
        "harmonics"
    )
    samples = _samples(run)
    noise = "dashed: what band-limited noise alone would reach" if null else "what noise would reach was not computed"
    edge = f" R² below {number(low)} stands at the left edge with its value." if low == LOWEST else ""
    start = f" The axis starts at {number(low, 1)}." if low > 0 else ""
    return (
        f"R² [1] of the second derivative of each variable on the held-out device walk ({run.exo}), "
        f"n = {counted(people, 'participant')}{samples}; split: last {held_out_text(run)} s of the walk held "
        f"out. {marks}; {noise}.{start}{edge}"
    )


def _samples(run: ResponseRun) -> str:
    counts = run.r2_table()
    counts = counts.loc[(counts["walk"] == "exo") & (counts["kind"] == "network"), "n"]
    if not len(counts):
        return ""
    low, high = int(counts.min()), int(counts.max())
    return f", {low} samples" if low == high else f", {low} to {high} samples each"


def _alt(run: ResponseRun, numbers: pd.DataFrame) -> str:
    network = numbers[numbers["kind"] == "network"]
    parts = [
        f"{MODEL_WORDS[str(model)]} from {number(values.min())} to {number(values.max())}"
        for model, values in network.groupby("model", sort=False)["r2"]
    ]
    count = numbers["variable"].nunique()
    return f"R² of {counted(count, 'variable')} on the held-out device walk of {run.title}: {'; '.join(parts)}."
