"""Who names what is hidden, by case, tool and noise: a table of answers, and tiles with the forecast."""

from __future__ import annotations

from collections.abc import Sequence
from typing import TYPE_CHECKING

import numpy as np
import pandas as pd

from gaitdisc.report.figure import Figure
from gaitdisc.report.panels import Room, in_style, legend, panels
from gaitdisc.report.table import Table

from .naming import Naming, namings_table

if TYPE_CHECKING:
    from matplotlib.axes import Axes

MOST_WORDS = 120  # characters of an answer
TOOL_WORDS = {"discover": "discover", "sindy": "SINDy", "dmd": "DMD", "gp": "Gaussian process", "nn": "network"}
RIGHT, HALF, WRONG, SILENT, CURVE = "#00875a", "#8fd0b5", "#d97700", "#ffffff", "#c9ced6"
EDGE = "#555555"
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
FEW, MANY = -999.0, 99.5  # accuracies beyond are written as such


def naming_table(namings: Sequence[Naming], name: str) -> Table:
    """What each tool answers, a row a case and noise."""
    table = namings_table(namings)
    tools = [tool for tool in TOOL_WORDS if tool in set(table["tool"])]
    rows = []
    for (case, noise), found in table.groupby(["case", "noise"], sort=False):
        cells = [_said(found[found["tool"] == tool]) for tool in tools]
        rows.append((str(case), str(found["hidden"].iloc[0]) or "nothing", f"{noise:.1%}", *cells))
    rows.sort(key=lambda row: list(dict.fromkeys(table["case"])).index(row[0]))
    caption = (
        "Answers, with how many of the seeds gave them; × the true number: median of the seeds that named it. Of a "
        "curve: how far it is from what is missing, along the record without noise (first seed)."
    )
    return Table(
        name, caption, ("case", "hidden", "noise", *(TOOL_WORDS[t] for t in tools)), tuple(rows), table
    )  # fmt: skip


def seeds_of(found: pd.DataFrame) -> tuple[str, float]:
    """Most frequent answer of the seeds, `right` where it is, and its share."""
    kinds = found["answer"].where(~found["right"], "right")
    counts = kinds.value_counts(sort=False)
    return str(counts.idxmax()), float(counts.max() / len(kinds))


def _said(found: pd.DataFrame) -> str:
    if not len(found):
        return ""
    counts = found["answer"].value_counts(sort=False)
    some = [f"{answer} {count}/{len(found)}" if count < len(found) else str(answer) for answer, count in counts.items()]
    amounts = found["amount"].dropna()
    words = ", ".join(some)
    if len(amounts):
        words += f" (× {amounts.median():.4g})"
    first = str(found["said"].iloc[0]).split(";")[0]
    shown = found["answer"].iloc[0] in ("curve", "refused") and len(first) < MOST_WORDS
    return f"{words}: {first}" if shown else words


@in_style
def naming_figure(namings: Sequence[Naming], name: str) -> Figure:
    """A row a case, a column a tool and noise; the tile shows the answer, and the forecast."""
    from matplotlib.patches import Patch

    table = namings_table(namings)
    tiles = _tiles(table)
    cases, noises = list(dict.fromkeys(table["case"])), sorted(table["noise"].unique())
    tools = list(dict.fromkeys(tiles["tool"]))
    room = Room(left=LEFT, top=0.75, bottom=0.35, across=0.06)
    drawn, (row,) = panels(1, len(tools), ROW * len(cases), room)
    for axes, tool in zip(row, tools, strict=True):
        _draw(axes, tiles[tiles["tool"] == tool], cases, noises)
        axes.set_title(TOOL_WORDS[tool])
    hidden = dict(zip(table["case"], table["hidden"], strict=True))
    labels = [f"{case}:\n{hidden[case]}" if hidden[case] else case for case in cases]
    row[0].set_yticks(np.arange(len(cases)) + 0.5, labels, fontsize=6)
    row[len(tools) // 2].set_xlabel("noise [% of each channel’s SD]")
    key = [Patch(facecolor=c, edgecolor=EDGE, label=f"{letter} {words}") for c, letter, words in LOOKS.values()]
    legend(drawn, key[:4])
    legend(drawn, key[4:], down=0.2)
    caption = (
        "Answer of most seeds, with its share in percent where the seeds differ; below it, how much less RMSE the "
        "forecast from the noise-free true state (an oracle) has than the known model’s [%], median of "
        f"n = {table['seed'].nunique()} seeds (without noise, and of the curves, one; no tile: not run)."
    )
    return Figure(name, caption, "Tiles of answers by case, tool and noise", tiles, drawn)


def _tiles(table: pd.DataFrame) -> pd.DataFrame:
    """What each tile shows: the answer of most seeds, its share, and the forecast."""
    rows = []
    for tool in TOOL_WORDS:
        for (case, noise), found in table[table["tool"] == tool].groupby(["case", "noise"], sort=False):
            kind, share = seeds_of(found)
            rows.append((case, tool, noise, kind, share, _forecast(found)))
    return pd.DataFrame(rows, columns=pd.Index(["case", "tool", "noise", "kind", "share", "forecast"]))


def _draw(axes: Axes, tiles: pd.DataFrame, cases: list[str], noises: list[float]) -> None:
    from matplotlib.patches import Rectangle

    for case, _, noise, kind, share, forecast in tiles.itertuples(index=False):
        down, across = cases.index(str(case)), noises.index(noise)
        colour, letter, _ = LOOKS[kind]
        axes.add_patch(Rectangle((across, down), 1, 1, facecolor=colour, edgecolor=EDGE, linewidth=0.4))
        ink = "#ffffff" if colour in (RIGHT, WRONG) else "#111111"
        said = letter if share == 1 else f"{letter} {share:.0%}".replace("%", "")
        axes.text(across + 0.5, down + 0.30, said, ha="center", va="center", fontsize=6, color=ink)
        axes.text(across + 0.5, down + 0.72, forecast, ha="center", va="center", fontsize=5, color=ink)
    axes.set_xlim(0, len(noises))
    axes.set_ylim(len(cases), 0)
    axes.set_xticks(np.arange(len(noises)) + 0.5, [f"{100 * noise:g}" for noise in noises])
    axes.set_yticks([])
    axes.tick_params(length=0)
    for spine in axes.spines.values():
        spine.set_visible(False)


def _forecast(found: pd.DataFrame) -> str:
    if found["diverged_s"].notna().any():
        return "div."
    middle = float(found["accuracy"].median())
    if not np.isfinite(middle):
        return ""
    if middle < FEW:
        return f"<{FEW:.0f}".replace("-", "−")
    return (f"{middle:.1f}" if middle > MANY else f"{middle:.0f}").replace("-", "−")
