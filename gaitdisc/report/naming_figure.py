"""Figure of who names what is hidden: a tile for every case, tool and noise."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
import pandas as pd

from gaitdisc.report.figure import Figure
from gaitdisc.report.naming_table import TOOL_WORDS, seeds_of
from gaitdisc.report.panels import Room, in_style, legend, panels
from gaitdisc.results.naming import Naming, namings_table

RIGHT, HALF, WRONG, SILENT, CURVE = "#00875a", "#8fd0b5", "#d97700", "#ffffff", "#c9ced6"
LOOKS = {
    "right": (RIGHT, "N", "right, and nothing else"),
    "tied": (HALF, "T", "right or another, tied"),
    "among others": (HALF, "A", "right among others"),
    "wrong name": (WRONG, "W", "wrong name"),
    "curve": (CURVE, "C", "a curve, no name"),
    "nothing": (SILENT, "–", "nothing found"),
    "refused": (SILENT, "R", "refused"),
}
ROW, LEFT = 0.27, 1.75  # inch
FEW, MANY = -999.0, 99.5  # accuracies beyond are told as such


@in_style
def naming_figure(namings: Sequence[Naming], name: str) -> Figure:
    """A row a case, a column a tool and noise; the tile tells the answer, and the forecast.

    Parameters
    ----------
    namings : sequence of Naming
        Of all seeds.
    name : str
        Of the files.
    """
    from matplotlib.patches import Patch, Rectangle

    table = namings_table(namings)
    cases, tools = list(dict.fromkeys(table["case"])), [tool for tool in TOOL_WORDS if tool in set(table["tool"])]
    noises = sorted(table["noise"].unique())
    room = Room(left=LEFT, top=0.75, bottom=0.35, across=0.06)
    drawn, grid = panels(1, len(tools), ROW * len(cases), room)
    rows = []
    for axes, tool in zip(grid[0], tools, strict=True):
        for (case, noise), found in table[table["tool"] == tool].groupby(["case", "noise"], sort=False):
            down, across = cases.index(str(case)), noises.index(noise)
            kind, share = seeds_of(found)
            colour, letter, _ = LOOKS[kind]
            axes.add_patch(Rectangle((across, down), 1, 1, facecolor=colour, edgecolor="#555555", linewidth=0.4))
            ink = "#ffffff" if colour in (RIGHT, WRONG) else "#111111"
            said = letter if share == 1 else f"{letter} {share:.0%}".replace("%", "")
            axes.text(across + 0.5, down + 0.30, said, ha="center", va="center", fontsize=6, color=ink)
            forecast = _forecast(found)
            axes.text(across + 0.5, down + 0.72, forecast, ha="center", va="center", fontsize=5, color=ink)
            rows.append(
                {"case": case, "tool": tool, "noise": noise, "kind": kind, "share": share, "forecast": forecast}
            )
        axes.set_xlim(0, len(noises))
        axes.set_ylim(len(cases), 0)
        axes.set_xticks(np.arange(len(noises)) + 0.5, [f"{100 * noise:g}" for noise in noises])
        axes.set_yticks([])
        axes.tick_params(length=0)
        axes.set_title(TOOL_WORDS[tool])
        for spine in axes.spines.values():
            spine.set_visible(False)
    hidden = dict(zip(table["case"], table["hidden"], strict=True))
    labels = [f"{case}: {hidden[case]}" if hidden[case] else case for case in cases]
    grid[0][0].set_yticks(np.arange(len(cases)) + 0.5, [label.replace(": ", ":\n", 1) for label in labels], fontsize=6)
    grid[0][len(tools) // 2].set_xlabel("noise [% of each channel’s SD]")
    legend(drawn, [Patch(facecolor=c, edgecolor="#555555", label=f"{x} {words}") for c, x, words in LOOKS.values()][:4])
    legend_below(drawn, [Patch(facecolor=c, edgecolor="#555555", label=f"{x} {w}") for c, x, w in LOOKS.values()][4:])
    caption = (
        "Answer of most seeds, with its share in percent where the seeds differ; below it, how much less RMSE the "
        f"forecast has than that of the known model [%], median of n = {table['seed'].nunique()} seeds "
        "(without noise, and of the curves, one; no tile: not asked)."
    )
    return Figure(name, caption, "Tiles of answers by case, tool and noise", pd.DataFrame(rows), drawn)


def legend_below(drawn, handles: Sequence) -> None:
    """Second row of a legend.

    Parameters
    ----------
    drawn : matplotlib.figure.Figure
        Receives it.
    handles : sequence of Artist
        What is explained.
    """
    drawn.legend(
        handles=list(handles),
        loc="upper center",
        ncols=len(handles),
        bbox_to_anchor=(0.5, 1.0 - 0.2 / drawn.get_figheight()),
    )


def _forecast(found: pd.DataFrame) -> str:
    if found["diverged_s"].notna().any():
        return "div."
    middle = float(found["accuracy"].median())
    if not np.isfinite(middle):
        return ""
    if middle < FEW:
        return f"<{FEW:.0f}".replace("-", "−")
    return (f"{middle:.1f}" if middle > MANY else f"{middle:.0f}").replace("-", "−")
