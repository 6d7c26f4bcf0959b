"""Tables of a mismatch: where each channel differs, and what each one would have shown."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING

from gaitdisc.report.table import Table, seen_table
from gaitdisc.report.wording import NONE, amount, counted, p_cell, plain, spoken, with_unit
from gaitdisc.results.mismatch import Mismatch

if TYPE_CHECKING:
    import rich.table

HEADINGS = ("channel", "stride [%]", "gap", "at [%]", "in sd", "p")


def regions_table(mismatch: Mismatch) -> Table:
    """Every stretch that differs, channel by channel, the largest gap against its spread first."""
    rows = [row for name in mismatch.ordered() for row in _rows(mismatch, name)]
    caption = (
        f"Where they differ, n = {len(mismatch.regions)} parts of the stride: {mismatch.first} minus "
        f"{mismatch.second}; gap: the largest in that part, and in stride-to-stride standard deviations of "
        f"{mismatch.second} there; p: of that part, corrected for all points and channels."
    )
    return Table("regions", caption, HEADINGS, tuple(rows), mismatch.regions)


def channels_table(mismatch: Mismatch) -> Table:
    """Every channel, whether it differs or not, and what the comparison could have seen of it."""
    rows = tuple(
        (
            spoken(str(row["channel"])),
            "yes" if row["differs"] else "too small" if row["too_small"] else "no",
            _signed(float(row["largest_gap"]), str(row["unit"])),
            f"{row['at_percent']:.0f}",
            amount(float(row["rms_gap"])),
            amount(float(row["rms_sd"])),
            p_cell(float(row["p"])),
            amount(float(row["within"])),
            amount(float(row["visible"])),
            f"{row['shift_percent']:+.0f}" if row["shift_percent"] else "0",
            amount(float(row["rms_shifted"])),
            _signed(float(row["offset"]), str(row["unit"])),
            amount(float(row["shape"])),
            amount(float(row["limit"])),
        )
        for row in map(mismatch.summary_of, mismatch.names)
    )
    caption = (
        f"All {counted(len(rows), 'channel')}. rms: root mean square over the stride, of the gap and of the "
        f"stride-to-stride sd of {mismatch.second}; p: of the largest |t|, corrected for all points and channels; "
        f"agrees within: what the band of the gap allows at its worst point; visible: the gap that four such "
        f"comparisons of five would have seen at a typical point; shift: how much later the curve of "
        f"{mismatch.first} fits best, and the rms gap that is left then; offset: the mean gap; shape: the largest gap "
        f"without it; named from: the smallest difference that is called one{_moved(mismatch)}."
    )
    headings = (
        "channel", "differs", "largest gap", "at [%]", "rms gap", "rms sd", "p", "agrees within", "visible",
        "shift [%]", "rms left", "offset", "shape", "named from",
    )  # fmt: skip
    return Table("channels", caption, headings, rows, mismatch.summary)


def findings_of(mismatch: Mismatch) -> Table:
    """What was seen on the way, the severest first."""
    return seen_table(mismatch.findings, f"Seen on the way, n = {len(mismatch.findings)}.")


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
    regions = mismatch.regions_of(name)
    if not regions:
        row = mismatch.summary_of(name)
        gap = _signed(float(row["largest_gap"]), str(row["unit"]))
        return [
            (spoken(name), NONE, gap, f"{row['at_percent']:.0f}", _in_sd(float(row["gap_sd"])), p_cell(float(row["p"])))
        ]
    return [
        (
            spoken(name),
            f"{row['from_percent']:.0f} to {row['to_percent']:.0f}",
            _signed(float(row["gap"]), str(row["unit"])),
            f"{row['at_percent']:.0f}",
            _in_sd(float(row["gap_sd"])),
            p_cell(float(row["p"])),
        )
        for row in regions
    ]


def _moved(mismatch: Mismatch) -> str:
    found = mismatch.alignment
    if not found.applied:
        return ""
    return f". All curves of {mismatch.first} were moved {found.percent:+.1f} % of the stride first, which they share"


def _signed(gap: float, unit: str) -> str:
    return with_unit(f"{'−' if gap < 0 else '+'}{amount(abs(gap))}", unit)


def _in_sd(value: float) -> str:
    return amount(abs(value)) if math.isfinite(value) else NONE
