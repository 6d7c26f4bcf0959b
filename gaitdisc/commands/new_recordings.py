"""What lies beside the recordings of a study that it does not name."""

from __future__ import annotations

import os
from pathlib import Path
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from gaitdisc.ingest.study import Study


def say_new_recordings(study: Study) -> None:
    """Say how many recordings beside those of the study it does not name, and of whom; their names stay away.

    Looked at is the folder that all recordings lie in, or, where that is the study's own, the folder of each.
    """
    import typer

    from gaitdisc.ingest.people_table import is_people_table

    people = study.participants
    owners = {study.path_of(file).resolve(): one.id for one in people for t in one.trials for file in t.files}
    folders = {path.parent: who for path, who in owners.items()}
    above = Path(os.path.commonpath(folders)) if len(set(folders.values())) > 1 else Path()
    inside = above.parts[2:] and not study.folder.resolve().is_relative_to(above)
    endings = {path.suffix.lower() for path in owners}
    found: dict[str, int] = {}
    each = above.rglob("*") if inside else (path for one in folders if one.is_dir() for path in one.iterdir())
    for path in each:
        if path.suffix.lower() in endings and path.resolve() not in owners and not is_people_table(path):
            who = next((folders[folder] for folder in path.parents if folder in folders), "")
            beside = f"beside those of {who}" if who else "of somebody new or in a new folder"
            found[beside] = found.get(beside, 0) + 1
    new = ", ".join(f"{count} {beside}" for beside, count in sorted(found.items()))
    if new:
        words = "New recordings are not in the study file: {}. Take them up: gaitdisc watch STUDY --from RECORDINGS."
        typer.echo(words.format(new), err=True)
