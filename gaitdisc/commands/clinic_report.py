"""Pages of people drawn again by `gaitdisc report`: one person, or two sessions or conditions of one."""

from __future__ import annotations

from pathlib import Path

import typer

from gaitdisc.commands.clinic_pages import (
    keep_reference,
    keep_words,
    page_of_run,
    write_before_after,
    write_english,
    write_people,
    write_person,
)
from gaitdisc.errors import SchemaError


def clinic_report(folder: Path, person: str, pair: tuple[str, str], reference: Path | None, pdf: bool) -> bool:
    """Draw pages of people; False where the folder is no run of pooled cycles and nothing of one was named.

    Parameters
    ----------
    folder : Path
        Of a run, or of a study that was run.
    pair : tuple of str
        Two sessions or conditions, or two empty words.
    """
    named = bool(person or any(pair) or reference or pdf)
    run_folder = run_folder_of(folder)
    if not named and not (run_folder / "cycles").is_dir():
        return False
    from gaitdisc.report.saved_page import draw_questions
    from gaitdisc.results.run_store import load_run

    run = load_run(run_folder)
    if named and not run.cycles:
        raise SchemaError(
            "pages of people need a run of pooled cycles", f"{run_folder} has none", "Run a study of short trials."
        )
    keep_reference(reference, run_folder)
    if any(pair):
        if not (person and all(pair)):
            raise SchemaError(
                "a comparison needs --person, --before and --after",
                f"found person {person!r}, before {pair[0]!r}, after {pair[1]!r}",
                "Name all three.",
            )
        _said(write_before_after(run, run_folder, person, pair))
    elif person:
        for page in write_person(run, run_folder, person, pdf):
            _said(page)
    elif pdf:
        typer.echo(f"people: {write_people(run, run_folder, pdf, _said)}")
    else:
        typer.echo(f"report: {page_of_run(run, run_folder)}")
        for word, page in draw_questions(run_folder).items():
            typer.echo(f"{word}: {page}")
        if run.cycles:
            typer.echo(f"people: {run_folder / 'report' / 'index.html'}")
    return True


def language_of(folder: Path, language: str) -> bool:
    """Keep the words of another language with a run; True where only the table to be filled in was written."""
    if language != "en" and not Path(language).exists():
        typer.echo(
            f"words: {write_english(Path(language))}. Fill in the second column, then give the same command again."
        )
        return True
    lacking = keep_words(language, run_folder_of(folder))
    if lacking:
        typer.echo(f"English stays, {len(lacking)} words: {'; '.join(lacking)}")
    return False


def run_folder_of(folder: Path) -> Path:
    """Folder of a run: the one that is named, or `run` in the folder of a study."""
    return folder / "run" if (folder / "run" / "run.json").is_file() else folder


def _said(page: Path) -> None:
    typer.echo(f"page: {page}")
