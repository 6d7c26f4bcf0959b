"""The page of a reconstruction: answer, models, states and curves, self-contained, every number beside it as CSV."""

from __future__ import annotations

from pathlib import Path

from gaitdisc.report.figure import file_names, save_figures
from gaitdisc.report.page import write_page
from gaitdisc.report.reconstruction_figure import reconstruction_figures
from gaitdisc.report.reconstruction_tables import (
    models_table,
    participants_table,
    reconstruction_sentences,
    states_table,
)
from gaitdisc.report.search_table import search_table
from gaitdisc.report.table import left_out_table, provenance_tables, save_tables, seen_table
from gaitdisc.results.reconstruction import Reconstruction

MOST_DRAWN = 4  # participants whose curves stand in the page; the numbers of all are in errors.csv and curves.csv
FINDINGS = "Findings in the recordings, n = {}; windows on plateaus and filled gaps are used as they are."


def write_reconstruction_report(done: Reconstruction, folder: Path) -> Path:
    """Write the report of a reconstruction: `report.html`, `figures/` and `tables/`."""
    tables = {
        "models": models_table(done),
        "states": states_table(done),
        **({"search": search_table(done.search)} if done.search is not None else {}),
        "participants": participants_table(done),
        "left_out": left_out_table(done.refusals, "left-out", f"Left out, n = {len(done.refusals)}."),
        "findings": seen_table(done.findings, FINDINGS.format(len(done.findings)), "what was seen"),
        **provenance_tables(done.provenance),
    }
    save_tables(tables.values(), folder)
    names = file_names(done.participants[:MOST_DRAWN])
    drawn = [figure for person, name in names.items() for figure in reconstruction_figures(done, person, name)]
    shown = {
        "done": done,
        "sentences": reconstruction_sentences(done),
        "figures": save_figures(drawn, folder),
        "tables": tables,
        "method": method_sentences(done),
        "undrawn": len(done.participants) - len(names),
    }
    return write_page("reconstruction", shown, folder)


def method_sentences(done: Reconstruction) -> list[str]:
    """How the numbers were made."""
    return [
        f"A window holds {done.history} (Eqs. 5.1-5.7). No window reaches over a missing value, or from "
        "one trial into another.",
        f"Windows are parted by {done.split}. Scales and weights come from the fitted windows alone; penalties, widths "
        f"and the epoch whose weights are kept are chosen on the checked ones; errors are of the test windows, from "
        f"which the others lie apart by the length of a window and 0.3 s.",
        "All recordings were low-passed by a filter without lag, which looks ahead: reconstructed live, states would "
        "come later by the filter's reach, or be noisier.",
        "RMSE is in the state's own unit, its interval by drawing strides with replacement (1,000 times, 95 %); "
        "angles and positions are never averaged together.",
        *(f"{name}: {words}." for name, words in done.models.items()),
    ]
