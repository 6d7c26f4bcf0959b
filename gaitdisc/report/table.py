"""A table of the report: the cells as they are read, and the numbers behind them, which lie beside the page."""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import dataclass
from pathlib import Path

import pandas as pd

from gaitdisc.spreadsheet import write_csv


@dataclass(frozen=True, eq=False)
class Table:
    """A table as it is printed."""

    name: str
    caption: str  # what it shows, with n, unit and split where there are numbers
    columns: tuple[str, ...]
    rows: tuple[tuple[str, ...], ...]
    numbers: pd.DataFrame  # what the CSV holds
    # tuple of (str, int), headings above the headings, with the number of columns that each spans
    groups: tuple[tuple[str, int], ...] = ()
    summary: bool = False  # the last row sums up the others


def words_table(name: str, caption: str, headings: tuple[str, ...], rows: Iterable[tuple[str, ...]]) -> Table:
    """Table whose CSV holds the very words that are read: settings, hashes, findings, reasons.

    >>> words_table("files", "Files.", ("file", "SHA-256"), [("a.c3d", "ff")]).numbers["file"].tolist()
    ['a.c3d']
    """
    cells = tuple(rows)
    return Table(name, caption, headings, cells, pd.DataFrame(cells, columns=pd.Index(headings)))


def save_tables(tables: Iterable[Table], folder: Path) -> None:
    """Write the numbers of tables into the folder `tables/` of a report, each as CSV of its name."""
    for table in tables:
        save_table(table.numbers, folder / "tables" / f"{table.name}.csv")


def save_table(table: pd.DataFrame, path: Path) -> None:
    """Write a table as CSV, whole, with the same bytes for the same numbers.

    table: its index is not written
    """
    write_csv(table, path, "%.8g")


def as_markdown(table: Table) -> str:
    """Return a table as documents of the project hold it.

    >>> print(as_markdown(words_table("s", "", ("where", "ours"), [("3.4", "a")])))
    | where | ours |
    |---|---|
    | 3.4 | a |
    """
    rows = ["| " + " | ".join(table.columns) + " |", "|" + "---|" * len(table.columns)]
    return "\n".join(
        [*rows, *("| " + " | ".join(cell.replace("\n", " ") for cell in row) + " |" for row in table.rows)]
    )
