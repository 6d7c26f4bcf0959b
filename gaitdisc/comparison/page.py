"""The page of a mismatch: both walks over the stride, the gap between them, and tables of where channels differ."""

from __future__ import annotations

import math
from collections.abc import Callable
from pathlib import Path
from typing import TYPE_CHECKING, Any

import pandas as pd

from gaitdisc.channel import find_side
from gaitdisc.comparison.mismatch import Mismatch
from gaitdisc.comparison.sentences import method_sentences, mismatch_sentences, smallest_p_sentence
from gaitdisc.processing.curves_figure import sides_together
from gaitdisc.report.figure import Figure, save_figures
from gaitdisc.report.page import write_page
from gaitdisc.report.panels import SIDES, WITHOUT_DEVICE, Room, in_style, legend, legend_lines, panels_for, sheets
from gaitdisc.report.table import Table, provenance_tables, save_table, save_tables, tabulate_findings
from gaitdisc.words import NONE, amount, counted, label, p_cell, plain, spoken, unit_text, upwards, with_unit

if TYPE_CHECKING:
    import rich.table
    from matplotlib.artist import Artist
    from matplotlib.axes import Axes

Draw = Callable[["Axes", pd.DataFrame, list[dict[str, Any]], str], None]
COLUMNS, MOST_ROWS = 3, 4
SHADE = "#f2b632"  # a gap; no side and no model has this colour
HEADINGS = ("channel", "stride [%]", "gap", "at [%]", "in SD", "p")


@in_style
def mismatch_figures(mismatch: Mismatch) -> list[Figure]:
    """Curves of both walks, then the gap with its band; some dozen channels a figure."""
    channels = sides_together(list(mismatch.names))
    return [
        _figure(mismatch, names, sheet, kind, draw)
        for kind, draw in (("curves", draw_both), ("gap", draw_gap))
        for sheet, names in sheets(channels, COLUMNS * MOST_ROWS, f"mismatch-{kind}").items()
    ]


def mismatch_numbers(mismatch: Mismatch, names: list[str]) -> pd.DataFrame:
    """Everything drawn of some channels, one row a channel and percent."""
    tables = []
    for name in names:
        table = mismatch.curve_table(name)
        table.insert(0, "unit", mismatch.channels[mismatch.names.index(name)].unit)
        table.insert(0, "channel", name)
        tables.append(table)
    return pd.concat(tables, ignore_index=True)


def _figure(mismatch: Mismatch, names: list[str], name: str, kind: str, draw: Draw) -> Figure:
    drawn, cells = panels_for(len(names), COLUMNS, 1.3, Room(left=0.6, across=0.62, down=0.46))
    numbers = mismatch_numbers(mismatch, names)
    gaps = []
    for axes, channel in zip(cells, names, strict=True):
        curves, regions = numbers[numbers["channel"] == channel], mismatch.regions_of(channel)
        draw(axes, curves, regions, SIDES[find_side(channel)].colour)
        spans = ", ".join(f"{row['from_percent']:.0f}-{row['to_percent']:.0f} %" for row in regions)
        largest = f"{spoken(channel)} {curves['gap'].iloc[int(curves['gap'].abs().argmax())]:.3g}"
        gaps.append(f"{largest}, differs at {spans}" if spans else f"{largest}, no significant gap")
        axes.set_title(label(channel), color=SIDES[find_side(channel)].colour, fontsize=7.6)
        up = upwards(channel)
        unit = unit_text(str(curves["unit"].iloc[0]))
        axes.set_ylabel(f"[{unit}]" + (f" ↑ {up}" if up and len(up) < 22 else ""), fontsize=6.8, labelpad=1)
        axes.set_xlim(0, 100)
        axes.set_xticks([0, 25, 50, 75, 100])
    for axes in cells[-COLUMNS:]:
        axes.set_xlabel("stride [%]", labelpad=1)
    legend(drawn, mismatch_key(mismatch, kind))
    alt = f"{mismatch.first} against {mismatch.second} over the stride. Largest gaps: {'; '.join(gaps)}."
    return Figure(name, _caption(mismatch, kind, len(names)), alt, numbers, drawn)


def draw_both(axes: Axes, curves: pd.DataFrame, regions: list[dict[str, Any]], colour: str) -> None:
    """Draw both walks of one channel's rows of `mismatch_numbers`, shaded where they differ by more than chance."""
    percent = curves["percent"].to_numpy()
    sd = curves["sd_second"].fillna(0.0)
    look = WITHOUT_DEVICE
    axes.fill_between(
        percent, curves["second"] - sd, curves["second"] + sd, color=look.colour, alpha=0.2, linewidth=0, zorder=1
    )
    _shade(axes, curves, curves["first"], curves["second"])
    axes.plot(percent, curves["second"], color=look.colour, linestyle=look.line, linewidth=1.2, zorder=3)
    axes.plot(percent, curves["first"], color=colour, linewidth=1.3, zorder=4)
    _bars(axes, regions)


def draw_gap(axes: Axes, curves: pd.DataFrame, regions: list[dict[str, Any]], colour: str) -> None:
    """Draw the gap of one channel's rows of `mismatch_numbers` over the stride with its band."""
    percent = curves["percent"].to_numpy()
    axes.axhline(0.0, color="#888888", linewidth=0.6, zorder=0)
    axes.fill_between(percent, curves["low"], curves["high"], color=colour, alpha=0.22, linewidth=0, zorder=1)
    _shade(axes, curves, curves["gap"], 0.0)
    axes.plot(percent, curves["gap"], color=colour, linewidth=1.3, zorder=3)
    _bars(axes, regions)


def _shade(axes: Axes, curves: pd.DataFrame, first: pd.Series, second: pd.Series | float) -> None:
    """Shade what lies between two curves where the walks differ by more than chance."""
    where = curves["differs"].to_numpy(bool)
    axes.fill_between(curves["percent"], first, second, where=where, color=SHADE, alpha=0.55, linewidth=0, zorder=2)


def _bars(axes: Axes, regions: list[dict[str, Any]]) -> None:
    """Mark the stretches along the foot of the panel too, where a thin shade would be overlooked."""
    style = {"color": "#b06f00", "linewidth": 2.2, "solid_capstyle": "butt", "transform": axes.get_xaxis_transform()}
    for row in regions:
        axes.plot([float(row["from_percent"]) - 0.5, float(row["to_percent"]) + 0.5], [0.02, 0.02], **style)


def mismatch_key(mismatch: Mismatch, kind: str) -> list[Artist]:
    """Handles of the legend of a kind of figure."""
    from matplotlib.patches import Patch

    looks = {f"{mismatch.second}, ± sd": WITHOUT_DEVICE, f"{mismatch.first}, left": SIDES["l"], "right": SIDES["r"]}
    if kind == "gap":
        looks = {f"gap, {100 * (1 - mismatch.exchange.alpha):g} % band for all points and channels": SIDES[""]}
    return [*legend_lines(looks), Patch(color=SHADE, alpha=0.55, label="significant gap")]


def _caption(mismatch: Mismatch, kind: str, count: int) -> str:
    done = mismatch.exchange
    n = f"n = {done.strides_first} and {done.strides_second} strides"
    if done.unit == "participant":
        n = f"n = {done.first} participants, {n}"
    shaded = (
        f"Shaded, with a bar at the bottom: parts in which the permutation test gives p < {done.alpha:g}, corrected "
        "for all points and channels, and the gap reaches the smallest difference that is named."
    )
    if mismatch.alignment.applied:
        by = mismatch.alignment.percent
        shaded += f" {mismatch.first} is drawn {abs(by):.1f} % of the stride {'later' if by > 0 else 'earlier'}."
    if kind == "gap":
        return (
            f"Gap, {mismatch.second} minus {mismatch.first}, {counted(count, 'channel')}, {n}. Band: "
            f"{100 * (1 - done.alpha):g} % for all points and channels together. {shaded}"
        )
    return (
        f"Mean curves over the stride, {counted(count, 'channel')}, {n}. Grey, dashed: {mismatch.second}, mean ± "
        f"standard deviation over strides; solid: {mismatch.first} (red: left, blue: right, black: no side). 0 %: "
        f"initial contact of the channel's own foot. {shaded}"
    )


def regions_table(mismatch: Mismatch) -> Table:
    """Every stretch that differs, channel by channel, the largest gap against the smallest that is named first."""
    rows = [row for name in mismatch.ordered() for row in _rows(mismatch, name)]
    caption = (
        f"Where the walks differ, n = {len(mismatch.regions)} parts of the stride: {mismatch.second} minus "
        f"{mismatch.first}; sorted by the gap in multiples of the smallest difference that is named. Gap: the largest "
        f"in that part, also in stride-to-stride standard deviations of {mismatch.second}; p: p-value of that part, "
        f"corrected for all points and channels. {smallest_p_sentence(mismatch)}"
    )
    return Table("regions", caption, HEADINGS, tuple(rows), mismatch.regions)


def channels_table(mismatch: Mismatch) -> Table:
    """Every channel, whether it differs or not, and what the comparison could have seen of it."""
    alignment = mismatch.alignment
    other_way = "without" if alignment.applied else "with"
    others = map(amount, alignment.otherwise) if alignment.otherwise else [NONE] * len(mismatch.names)  # older folder
    summary = map(mismatch.summary_of, mismatch.names)
    rows = tuple(
        (*(write(row) for write in _CHANNEL.values()), other) for row, other in zip(summary, others, strict=True)
    )
    caption = (
        f"All {counted(len(rows), 'channel')}. rms: root mean square over the stride, of the gap and of the "
        f"stride-to-stride SD of {mismatch.second}; p: p-value of the largest |t|, corrected for all points and "
        "channels; agrees within: largest half-width of the gap's band; visible: the gap that four of five such "
        f"comparisons would detect at a typical point; shift: the best-fitting delay of {mismatch.first}, and the rms "
        "gap after it; offset: the mean gap; shape: the largest gap without the offset; named from: the smallest "
        f"difference that is named; last column: the largest gap {other_way} the common shift of {mismatch.first}, "
        f"{alignment.percent:+.1f} % of the stride, which was {'' if alignment.applied else 'not '}applied."
    )
    return Table("channels", caption, (*_CHANNEL, f"gap {other_way} shift"), rows, mismatch.summary)


def mismatch_text(mismatch: Mismatch) -> rich.table.Table:
    """Table for a terminal of 80 columns: what differs, then what does not."""
    from rich import box
    from rich.table import Table as Printed

    table = Printed(box=box.SIMPLE)
    for number, heading in enumerate(HEADINGS):
        table.add_column(plain(heading), justify="right" if number else "left", no_wrap=number > 0)
    rest = [name for name in mismatch.names if name not in mismatch.ordered()]
    for row in [*regions_table(mismatch).rows, *(row for name in rest for row in _rows(mismatch, name))]:
        table.add_row(*map(plain, row))
    return table


def _rows(mismatch: Mismatch, name: str) -> list[tuple[str, ...]]:
    """Rows of one channel: every region in which it differs, or its largest gap where there is none."""
    regions = mismatch.regions_of(name)
    return [
        (
            spoken(name),
            f"{row['from_percent']:.0f} to {row['to_percent']:.0f}" if regions else NONE,
            _sign_number(float(row["gap" if regions else "largest_gap"]), str(row["unit"])),
            f"{row['at_percent']:.0f}",
            amount(abs(row["gap_sd"])) if math.isfinite(row["gap_sd"]) else NONE,
            p_cell(float(row["p"])),
        )
        for row in regions or [mismatch.summary_of(name)]
    ]


def _sign_number(gap: float, unit: str) -> str:
    return with_unit(f"{'−' if gap < 0 else '+'}{amount(abs(gap))}", unit)


_CHANNEL: dict[str, Callable[[dict[str, Any]], str]] = {  # headings, and how each writes a row of `Mismatch.summary`
    "channel": lambda row: spoken(str(row["channel"])),
    "differs": lambda row: "yes" if row["differs"] else "too small" if row["too_small"] else "no",
    "largest gap": lambda row: _sign_number(float(row["largest_gap"]), str(row["unit"])),
    "at [%]": lambda row: f"{row['at_percent']:.0f}",
    "rms gap": lambda row: amount(float(row["rms_gap"])),
    "rms SD": lambda row: amount(float(row["rms_sd"])),
    "p": lambda row: p_cell(float(row["p"])),
    "agrees within": lambda row: amount(float(row["within"])),
    "visible": lambda row: amount(float(row["visible"])),
    "shift [%]": lambda row: f"{row['shift_percent']:+.0f}" if row["shift_percent"] else "0",
    "rms after shift": lambda row: amount(float(row["rms_shifted"])),
    "offset": lambda row: _sign_number(float(row["offset"]), str(row["unit"])),
    "shape": lambda row: amount(float(row["shape"])),
    "named from": lambda row: amount(float(row["limit"])),
}


def write_mismatch_report(mismatch: Mismatch, folder: Path) -> Path:
    """Write the report of a mismatch: `report.html`, `figures/`, `tables/`, and `channels/` with a CSV a channel."""
    tables = {
        "regions": regions_table(mismatch),
        "channels": channels_table(mismatch),
        "findings": tabulate_findings(mismatch.findings, f"Findings in both walks, n = {len(mismatch.findings)}."),
        **provenance_tables(mismatch.provenance),
    }
    save_tables(tables.values(), folder)
    for name in mismatch.names:
        save_table(mismatch.curve_table(name), folder / "channels" / f"{name}.csv")
    shown = {
        "mismatch": mismatch,
        "sentences": mismatch_sentences(mismatch),
        "figures": save_figures(mismatch_figures(mismatch), folder),
        "tables": tables,
        "method": method_sentences(mismatch),
    }
    return write_page("mismatch", shown, folder)
