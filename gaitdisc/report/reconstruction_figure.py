"""Measured against reconstructed states over the stride."""

from __future__ import annotations

from typing import TYPE_CHECKING

import pandas as pd

from gaitdisc.report.figure import Figure
from gaitdisc.report.palette import MEASURED, RECONSTRUCTED
from gaitdisc.report.panels import Room, in_style, legend, lines_of, panels_for, sheets
from gaitdisc.report.wording import counted, label, unit_text
from gaitdisc.results.reconstruction import Reconstruction

if TYPE_CHECKING:
    from matplotlib.artist import Artist
    from matplotlib.axes import Axes

MOST_PANELS = 16


@in_style
def reconstruction_figures(done: Reconstruction, participant: str, name: str) -> list[Figure]:
    """One panel a state: the mean of what was measured with its spread, and what the models tell."""
    curves = shown_curves(done, participant)
    return [
        _figure(done, participant, curves[curves["state"].isin([channel.name for channel in part])], f"{name}-{k + 1}")
        for k, part in enumerate(sheets(list(done.states), MOST_PANELS, name).values())
    ]


def shown_curves(done: Reconstruction, participant: str) -> pd.DataFrame:
    """Curves of one person, of the models that are drawn: linear, the recommended one, SHRED."""
    shown = [kind for kind in ("linear", done.recommended, "shred") if kind in done.models]
    shown = list(dict.fromkeys(shown))
    return done.curves[(done.curves["participant"] == participant) & done.curves["model"].isin(shown)]


def states_key(models: list[str]) -> list[Artist]:
    """Handles of the legend: what was measured, and the models."""
    from matplotlib.patches import Patch

    looks = {model: RECONSTRUCTED[model.removesuffix(", calibrated")] for model in models}
    return [Patch(color=MEASURED.colour, alpha=0.2, label="measured, mean ± sd"), *lines_of(looks)]


def _figure(done: Reconstruction, participant: str, numbers: pd.DataFrame, name: str) -> Figure:
    units = {channel.name: channel.unit for channel in done.states}
    states, models = list(dict.fromkeys(numbers["state"])), list(dict.fromkeys(numbers["model"]))
    drawn, cells = panels_for(len(states), 4, 1.1, Room(left=0.6, across=0.6, down=0.46))
    for axes, state in zip(cells, states, strict=True):
        draw_state(axes, numbers[numbers["state"] == state])
        axes.set_title(label(state), fontsize=7.4)
        axes.set_ylabel(f"[{unit_text(units[state])}]", fontsize=6.8, labelpad=1)
        axes.set_xlim(0, 100)
        axes.set_xticks([0, 50, 100])
    for axes in cells[-4:]:
        axes.set_xlabel("stride [%]", labelpad=1)
    legend(drawn, states_key(models))
    strides = int(done.summary.loc[done.summary["participant"] == participant, "strides"].iloc[0])
    caption = (
        f"{participant}: states measured and reconstructed over the stride, test windows alone, n = "
        f"{counted(strides, 'stride')}. Band: measured, mean ± standard deviation; lines: mean of what each model "
        f"estimates from {counted(len(done.sensors), 'sensor')}. Split: {done.split}."
    )
    by = ", ".join(models)
    alt = f"{counted(len(states), 'state')} of {participant} over the stride, measured, and reconstructed by {by}."
    return Figure(f"reconstruction-{name}", caption, alt, numbers, drawn)


def draw_state(axes: Axes, numbers: pd.DataFrame) -> None:
    """Draw one state over the stride: measured with its spread, and what each model estimates.

    numbers: rows of `Reconstruction.curves` of one person and state
    """
    for number, (model, rows) in enumerate(numbers.groupby("model", sort=False)):
        if number == 0:
            low, high = rows["measured"] - rows["measured_sd"], rows["measured"] + rows["measured_sd"]
            axes.fill_between(rows["percent"], low, high, color=MEASURED.colour, alpha=0.2, linewidth=0)
        look = RECONSTRUCTED[str(model).removesuffix(", calibrated")]
        axes.plot(rows["percent"], rows["reconstructed"], color=look.colour, linestyle=look.line, linewidth=1.1)
