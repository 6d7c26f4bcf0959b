"""What lies beside the recordings of a study that it does not name."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from gaitdisc.ingest.study import Study


def say_new_recordings(study: Study) -> None:
    """Say how many recordings lie beside those of each person that the study does not name; their names stay away."""
    import typer

    owners: dict[Path, str] = {}
    named = {
        study.path_of(file).resolve(): one.id for one in study.participants for t in one.trials for file in t.files
    }
    for path, who in named.items():
        owners.setdefault(path.parent, who)
    endings, found = {path.suffix.lower() for path in named}, dict.fromkeys(owners.values(), 0)
    for folder, who in owners.items():
        beside = folder.iterdir() if folder.is_dir() else ()
        found[who] += sum(one.suffix.lower() in endings and one.resolve() not in named for one in beside)
    new = ", ".join(f"{count} beside those of {who}" for who, count in found.items() if count)
    if new:
        words = "New recordings are not in the study file: {}. Take them up: gaitdisc watch STUDY --from RECORDINGS."
        typer.echo(words.format(new), err=True)
