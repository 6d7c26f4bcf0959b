"""The R2 table for a terminal of 80 columns: the report's first numbers without a browser."""

from __future__ import annotations

from typing import TYPE_CHECKING

import pandas as pd

from gaitdisc.report.r2_summary import (
    R2_TABLE,
    held_out_text,
    medians,
    participant_medians,
    r2_by_variable,
    sample_counts,
)
from gaitdisc.report.wording import counted, number, plain
from gaitdisc.results import ResponseRun

if TYPE_CHECKING:
    import rich.table

_SHOWN = [
    column for column in R2_TABLE if (column.kind, column.walk) != ("ridge", "nominal") and column.kind != "linear"
]
_SHORT = {"nominal": "Nominal", "augmented": "Augm.", "exo": "Exo", "": "null"}


def r2_text(run: ResponseRun) -> rich.table.Table:
    """R2 of one participant by variable, or of several participants by person, each the median over variables.

    run: the whole result. Where nobody could be analysed, the table says who was refused, and why
    """
    if not run.responses:
        return _refused(run)
    about = f"last {held_out_text(run)} s of each walk held out; null: band-limited noise alone"
    if len(run.responses) == 1:
        [response] = run.responses
        title = (
            f"{response.participant}: R² on the held-out device walk, n = {sample_counts(response)} samples; {about}"
        )
        return _printed(r2_by_variable(response), title)
    people = counted(len(run.responses), "participant")
    return _printed(
        participant_medians(run), f"R² on the held-out device walk, median over variables, n = {people}; {about}"
    )


def _printed(values: pd.DataFrame, caption: str) -> rich.table.Table:
    table = _empty(caption)
    table.add_column(plain(str(values.index.name)), vertical="bottom", no_wrap=True)
    for column in _SHOWN:
        kind = "" if column.kind == "null" else column.kind
        place = "no dev." if column.walk == "nominal" else ""
        table.add_column(plain(f"{kind}\n{_SHORT[column.model]}\n{place}"), justify="right", no_wrap=True)
    for name, row in values.iterrows():
        table.add_row(plain(str(name)), *(_short(float(row[column.key])) for column in _SHOWN))
    table.add_section()
    middle = medians(values)
    table.add_row("median", *(_short(float(middle[column.key])) for column in _SHOWN), style="bold")
    return table


def _refused(run: ResponseRun) -> rich.table.Table:
    table = _empty(f"Nobody could be analysed; left out: n = {len(run.refusals)}.")
    for heading in ("participant", "walk", "reason"):
        table.add_column(heading)
    for refusal in run.refusals:
        table.add_row(plain(refusal.participant), plain(refusal.condition or "all"), plain(refusal.reason))
    return table


def _empty(caption: str) -> rich.table.Table:
    from rich import box
    from rich.table import Table

    return Table(
        box=box.SIMPLE,
        caption=plain(caption),
        caption_justify="left",
        show_edge=False,
        pad_edge=False,
        padding=(0, 1, 0, 0),
    )


def _short(value: float) -> str:
    return "–" if pd.isna(value) else number(value)
