"""The page of a mismatch: answer, tables and figures, self-contained, with every number beside it as CSV."""

from __future__ import annotations

from pathlib import Path

import gaitdisc
from gaitdisc.report.figure import save_figure, save_table
from gaitdisc.report.method import flattened, provenance_rows
from gaitdisc.report.mismatch_figure import mismatch_figures
from gaitdisc.report.mismatch_sentences import method_sentences, mismatch_sentences
from gaitdisc.report.mismatch_tables import channels_table, findings_of, regions_table
from gaitdisc.report.page import templates
from gaitdisc.report.tables import pairs_table
from gaitdisc.results.mismatch import Mismatch
from gaitdisc.whole_file import write_whole


def write_mismatch_report(mismatch: Mismatch, folder: Path) -> Path:
    """Write the report of a mismatch: `report.html`, `figures/`, `tables/`, and `channels/` with a CSV a channel.

    Parameters
    ----------
    mismatch : Mismatch
        What was found; nothing is computed again.
    folder : Path
        Where the report goes; made if missing.

    Returns
    -------
    Path
        The page.

    Raises
    ------
    WriteError
        If a file cannot be written; what stood there before still stands.
    """
    made = mismatch.provenance
    tables = {
        "regions": regions_table(mismatch),
        "channels": channels_table(mismatch),
        "findings": findings_of(mismatch),
        "settings": pairs_table("settings", "Settings.", ("setting", "value"), flattened(made.settings)),
        "versions": pairs_table("versions", "Circumstances.", ("what", "value"), provenance_rows(made)),
        "files": pairs_table("files", "Files read, with their SHA-256.", ("file", "SHA-256"), [*made.files.items()]),
    }
    for table in tables.values():
        save_table(table.numbers, folder / "tables" / f"{table.name}.csv")
    for name in mismatch.names:
        save_table(mismatch.curve_table(name), folder / "channels" / f"{name}.csv")
    text = templates().get_template("mismatch.html.j2").render(
        mismatch=mismatch,
        sentences=mismatch_sentences(mismatch),
        figures=[save_figure(figure, folder / "figures") for figure in mismatch_figures(mismatch)],
        tables=tables,
        method=method_sentences(mismatch),
        version=gaitdisc.__version__,
    )  # fmt: skip
    return write_whole(folder / "report.html", text)
