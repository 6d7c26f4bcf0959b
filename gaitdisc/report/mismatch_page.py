"""The page of a mismatch: answer, tables and figures, self-contained, with every number beside it as CSV."""

from __future__ import annotations

from pathlib import Path

from gaitdisc.report.figure import save_figures
from gaitdisc.report.mismatch_figure import mismatch_figures
from gaitdisc.report.mismatch_sentences import method_sentences, mismatch_sentences
from gaitdisc.report.mismatch_tables import channels_table, findings_of, regions_table
from gaitdisc.report.page import write_page
from gaitdisc.report.table import provenance_tables, save_table, save_tables
from gaitdisc.results.mismatch import Mismatch


def write_mismatch_report(mismatch: Mismatch, folder: Path) -> Path:
    """Write the report of a mismatch: `report.html`, `figures/`, `tables/`, and `channels/` with a CSV a channel."""
    tables = {
        "regions": regions_table(mismatch),
        "channels": channels_table(mismatch),
        "findings": findings_of(mismatch),
        **provenance_tables(mismatch.provenance),
    }
    save_tables(tables.values(), folder)
    for name in mismatch.names:
        save_table(mismatch.curve_table(name), folder / "channels" / f"{name}.csv")
    shown = {
        "mismatch": mismatch,
        "sentences": mismatch_sentences(mismatch),
        "figures": save_figures(mismatch_figures(mismatch), folder),
        "tables": tables,
        "method": method_sentences(mismatch),
    }
    return write_page("mismatch", shown, folder)
