"""Nominal, Augmented and Exo side by side over participants, with a bar where two differ (after Fig. 4.2)."""

from __future__ import annotations

import textwrap
from typing import TYPE_CHECKING

import numpy as np
import pandas as pd

from gaitdisc.report.figure import Figure
from gaitdisc.report.palette import MODELS
from gaitdisc.report.panels import Room, draw_box, in_style, legend, panels, sheets
from gaitdisc.report.r2_figure import LOWEST, r2_numbers
from gaitdisc.report.r2_summary import held_out_text, variables
from gaitdisc.report.wording import MODEL_WORDS, counted, label, number
from gaitdisc.results import PairTests, ResponseRun

if TYPE_CHECKING:
    from matplotlib.axes import Axes

MOST = 10  # variables in one figure
HEIGHT = 3.1  # of the panel [inch]
PLACES = {"nominal": -0.27, "augmented": 0.0, "exo": 0.27}
BARS = (("nominal", "augmented"), ("augmented", "exo"), ("nominal", "exo"))  # the longest lies highest


@in_style
def comparison_figures(run: ResponseRun) -> list[Figure]:
    """Boxes of R2 over participants, three a variable, with a bar above every pair that differs.

    run: with tests; where there are none, there is no figure
    """
    if run.tests is None or run.tests.too_few:
        return []
    numbers = r2_numbers(run)
    numbers = numbers[numbers["kind"] == "network"].drop(columns="kind").reset_index(drop=True)
    parts = sheets(variables(run), MOST, "comparison")
    return [_figure(run, run.tests, numbers[numbers["variable"].isin(part)], name) for name, part in parts.items()]


def _figure(run: ResponseRun, tests: PairTests, numbers: pd.DataFrame, name: str) -> Figure:
    names = list(dict.fromkeys(numbers["variable"]))
    drawn, [[axes]] = panels(1, 1, HEIGHT, Room(left=0.6, bottom=0.75))
    low = _lowest(numbers)
    step = 0.05 * (1 - low)
    for place, variable in enumerate(names):
        _draw_boxes(axes, numbers[numbers["variable"] == variable], place)
        for height, pair in enumerate(BARS):
            row = tests.of_pair(*pair)
            if bool(row.loc[row["variable"] == variable, "different"].any()):
                _draw_bar(axes, [place + PLACES[model] for model in pair], 1 + (height + 0.7) * step, 0.2 * step)
    axes.set_xticks(
        range(len(names)), [textwrap.fill(label(variable), 14, break_long_words=False) for variable in names]
    )
    axes.tick_params(axis="x", length=0)
    axes.set_xlim(-0.5, len(names) - 0.5)
    axes.set_ylim(low, 1 + 3.2 * step)
    axes.set_yticks([tick for tick in axes.get_yticks() if low - 1e-9 <= tick <= 1 + 1e-9])
    axes.spines["left"].set_bounds(low, 1)
    axes.set_ylabel("R² on the held-out device walk [1]")
    for edge in np.arange(len(names) - 1) + 0.5:
        axes.axvline(edge, color="#e4e4e4", linewidth=0.6, zorder=0)
    legend(drawn, _key())
    return Figure(name, _caption(run, tests, numbers, low), _alt(tests, names), numbers, drawn)


def _draw_boxes(axes: Axes, rows: pd.DataFrame, place: int) -> None:
    for model, offset in PLACES.items():
        look, x = MODELS[model], place + offset
        values = rows.loc[rows["model"] == model, "r2"].dropna().to_numpy()
        if not len(values):
            continue
        draw_box(axes, values, x, look.colour)
        axes.plot(np.full(len(values), x), values, look.mark, color=look.colour, ms=2.0, mew=0, zorder=3)


def _draw_bar(axes: Axes, across: list[float], y: float, tick: float) -> None:
    left, right = across
    axes.plot([left, left, right, right], [y - tick, y, y, y - tick], color="#111111", linewidth=0.9, clip_on=False)


def _key() -> list:
    from matplotlib.lines import Line2D

    models = [
        Line2D([], [], marker=look.mark, color=look.colour, linestyle="-", ms=4, mew=0, label=MODEL_WORDS[model])
        for model, look in MODELS.items()
    ]
    return [*models, Line2D([], [], color="#111111", linewidth=0.9, label="different")]


def _lowest(numbers: pd.DataFrame) -> float:
    lowest = float(numbers["r2"].min())
    return max(LOWEST, float(np.floor(10 * (lowest - 0.02)) / 10)) if np.isfinite(lowest) else 0.0


def _caption(run: ResponseRun, tests: PairTests, numbers: pd.DataFrame, low: float) -> str:
    hidden = int((numbers["r2"] < low).sum())
    below = (
        f" {counted(hidden, 'value')} below {number(low)} {'is' if hidden == 1 else 'are'} cut off." if hidden else ""
    )
    return (
        f"R² [1] of the second derivative of each variable on the held-out device walk ({run.exo}) over participants, "
        f"n = {counted(tests.participants, 'participant')}; split: last {held_out_text(run)} s of the walk held out. "
        f"Boxes: quartiles, thick line: median, whiskers: all, marks: participants; networks only. A bar joins two "
        f"models that differ: exact two-sided Wilcoxon signed-rank test, Holm-Sidak over the variables of the pair, "
        f"alpha = {tests.alpha:g}.{below} After Fig. 4.2 of the dissertation."
    )


def _alt(tests: PairTests, names: list[str]) -> str:
    said = []
    for first, second in BARS:
        rows = tests.of_pair(first, second)
        count = int(rows.loc[rows["variable"].isin(names), "different"].sum())
        said.append(f"{MODEL_WORDS[first]} and {MODEL_WORDS[second]} differ in {count}")
    return f"Boxes of R² of three models for {counted(len(names), 'variable')}: {', '.join(said)}."
