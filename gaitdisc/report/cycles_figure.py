"""Pooled cycles: every kept cycle faint, mean and spread of both feet over each other, foot off marked."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np
import pandas as pd
from numpy.typing import NDArray

from gaitdisc.recording import PERCENT
from gaitdisc.report.curves import sides_together
from gaitdisc.report.figure import Figure
from gaitdisc.report.palette import SIDES
from gaitdisc.report.panels import Room, in_style, legend, panels_for, sheets
from gaitdisc.report.wording import SIDE_WORDS, counted, label, sideless, unit_text, upwards
from gaitdisc.results import PooledCycles

if TYPE_CHECKING:
    from matplotlib.artist import Artist
    from matplotlib.axes import Axes

COLUMNS, MOST_PANELS = 4, 20
MOST_FAINT = 25  # cycles that are drawn one by one
FEET = ("l", "r")


@in_style
def cycles_figures(pooled: PooledCycles, name: str) -> list[Figure]:
    """Curves of one person, session and condition, a panel for each channel with left and right over each other."""
    numbers = pooled.mean_curves()
    if not len(numbers):
        return []
    joints = list(
        dict.fromkeys(sideless(channel) for channel in sides_together(list(dict.fromkeys(numbers["channel"]))))
    )
    order = {kind: place for place, kind in enumerate(("angle", "translation", "moment", "power"))}
    kinds = {sideless(channel.name): order.get(channel.quantity, len(order)) for channel in pooled.channels}
    joints.sort(key=lambda joint: kinds[joint])
    parts = sheets(joints, MOST_PANELS, f"cycles-{name}")
    return [_figure(pooled, numbers, part, sheet) for sheet, part in parts.items()]


def _figure(pooled: PooledCycles, numbers: pd.DataFrame, joints: list[str], name: str) -> Figure:
    drawn, cells = panels_for(len(joints), COLUMNS, 1.15, Room(left=0.6, across=0.64, down=0.46))
    stems = {channel: sideless(channel) for channel in numbers["channel"].unique()}
    shown = numbers[numbers["channel"].map(stems).isin(joints)].reset_index(drop=True)
    by_joint = dict(list(shown.groupby(shown["channel"].map(stems), sort=False)))
    for axes, joint in zip(cells, joints, strict=True):
        own = by_joint[joint]
        for channel, side in own[["channel", "side"]].drop_duplicates().itertuples(index=False):
            curve = own[(own["channel"] == channel) & (own["side"] == side)]
            _draw(axes, pooled, str(channel), str(side), curve)
        first = str(own["channel"].iloc[0])
        axes.set_title(label(joint), fontsize=7.4)
        up, unit = upwards(first), unit_text(str(own["unit"].iloc[0]))
        axes.set_ylabel(f"[{unit}]" + (f" ↑ {up}" if up and len(up) < 18 else ""), fontsize=6.8, labelpad=1)
        axes.set_xlim(0, 100)
        axes.set_xticks([0, 50, 100])
    for axes in cells[-COLUMNS:]:
        axes.set_xlabel("cycle [%]", labelpad=1)
    legend(drawn, _key())
    return Figure(name, _caption(pooled), _alt(pooled, shown), shown, drawn)


def _draw(axes: Axes, pooled: PooledCycles, channel: str, side: str, curve: pd.DataFrame) -> None:
    look = SIDES[side]
    draw_cycles(axes, _every(pooled, channel, side), curve["mean"].to_numpy(), curve["sd"].to_numpy(), side)
    off = pooled.kept.loc[pooled.kept["side"] == side, "stance_percent"].mean()
    if np.isfinite(off):
        axes.axvline(float(off), color=look.colour, linewidth=0.7, linestyle=(0, (1.5, 1.5)), zorder=0)


def draw_cycles(
    axes: Axes, every: NDArray[np.float64], mean: NDArray[np.float64], sd: NDArray[np.float64], side: str
) -> None:
    """Draw every cycle faint, and their mean; from three cycles on its spread.

    every (cycle, phase): on 0 to 100 % in 101 points
    mean, sd (phase,): over the cycles
    """
    look = SIDES[side]
    axes.axhline(0.0, color="#cccccc", linewidth=0.6, zorder=0)
    axes.plot(PERCENT, every[:MOST_FAINT].T, color=look.colour, linewidth=0.4, alpha=0.35, zorder=1)
    if len(every) > 2:
        axes.fill_between(PERCENT, mean - sd, mean + sd, color=look.colour, alpha=0.18, linewidth=0, zorder=1)
    axes.plot(PERCENT, mean, color=look.colour, linewidth=1.2, zorder=2)


def _every(pooled: PooledCycles, channel: str, side: str) -> NDArray[np.float64]:
    column = [one.name for one in pooled.channels].index(channel)
    own = pooled.curves[(pooled.kept["side"] == side).to_numpy(), :, column]
    return own[np.isfinite(own).any(axis=1)]


def _key() -> list[Artist]:
    from matplotlib.lines import Line2D

    handles: list[Artist] = [Line2D([], [], color=SIDES[side].colour, label=SIDE_WORDS[side]) for side in FEET]
    handles.append(Line2D([], [], color="#666666", linewidth=0.5, label="single cycles"))
    return [*handles, Line2D([], [], color="#666666", linestyle=(0, (1.5, 1.5)), linewidth=0.9, label="foot off")]


def _caption(pooled: PooledCycles) -> str:
    counts = " and ".join(f"{counted(pooled.counted(side), 'cycle')} {SIDE_WORDS[side]}" for side in FEET)
    kinetic = pooled.kept[pooled.kept["kinetic"].astype(bool)]
    plates = ", ".join(f"{int((kinetic['side'] == side).sum())} {SIDE_WORDS[side]}" for side in FEET)
    moments = f" Moments only where a plate carried this foot alone: {plates}." if len(kinetic) else ""
    return (
        f"{pooled.subject}, {pooled.where}: {counts}, pooled over {counted(pooled.trials, 'trial')}; mean, from three "
        f"cycles on ± standard deviation, and single cycles (the first {MOST_FAINT}), left red, right blue. 0 %: "
        f"initial contact of the channel's own foot; dotted: mean foot off.{moments}"
    )


def _alt(pooled: PooledCycles, numbers: pd.DataFrame) -> str:
    ranges = []
    for channel, rows in list(numbers.groupby("channel", sort=False))[:6]:
        unit = unit_text(str(rows["unit"].iloc[0]))
        ranges.append(f"{label(str(channel))} {rows['mean'].min():.3g} to {rows['mean'].max():.3g} {unit}")
    return f"Mean cycles of {pooled.subject}, {pooled.where}: {'; '.join(ranges)}."
