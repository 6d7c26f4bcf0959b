"""A page of the report: one file that needs nothing but itself, made of a template and what it shows."""

from __future__ import annotations

import re
from collections.abc import Mapping
from pathlib import Path
from typing import TYPE_CHECKING, Any

import gaitdisc
from gaitdisc.whole_file import write_whole

if TYPE_CHECKING:
    import jinja2


def write_page(template: str, shown: Mapping[str, Any], folder: Path) -> Path:
    """Write `report.html` of a folder.

    shown: what the template names, but for the version of this package
    """
    return write_whole(folder / "report.html", page_text(template, shown))


def page_text(template: str, shown: Mapping[str, Any]) -> str:
    """Page of a template and what it shows."""
    return _templates().get_template(f"{template}.html.j2").render(version=gaitdisc.__version__, **shown)


def _templates() -> jinja2.Environment:
    """Templates of the pages, with the filter that binds numbers to their units."""
    import jinja2

    found = jinja2.Environment(
        loader=jinja2.FileSystemLoader(Path(__file__).parent / "templates"),
        autoescape=True,
        undefined=jinja2.StrictUndefined,
        trim_blocks=True,
        lstrip_blocks=True,
    )
    found.filters["bound"] = _bound
    return found


def _bound(text: str) -> str:
    """Bind numbers to their units, so that no line breaks between them."""
    return re.sub(r"(?<=\d) (?=(?:s|%|Hz)(?!\w))", "\u00a0", text)
