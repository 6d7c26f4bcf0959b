"""Curves over the stride, of walks and of SHRED's latent state (Fig. 5.1), and channels of a recording over time."""

from __future__ import annotations

from collections.abc import Sequence
from typing import TYPE_CHECKING

import numpy as np
import pandas as pd

from gaitdisc.channel import find_side
from gaitdisc.processing.pooled_cycles import WALK, WalkSummary, mean_curve, stack_means
from gaitdisc.recording import Recording
from gaitdisc.recording.arrays import Values
from gaitdisc.report.figure import Figure
from gaitdisc.report.panels import (
    RECONSTRUCTED,
    SIDES,
    WITHOUT_DEVICE,
    Room,
    in_style,
    legend,
    legend_lines,
    panels_for,
    sheets,
)
from gaitdisc.saved.study_run import StudyRun
from gaitdisc.words import counted, label, sideless, unit_text, upwards

if TYPE_CHECKING:
    from matplotlib.artist import Artist
    from matplotlib.axes import Axes

WALKS = ("nominal", "exo")
BINS = np.arange(0.0, 101.0, 2.0)
LATENT = "latent state of SHRED"


@in_style
def curves_figures(run: StudyRun, participant: str, name: str) -> list[Figure]:
    """Mean and standard deviation over strides of the walks without and with the device, one panel a channel."""
    numbers = curve_numbers(run, participant)
    if not len(numbers):
        return []
    pages = sheets(sides_together(list(dict.fromkeys(numbers["channel"]))), 16, f"curves-{name}")
    by_channel = numbers.set_index("channel")
    return [_figure(run, participant, by_channel.loc[part].reset_index(), sheet) for sheet, part in pages.items()]


def curve_numbers(run: StudyRun, participant: str) -> pd.DataFrame:
    """Channel, unit, walk (`nominal` or `exo`), percent (101 points), n of strides, mean and sd over strides."""
    means = []
    for walk in WALKS:
        summary = find_walk(run, participant, walk)
        if summary is None or not len(summary.curves):
            continue
        curves = summary.curves
        for column, channel in enumerate(summary.channels):
            means.append(mean_curve(curves[:, :, column], channel=channel.name, unit=channel.unit, walk=walk))
    return stack_means(means, "walk")


def find_walk(run: StudyRun, participant: str, walk: str) -> WalkSummary | None:
    """Return the walk of one participant, or None where it could not be processed."""
    condition = run.nominal if walk == "nominal" else run.exo
    return next((w for w in run.of(WALK) if w.subject == participant and w.condition == condition), None)


def sides_together(names: list[str]) -> list[str]:
    """Channels with left and right of one joint side by side, left first; what has no other side comes last.

    >>> sides_together(["pelvis_tilt", "hip_flexion_r", "ankle_angle_r", "hip_flexion_l", "ankle_angle_l"])
    ['hip_flexion_l', 'hip_flexion_r', 'ankle_angle_l', 'ankle_angle_r', 'pelvis_tilt']
    """
    joints: dict[str, list[str]] = {}
    for name in names:
        joints.setdefault(sideless(name), []).append(name)
    pairs = [sorted(pair, key=lambda n: "lr".find(find_side(n))) for pair in joints.values() if len(pair) > 1]
    singles = [pair for pair in joints.values() if len(pair) == 1]
    return [name for group in (*pairs, *singles) for name in group]


def draw_walks(axes: Axes, curves: pd.DataFrame, colour: str) -> None:
    """Draw mean and spread of both walks of one channel over the stride, from its rows of `curve_numbers`."""
    axes.axhline(0.0, color="#cccccc", linewidth=0.6, zorder=0)
    for walk, rows in curves.groupby("walk", sort=False):
        without = walk == "nominal"
        shade = WITHOUT_DEVICE.colour if without else colour
        low, high = rows["mean"] - rows["sd"], rows["mean"] + rows["sd"]
        axes.fill_between(rows["percent"], low, high, color=shade, alpha=0.22, linewidth=0, zorder=1)
        line = WITHOUT_DEVICE.line if without else "-"
        axes.plot(rows["percent"], rows["mean"], color=shade, linestyle=line, linewidth=1.2, zorder=2)


def _figure(run: StudyRun, participant: str, numbers: pd.DataFrame, name: str) -> Figure:
    groups = list(numbers.groupby("channel", sort=False))
    drawn, cells = panels_for(len(groups), 4, 1.15, Room(left=0.6, across=0.64, down=0.46))
    spread, joint = numbers["sd"].fillna(0.0), numbers["channel"].map(sideless)
    low, high = (numbers["mean"] - spread).groupby(joint).min(), (numbers["mean"] + spread).groupby(joint).max()
    room = 0.06 * (high - low).clip(lower=1e-9)
    for axes, (channel, curves) in zip(cells, groups, strict=True):
        colour = SIDES[find_side(str(channel))].colour
        draw_walks(axes, curves, colour)
        axes.set_title(label(str(channel)).replace("EMG ", ""), color=colour, fontsize=7.4)
        up, unit = upwards(str(channel)), unit_text(str(curves["unit"].iloc[0]))
        axes.set_ylabel(f"[{unit}]" + (f" ↑ {up}" if up and len(up) < 18 else ""), fontsize=6.8, labelpad=1)
        axes.set_xlim(0, 100)
        axes.set_xticks([0, 50, 100])
        key = sideless(str(channel))
        axes.set_ylim(*((low[key] - room[key], high[key] + room[key]) if np.isfinite(low[key]) else (0.0, 1.0)))
    for axes in cells[-4:]:
        axes.set_xlabel("stride [%]", labelpad=1)
    legend(drawn, walks_key(run))
    alt = (
        f"Mean walking curves of {participant}, {counted(len(groups), 'channel')}, {run.nominal} and {run.exo}. With "
        f"the device: {range_words(numbers[numbers['walk'] == 'exo'])}."
    )
    counts = []
    for walk, rows in numbers.groupby("walk", sort=False):
        fewest, most = int(rows["n"].min()), int(rows["n"].max())
        word = run.nominal if walk == "nominal" else run.exo
        counts.append(f"{fewest if fewest == most else f'{fewest}-{most}'} strides ({word})")
    caption = (
        f"{participant}: walking curves of every channel over the stride, mean ± standard deviation over strides, n = "
        f"{', '.join(counts)}; entire walks, not split. Grey, dashed: {run.nominal}; solid: {run.exo} (red: left side, "
        "blue: right side, black: no side). 0 %: initial contact of the channel's own foot. Arrows give the positive "
        "direction; left and right of one joint share a scale."
    )
    return Figure(name, caption, alt, numbers, drawn)


def walks_key(run: StudyRun) -> list[Artist]:
    """Handles of the legend of both walks."""
    return legend_lines({run.nominal: WITHOUT_DEVICE, f"{run.exo}, left": SIDES["l"], f"{run.exo}, right": SIDES["r"]})


def range_words(numbers: pd.DataFrame) -> str:
    """From where to where the mean curves of the first six channels go, in words."""
    ranges = []
    for channel, rows in list(numbers.groupby("channel", sort=False))[:6]:
        unit = unit_text(str(rows["unit"].iloc[0]))
        ranges.append(f"{label(str(channel))} {rows['mean'].min():.3g} to {rows['mean'].max():.3g} {unit}")
    return "; ".join(ranges)


def draw_recording(axes: Axes, recording: Recording, names: Sequence[str]) -> None:
    """Draw channels over time; what stands but is not to be trusted is drawn over in grey."""
    chosen = recording.selected(names)
    for column, channel in enumerate(chosen.channels):
        values = chosen.values[:, column]
        axes.plot(chosen.time, values, linewidth=1.0, label=label(channel.name))
        doubtful = np.where(np.asarray(chosen.suspect)[:, column], values, np.nan)
        axes.plot(chosen.time, doubtful, color="#999999", linewidth=2.4, alpha=0.6)
    axes.set_xlabel("time [s]")
    units = list(dict.fromkeys(unit_text(channel.unit) for channel in chosen.channels))
    axes.set_ylabel(f"[{', '.join(units)}]")
    axes.legend(frameon=False)


def course_numbers(phi: Values, components: Values) -> pd.DataFrame:
    """Component (from 1), percent in steps of 2 % of the stride, mean and sd [1]."""
    known = np.isfinite(phi)
    place = np.clip(np.digitize(phi[known], BINS) - 1, 0, len(BINS) - 2)
    middle = (BINS[:-1] + BINS[1:]) / 2
    tables = []
    for k in range(components.shape[1]):
        by_bin = pd.Series(components[known, k]).groupby(place).agg(["mean", "std"])
        tables.append(pd.DataFrame({"component": k + 1, "percent": middle[by_bin.index.to_numpy(int)],
                                    "mean": by_bin["mean"].to_numpy(), "sd": by_bin["std"].to_numpy()}))  # fmt: skip
    return pd.concat(tables, ignore_index=True)


def draw_course(axes: Axes, numbers: pd.DataFrame) -> None:
    """Draw each component's mean over the stride, and its standard deviation shaded."""
    for (k, rows), look in zip(numbers.groupby("component"), RECONSTRUCTED.values(), strict=False):
        axes.fill_between(rows["percent"], rows["mean"] - rows["sd"], rows["mean"] + rows["sd"],
                          color=look.colour, alpha=0.2, linewidth=0)  # fmt: skip
        axes.plot(rows["percent"], rows["mean"], color=look.colour, linestyle=look.line, label=f"component {k}")
    axes.set_xlim(0, 100)
    axes.set_xlabel("stride [%]")
    axes.set_ylabel("standard deviations [1]")
