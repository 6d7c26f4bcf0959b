"""A short table of a result, as notebooks show it."""

from __future__ import annotations

from collections.abc import Iterable
from html import escape


def html_of(title: str, rows: Iterable[tuple[str, str]]) -> str:
    """HTML of a title and a few rows of two cells; every text is escaped.

    >>> html_of("<walk>", [("rate", "100 Hz")])
    '<table><caption>&lt;walk&gt;</caption><tr><th>rate</th><td>100 Hz</td></tr></table>'
    """
    cells = "".join(f"<tr><th>{escape(what)}</th><td>{escape(much)}</td></tr>" for what, much in rows)
    return f"<table><caption>{escape(title)}</caption>{cells}</table>"
