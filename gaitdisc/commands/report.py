"""`gaitdisc report`: the pages of a run, drawn again."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated

import typer


def report(
    run_folder: Annotated[Path, typer.Argument(metavar="RUN", help="Folder of a run.")],
    person: Annotated[str, typer.Option(help="Only the page of this person.")] = "",
    before: Annotated[str, typer.Option(help="With --after: a session or condition of the person.")] = "",
    after: Annotated[str, typer.Option(help="What is drawn over it.")] = "",
    pdf: Annotated[bool, typer.Option("--pdf", help="Pages of people as PDF too.")] = False,
    reference: Annotated[Path | None, typer.Option(help="Folder of `gaitdisc reference`: bands, scores.")] = None,
) -> None:
    """Draw the report of a run again, and those of modalities and sensitivity where it has them, without fitting."""
    from gaitdisc.commands.clinic_report import clinic_report

    if clinic_report(run_folder, person, (before, after), reference, pdf):
        return
    from gaitdisc.report.response_page import write_report
    from gaitdisc.report.variants_page import write_variants
    from gaitdisc.results.run_store import load_run
    from gaitdisc.results.variant_store import load_variant_run
    from gaitdisc.results.variants import QUESTIONS

    page = write_report(load_run(run_folder), run_folder / "report")
    typer.echo(f"report: {page}")
    for question in QUESTIONS:
        folder = run_folder / question
        if (folder / "variant_run.json").is_file():
            typer.echo(f"{question}: {write_variants(load_variant_run(folder), folder)}")
