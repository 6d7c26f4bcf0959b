"""A table as documents of the project hold it."""

from __future__ import annotations

from collections.abc import Iterable
from typing import Any


def markdown_table(headings: str, rows: Iterable[Iterable[object]]) -> str:
    """A Markdown table, its headings parted by `|`."""
    names = [name.strip() for name in headings.split("|")]
    lines = [f"| {' | '.join(map(str, row))} |" for row in (names, *rows)]
    return "\n".join([lines[0], "|" + "---|" * len(names), *lines[1:]])


def as_markdown(table: Any) -> str:
    """A `Table` of a page, each heading after that which stands above it."""
    groups = [group for group, count in table.groups for _ in range(count)] or [""] * len(table.columns)
    heads = [f"{group}: {name}" if group else name for group, name in zip(groups, table.columns, strict=True)]
    return markdown_table(" | ".join(heads), [[cell.replace("\n", " ") for cell in row] for row in table.rows])
