"""`gaitdisc report`: the page of a saved result, drawn again."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated

import typer


def report(
    folder: Annotated[
        Path, typer.Argument(help="Folder that run, modalities, sensitivity, discover, compare or reconstruct wrote.")
    ],
    person: Annotated[str, typer.Option(help="Of a clinic's run: only the page of this person.")] = "",
    before: Annotated[str, typer.Option(help="With --after: a session or condition of the person.")] = "",
    after: Annotated[str, typer.Option(help="What is drawn over it.")] = "",
    pdf: Annotated[bool, typer.Option("--pdf", help="Pages of people as PDF too.")] = False,
    reference: Annotated[Path | None, typer.Option(help="Folder of `gaitdisc reference`: bands, scores.")] = None,
    language: Annotated[
        str, typer.Option(help="CSV of words, kept by the run; one that is not there is written; `en` for English.")
    ] = "",
) -> None:
    """Draw the page of a saved result again, without fitting; of a run also those of modalities and sensitivity."""
    from gaitdisc.commands.clinic_report import clinic_report, language_of, run_folder_of
    from gaitdisc.errors import SchemaError
    from gaitdisc.own_files import claim_folder
    from gaitdisc.report.saved_page import draw_saved

    place = run_folder_of(folder)
    if place.is_dir():
        claim_folder(place, "report.html", "report/report.html")
    if language and language_of(folder, language):
        return
    if clinic_report(folder, person, (before, after), reference, pdf):
        return
    if (folder / "model.json").is_file():
        raise SchemaError(
            "a page is drawn of a result",
            f"{folder.name} holds a saved model, which has none",
            "Name the folder above its `models`, or use the model: gaitdisc apply MODEL RECORDING.",
        )
    for word, page in draw_saved(place).items():
        typer.echo(f"{word}: {page}")
