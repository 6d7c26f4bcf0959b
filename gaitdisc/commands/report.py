"""`gaitdisc report`: the page of a saved result, drawn again."""

from pathlib import Path
from typing import Annotated

import typer

from gaitdisc.errors import SchemaError


def report(
    folder: Annotated[
        Path, typer.Argument(help="Folder of a result: run, modalities, sensitivity, discover, compare or reconstruct.")
    ],
    person: Annotated[str, typer.Option(help="In a clinic's run: write only the page of this person.")] = "",
    before: Annotated[str, typer.Option(help="Session or condition of the person, to compare with --after.")] = "",
    after: Annotated[str, typer.Option(help="Session or condition that is compared with --before.")] = "",
    pdf: Annotated[bool, typer.Option("--pdf", help="Also write the pages of people as PDF.")] = False,
    reference: Annotated[Path | None, typer.Option(help="Folder from `gaitdisc reference`: bands and scores.")] = None,
    language: Annotated[
        str,
        typer.Option(
            help="Table of translated words (CSV), written if missing and kept for this run; `en` selects English."
        ),
    ] = "",
) -> None:
    """Draw a saved result's page again, without fitting; for a run, also the pages of modalities and sensitivity."""
    from gaitdisc.clinic.page_words import write_words
    from gaitdisc.clinic.run_pages import keep_words
    from gaitdisc.own_files import claim_folder
    from gaitdisc.report.saved_page import draw_saved

    place = folder / "run" if (folder / "run" / "run.json").is_file() else folder
    if place.is_dir():
        claim_folder(place, "report.html", "report/report.html")
    if language and language != "en" and not Path(language).exists():
        typer.echo(f"words: {write_words(Path(language))}. Fill in the second column and run the command again.")
        return
    if language and (lacking := keep_words(language, place)):
        typer.echo(f"Words without translation ({len(lacking)}) remain in English: {'; '.join(lacking)}")
    named = bool(person or before or after or reference or pdf)
    if named or (place / "cycles").is_dir():
        _people(place, named, person, before, after, reference=reference, pdf=pdf)
        return
    if (folder / "model.json").is_file():
        raise SchemaError(
            "a page must be made from a result",
            f"{folder.name} contains a saved model, which has no page",
            "Name the folder above its `models`, or use the model: gaitdisc apply MODEL RECORDING.",
        )
    for word, page in draw_saved(place).items():
        typer.echo(f"{word}: {page}")


def _people(
    run_folder: Path, named: bool, person: str, before: str, after: str, reference: Path | None, pdf: bool
) -> None:
    """Draw pages of a run's people again: all, those of one person, or two sessions or conditions of one."""
    from gaitdisc.clinic.run_pages import keep_reference, page_of_run, write_people, write_person
    from gaitdisc.report.saved_page import draw_beside
    from gaitdisc.response.participant_response import RUN, load_run

    run = load_run(run_folder)
    if named and not run.cycles:
        raise SchemaError("pages of people must have pooled cycles", f"{run_folder} has none", "Name another run.")
    keep_reference(reference, run_folder)
    if (before or after) and not (person and before and after):
        raise SchemaError(
            "a comparison must have --person, --before and --after",
            f"found person {person!r}, before {before!r}, after {after!r}",
            "Name all three.",
        )
    if person:
        for page in write_person(run, run_folder, person, (before, after) if before else (), pdf):
            _say(page)
    elif pdf:
        typer.echo(f"people: {write_people(run, run_folder, pdf, _say)}")
    else:
        typer.echo(f"report: {page_of_run(run, run_folder)}")
        for word, page in draw_beside(RUN, run_folder).items():
            typer.echo(f"{word}: {page}")
        if run.cycles:
            typer.echo(f"people: {run_folder / 'report' / 'index.html'}")


def _say(page: Path) -> None:
    typer.echo(f"page: {page}")
