"""`gaitdisc new`: a study file from a folder of recordings."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated

import typer

from gaitdisc.errors import SchemaError


def new(
    study: Annotated[Path, typer.Argument(help="Folder of the new study.")],
    recordings: Annotated[Path, typer.Option("--from", help="Folder of recordings; it is not changed.")],
) -> None:
    """Write a study file from the recordings found in a folder."""
    from gaitdisc.ingest.new_study import found_study
    from gaitdisc.ingest.study_file import write_study
    from gaitdisc.report.wording import counted

    file = study / "study.toml"
    if file.exists():
        raise SchemaError(
            "a new study needs a folder without one", f"{file} is there already", "Choose another folder, or delete it."
        )
    draft, notes = found_study(recordings, study)
    write_study(draft, file)
    for note in notes:
        typer.echo(f"  {note}")
    people = counted(len(draft.participants), "participant")
    typer.echo(f"{file} written: {people}. Read it, then: gaitdisc check {study}")
