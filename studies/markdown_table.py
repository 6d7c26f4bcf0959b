"""A table as documents of the project hold it."""

from __future__ import annotations

from collections.abc import Iterable


def markdown_table(headings: str, rows: Iterable[Iterable[object]]) -> str:
    """A Markdown table, its headings parted by `|`."""
    names = [name.strip() for name in headings.split("|")]
    lines = [f"| {' | '.join(map(str, row))} |" for row in (names, *rows)]
    return "\n".join([lines[0], "|" + "---|" * len(names), *lines[1:]])
