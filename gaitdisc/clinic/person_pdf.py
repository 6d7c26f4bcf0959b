"""The page of a person as PDF: sheets of A4 that typst sets from the very blocks and figures of the page."""

from __future__ import annotations

import base64
import json
from collections.abc import Mapping
from pathlib import Path
from typing import Any

from gaitdisc.clinic.page_words import PageWords
from gaitdisc.errors import SchemaError
from gaitdisc.report.curve_panels import TEMPLATES, Panel
from gaitdisc.report.table import Table
from gaitdisc.whole_file import write_whole

NO_PDF = ("PDF requires the package typst", "it is not installed", "Install it: pip install 'gaitdisc[pdf]'.")


def write_person_pdf(shown: Mapping[str, Any], path: Path) -> Path:
    """Write the PDF of what a page shows; the same bytes for the same numbers.

    Words and curves are set in DejaVu Sans, which matplotlib brings, so that sheets are alike on all machines.
    """
    import matplotlib as mpl
    import typst

    style = (TEMPLATES / "curves.css").read_text(encoding="utf-8") + "svg text { font-family: 'DejaVu Sans'; }"
    picture = list(base64.b64decode(shown["logo"].partition(",")[2]))
    page = json.dumps({**shown, "style": style, "picture": picture}, default=_as_json)
    template, fonts = TEMPLATES / "person.typ", [Path(mpl.get_data_path(), "fonts", "ttf")]
    try:
        sheets = typst.compile(template, root=TEMPLATES, font_paths=fonts, sys_inputs={"page": page}, timestamp=0)
    except typst.TypstError as error:
        raise SchemaError("typst must typeset the page", f"it reports: {error}", "Save the logo again.") from error
    return write_whole(path, sheets)


def _as_json(value: object) -> Any:
    """What the template reads of a word list, a table or a panel."""
    if isinstance(value, PageWords):
        return value.other
    if isinstance(value, Table):
        return {"columns": value.columns, "rows": value.rows, "caption": value.caption}
    assert isinstance(value, Panel)
    return {"title": value.title, "unit": value.unit, "note": value.note, "span": value.span, "alt": value.alt}
