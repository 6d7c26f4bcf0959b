"""The R2 table for a terminal: the report's first numbers without a browser."""

from __future__ import annotations

from typing import TYPE_CHECKING

from gaitdisc.report.tables import Table, participants_table, r2_table, refusals_table
from gaitdisc.results import ResponseRun

if TYPE_CHECKING:
    import rich.table


def r2_text(run: ResponseRun) -> rich.table.Table:
    """R2 of one participant by variable, or of several participants by person, each the median over variables.

    Parameters
    ----------
    run : ResponseRun
        The whole result. Where nobody could be analysed, the table says who was refused, and why.
    """
    if not run.responses:
        return _printed(refusals_table(run))
    if len(run.responses) == 1:
        return _printed(r2_table(run.responses[0], run.responses[0].participant))
    return _printed(participants_table(run))


def _printed(table: Table) -> rich.table.Table:
    from rich import box
    from rich.markup import escape
    from rich.table import Table as Printed

    printed = Printed(box=box.SIMPLE, caption=escape(table.caption), caption_justify="left", show_edge=False)
    above = [group for group, span in table.groups for _ in range(span)] or [""] * len(table.columns)
    for index, (column, group) in enumerate(zip(table.columns, above, strict=True)):
        words = (group, *column.split(", ")) if group and column != "null" else (column,)
        left = index == 0 or not table.groups
        printed.add_column(escape("\n".join(words)), justify="left" if left else "right", vertical="bottom")
    for row in table.rows[: -1 if table.summary else None]:
        printed.add_row(*(escape(cell) for cell in row))
    if table.summary:
        printed.add_section()
        printed.add_row(*(escape(cell) for cell in table.rows[-1]), style="bold")
    return printed
