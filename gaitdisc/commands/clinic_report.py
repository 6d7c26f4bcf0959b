"""Pages of people drawn again by `gaitdisc report`: one person, or two sessions or conditions of one."""

from __future__ import annotations

from pathlib import Path

import typer

from gaitdisc.commands.clinic_pages import keep_reference, write_before_after, write_people, write_person
from gaitdisc.errors import SchemaError


def clinic_report(folder: Path, person: str, pair: tuple[str, str], reference: Path | None, pdf: bool) -> bool:
    """Draw pages of people where a person or a reference is named; False where neither is.

    Parameters
    ----------
    folder : Path
        Of a run, or of a study that was run.
    pair : tuple of str
        Two sessions or conditions, or two empty words.
    """
    if not (person or any(pair) or reference or pdf):
        return False
    from gaitdisc.results.run_store import load_run

    run_folder = folder / "run" if (folder / "run" / "run.json").is_file() else folder
    run = load_run(run_folder)
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
    else:
        index = write_people(run, run_folder, pdf, _said if pdf else lambda _: None)
        if index is None:
            raise SchemaError(
                "pages of people need a run of pooled cycles", f"{run_folder} has none", "Run a study of short trials."
            )
        typer.echo(f"people: {index}")
    return True


def _said(page: Path) -> None:
    typer.echo(f"page: {page}")
