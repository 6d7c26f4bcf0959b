"""A page of its own for a question beside the study: which inputs carry the response, or does a cut-off decide it."""

from __future__ import annotations

from pathlib import Path

from gaitdisc.report.figure import save_figures
from gaitdisc.report.modalities_figure import modalities_figure, modalities_sentences, modalities_table
from gaitdisc.report.page import write_page
from gaitdisc.report.sensitivity_table import sensitivity_sentences, sensitivity_table
from gaitdisc.report.table import Table, save_table, save_tables
from gaitdisc.results.variants import VariantRun

HEADINGS = {
    "modalities": "Which inputs carry the response",
    "sensitivity": "Other cut-offs and training lengths",
}


def write_variants(run: VariantRun, folder: Path) -> Path:
    """Write `report.html`, `figures/` and `tables/` of one question; the same bytes for the same run."""
    figure = modalities_figure(run) if run.question == "modalities" else None
    tables = variant_tables(run)
    save_tables(tables, folder)
    save_table(run.r2_table(), folder / "tables" / "r2.csv")
    shown = {
        "run": run,
        "heading": HEADINGS[run.question],
        "sentences": variant_sentences(run),
        "figures": save_figures([figure] if figure else [], folder),
        "tables": tables,
    }
    return write_page("variants", shown, folder)


def variant_tables(run: VariantRun) -> list[Table]:
    """Tables of a question; none where nobody has numbers."""
    if not run.people:
        return []
    if run.question == "sensitivity":
        return [sensitivity_table(run)]
    return [modalities_table(run)] if len(run.tests) else []


def variant_sentences(run: VariantRun) -> tuple[str, ...]:
    """Sentences of a question."""
    return modalities_sentences(run) if run.question == "modalities" else sensitivity_sentences(run)
