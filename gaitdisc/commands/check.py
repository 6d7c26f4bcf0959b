"""`gaitdisc check`: a traffic light for each trial, before anything is fitted."""

from __future__ import annotations

import json
from collections.abc import Iterator
from dataclasses import asdict
from pathlib import Path
from typing import TYPE_CHECKING, Annotated

import typer

from gaitdisc.commands.options import REFUSED, SOME_REFUSED, Json
from gaitdisc.errors import LOG, SchemaError

if TYPE_CHECKING:
    from gaitdisc.processing.inspection import Inspection

LIGHTS = {"green": "green", "amber": "yellow", "red": "bold red"}


def check(
    what: Annotated[Path, typer.Argument(help="A study, its folder, one recording, or a folder of recordings.")],
    notes: Annotated[
        bool, typer.Option("--notes", help="Print notes as well as warnings; --json prints each finding.")
    ] = False,
    as_json: Json = False,
) -> None:
    """Read all files without writing any, and print a traffic light for each trial."""
    seen = []
    for inspection in _inspections(what):
        seen.append(inspection)
        if not as_json:
            LOG.info(f"  read {inspection.participant} {inspection.name}")
    if as_json:
        typer.echo(json.dumps([_as_dict(inspection) for inspection in seen], indent=1))
    else:
        _print_inspections(seen, notes)
    red = sum(inspection.light == "red" for inspection in seen)
    if red:
        raise typer.Exit(REFUSED if red == len(seen) else SOME_REFUSED)


def _inspections(what: Path) -> Iterator[Inspection]:
    from gaitdisc.ingest.c3d import C3DReader
    from gaitdisc.ingest.reading import ENDINGS
    from gaitdisc.ingest.study_file import load_study
    from gaitdisc.processing.inspection import inspect_file, inspect_study

    if not what.exists():
        raise SchemaError("the path must be a study, recording or folder", f"{what} does not exist", "Check the path.")
    if what.suffix == ".toml" or (what / "study.toml").is_file():
        yield from inspect_study(load_study(what))
        return
    files = [what]
    if what.is_dir():
        files = sorted(file for file in what.rglob("*") if file.suffix.lower() in ENDINGS)
        if not files:
            raise SchemaError(
                f"the path must lead to a study or to recordings ({', '.join(ENDINGS)})",
                f"{what} contains none",
                "Name a study, a file, or a folder of recordings.",
            )
    with C3DReader() as reader:
        for file in files:
            yield inspect_file(file, reader)


def _print_inspections(seen: list[Inspection], notes: bool) -> None:
    from rich import box
    from rich.console import Console
    from rich.table import Table

    from gaitdisc.words import plain

    console = Console()
    table = Table("light", "who", "trial", "channels", "strides", "warnings", box=box.SIMPLE)
    for inspection in seen:
        rows = [f"{side} {n}" + (f" ({out} dropped)" if out else "") for side, (n, out) in inspection.strides.items()]
        warnings = sum(finding.severity != "note" for finding in inspection.findings)
        name = "\n".join(part for part in (inspection.condition, inspection.name) if part)
        streams = "\n".join(f"{key} {words}" for key, words in inspection.streams.items())
        cells = (inspection.participant, name, streams, "\n".join(rows), str(warnings or ""))
        table.add_row(plain(inspection.light, LIGHTS[inspection.light]), *map(plain, cells))
    console.print(table)
    for inspection in seen:
        if refusal := inspection.refusal:
            who = inspection.name or inspection.participant
            console.print(plain(f"refused: {refusal if refusal.startswith(who) else f'{who}: {refusal}'}"))
        for line in inspection.grouped(notes):
            console.print(plain(line))


def _as_dict(inspection: Inspection) -> dict[str, object]:
    return {
        "light": inspection.light,
        "participant": inspection.participant,
        "condition": inspection.condition,
        "file": inspection.name,
        "streams": dict(inspection.streams),
        "strides": {side: {"kept": kept, "dropped": lost} for side, (kept, lost) in inspection.strides.items()},
        "refusal": inspection.refusal,
        "findings": [asdict(finding) for finding in inspection.findings],
    }
