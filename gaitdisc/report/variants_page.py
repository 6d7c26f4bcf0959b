"""A page of its own for a question beside the study: which inputs carry the response, or does a cut-off decide it."""

from __future__ import annotations

from pathlib import Path

from gaitdisc.report.figure import save_figure, save_table
from gaitdisc.report.modalities_figure import modalities_figure, modalities_sentences, modalities_table
from gaitdisc.report.page import templates
from gaitdisc.report.sensitivity_table import sensitivity_sentences, sensitivity_table
from gaitdisc.report.tables import Table
from gaitdisc.results.variants import VariantRun
from gaitdisc.whole_file import whole_file

HEADINGS = {
    "modalities": "Which inputs carry the response",
    "sensitivity": "Other cut-offs and training lengths",
}


def write_variants(run: VariantRun, folder: Path) -> Path:
    """Write `report.html`, `figures/` and `tables/` of one question; self-contained, the same bytes for the same run.

    Parameters
    ----------
    run : VariantRun
        The whole result; nothing is fitted again.
    folder : Path
        Where they go; made if missing.

    Returns
    -------
    Path
        The page.

    Raises
    ------
    WriteError
        If a file cannot be written.
    """
    figure = modalities_figure(run) if run.question == "modalities" else None
    tables = variant_tables(run)
    for table in tables:
        save_table(table.numbers, folder / "tables" / f"{table.name}.csv")
    save_table(run.r2_table(), folder / "tables" / "r2.csv")
    text = templates().get_template("variants.html.j2").render(
        run=run,
        heading=HEADINGS[run.question],
        sentences=variant_sentences(run),
        figures=[save_figure(figure, folder / "figures")] if figure else [],
        tables=tables,
    )  # fmt: skip
    page = folder / "report.html"
    with whole_file(page) as part:
        part.write_text(text, encoding="utf-8", newline="\n")
    return page


def variant_tables(run: VariantRun) -> list[Table]:
    """Tables of a question; none where nobody has numbers.

    Parameters
    ----------
    run : VariantRun
        The whole result.
    """
    if not run.people:
        return []
    if run.question == "sensitivity":
        return [sensitivity_table(run)]
    return [modalities_table(run)] if len(run.tests) else []


def variant_sentences(run: VariantRun) -> tuple[str, ...]:
    """Sentences of a question.

    Parameters
    ----------
    run : VariantRun
        The whole result.
    """
    return modalities_sentences(run) if run.question == "modalities" else sensitivity_sentences(run)
