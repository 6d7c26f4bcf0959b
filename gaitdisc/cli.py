"""The command line: `gaitdisc new`, `check`, `run`, `report`, `export`, `demo`.

Exit codes: 0 done; 1 refused (a sentence says what was needed, what was found and what to do); 2 wrong usage; 3 done,
but some trials or participants were refused and are listed; 130 stopped.
"""

from __future__ import annotations

import json
import sys
import time
from collections.abc import Callable, Iterator
from dataclasses import asdict
from pathlib import Path
from typing import TYPE_CHECKING, Annotated

import typer

import gaitdisc
from gaitdisc.errors import GaitdiscError, SchemaError

if TYPE_CHECKING:
    from gaitdisc.batch.run_study import Told
    from gaitdisc.ingest.study import Study
    from gaitdisc.processing.inspection import Inspection
    from gaitdisc.results import ResponseRun

STUDY_FILE = "study.toml"
REFUSED, SOME_REFUSED, STOPPED = 1, 3, 130
LIGHTS = {"green": "green", "amber": "yellow", "red": "bold red"}

app = typer.Typer(add_completion=False, no_args_is_help=True, rich_markup_mode=None, pretty_exceptions_enable=False)
Json = Annotated[bool, typer.Option("--json", help="Print JSON instead of tables.")]
Quiet = Annotated[bool, typer.Option("--quiet", "-q", help="No progress.")]


@app.command()
def new(
    study: Annotated[Path, typer.Argument(help="Folder of the new study.")],
    recordings: Annotated[Path, typer.Option("--from", help="Folder of recordings; it is not changed.")],
) -> None:
    """Write a study file from the recordings found in a folder."""
    from gaitdisc.ingest.new_study import found_study
    from gaitdisc.ingest.study_file import write_study

    file = study / STUDY_FILE
    if file.exists():
        raise SchemaError(
            "a new study needs a folder without one", f"{file} is there already", "Choose another folder, or delete it."
        )
    draft, notes = found_study(recordings, study)
    write_study(draft, file)
    for note in notes:
        typer.echo(f"  {note}")
    typer.echo(f"{file} written: {len(draft.participants)} participants. Read it, then: gaitdisc check {study}")


@app.command()
def check(
    what: Annotated[Path, typer.Argument(help="A study, its folder, one recording, or a folder of recordings.")],
    notes: Annotated[
        bool, typer.Option("--notes", help="Print notes as well as warnings; --json prints each finding.")
    ] = False,
    as_json: Json = False,
) -> None:
    """Read everything, write nothing, and print a traffic light for each trial."""
    seen = []
    for inspection in _inspections(what):
        seen.append(inspection)
        if not as_json:
            typer.echo(f"  read {inspection.participant} {inspection.name}", err=True)
    if as_json:
        typer.echo(json.dumps([_as_dict(inspection) for inspection in seen], indent=1))
    else:
        _print_inspections(seen, notes)
    red = sum(inspection.light == "red" for inspection in seen)
    if red:
        raise typer.Exit(REFUSED if red == len(seen) else SOME_REFUSED)


@app.command()
def run(
    study: Annotated[Path, typer.Argument(help="The study file or its folder.")],
    out: Annotated[Path | None, typer.Option(help="Folder of the run; by default STUDY/run.")] = None,
    participant: Annotated[list[str] | None, typer.Option(help="Only this participant; may be repeated.")] = None,
    jobs: Annotated[int, typer.Option("--jobs", "-j", min=1, help="Participants side by side.")] = 1,
    cluster: Annotated[str, typer.Option(help="Address of a Dask scheduler, tcp://host:8786.")] = "",
    quiet: Quiet = False,
) -> None:
    """Process, fit, judge and report; what an earlier run has finished is kept."""
    from gaitdisc.batch.run_study import run_study
    from gaitdisc.batch.workers import Workers
    from gaitdisc.ingest.study_file import load_study

    loaded = load_study(study)
    if participant:
        chosen = tuple(loaded.participant(name) for name in participant)
        loaded = loaded.model_copy(update={"participants": chosen})
    folder = out or loaded.folder / "run"
    _report_on(lambda told: run_study(loaded, folder, Workers(jobs, cluster), told), loaded, folder, quiet)


@app.command()
def ablate(
    study: Annotated[Path, typer.Argument(help="The study file or its folder.")],
    out: Annotated[Path | None, typer.Option(help="Folder of the run; by default STUDY/run.")] = None,
    length: Annotated[list[float] | None, typer.Option(help="Training length [s]; may be repeated.")] = None,
    part: Annotated[str, typer.Option(help="Seconds of the training part that are taken: first or last.")] = "first",
    quiet: Quiet = False,
) -> None:
    """Fit the models to less and less data: how much is enough."""
    from gaitdisc.batch.ablate_study import ablate_study
    from gaitdisc.ingest.study_file import load_study
    from gaitdisc.response.data_quantity import LENGTHS_S

    loaded = load_study(study)
    folder, lengths = out or loaded.folder / "run", tuple(length) if length else LENGTHS_S
    _report_on(lambda told: ablate_study(loaded, folder, lengths, part, told), loaded, folder, quiet)


@app.command()
def report(run_folder: Annotated[Path, typer.Argument(metavar="RUN", help="Folder of a run.")]) -> None:
    """Draw the report of a run again, without fitting."""
    from gaitdisc.report.page import write_report
    from gaitdisc.results.store import load_run

    page = write_report(load_run(run_folder), run_folder / "report")
    typer.echo(f"report: {page}")


@app.command()
def export(
    files: Annotated[list[Path], typer.Argument(help="Files of one walk: angles, forces, EMG.")],
    out: Annotated[Path, typer.Option("--out", help="File to write: .csv, .tsv, .parquet, .mot or .sto.")],
    rate: Annotated[float, typer.Option(min=1.0, help="Samples a second of the result.")] = 100.0,
    stream: Annotated[list[str] | None, typer.Option(help="Only this stream; may be repeated.")] = None,
) -> None:
    """Bring EMG, force and kinematics of one walk to one time base, low-passed where they are faster than it."""
    from gaitdisc.ingest.reading import read_trial
    from gaitdisc.ingest.storage import write_storage
    from gaitdisc.ingest.table import write_table
    from gaitdisc.processing.one_base import on_one_base

    together = on_one_base(read_trial(files), rate, tuple(stream) if stream else None)
    write = write_storage if out.suffix.lower() in (".mot", ".sto") else write_table
    write(together, out)
    typer.echo(f"{out}: {len(together.names)} channels, {len(together.time)} samples at {together.rate_hz:g} Hz")


@app.command()
def demo(
    folder: Annotated[Path, typer.Argument(help="Folder to make.")] = Path("demo"),
    seconds: Annotated[float, typer.Option(min=30.0, help="Length of each walk; the dissertation's is 240.")] = 60.0,
    people: Annotated[int, typer.Option(min=1, max=12, help="How many of the twelve.")] = 12,
    hide: Annotated[
        str, typer.Option(help="What differs between the walks: spring, weak plantarflexor, ...")
    ] = "spring",
    jobs: Annotated[int, typer.Option("--jobs", "-j", min=1, help="Participants side by side.")] = 2,
    quiet: Quiet = False,
) -> None:
    """Let the embedded cohort walk without and with an ankle spring, and do the whole job on its recordings."""
    from gaitdisc.batch.demonstration import write_demonstration
    from gaitdisc.batch.run_study import run_study
    from gaitdisc.batch.workers import Workers
    from gaitdisc.ingest.study_file import load_study

    typer.echo(f"{people} of the embedded cohort walk {seconds:g} s in each condition: simulated, no people.")
    write_demonstration(folder, seconds, people, hide, lambda who, _: typer.echo(f"  {who}", err=True, nl=not quiet))
    study = load_study(folder)
    try:
        _report_on(lambda told: run_study(study, folder / "run", Workers(jobs), told), study, folder / "run", quiet)
    except typer.Exit as ended:
        if ended.exit_code != SOME_REFUSED:
            raise
        typer.echo(
            "Whoever changes the way of walking late in a trial is meant to be refused; that is the demonstration."
        )


def _version(wanted: bool) -> None:
    if wanted:
        typer.echo(f"gaitdisc {gaitdisc.__version__}")
        raise typer.Exit


@app.callback()
def _about(
    version: Annotated[
        bool, typer.Option("--version", callback=_version, is_eager=True, help="Print the version.")
    ] = False,
) -> None:
    """Where a model of walking and measured gait disagree, and what the difference is."""


def main() -> None:
    """Run the command line; a refusal is printed as its sentence, never as a traceback."""
    try:
        app()
    except GaitdiscError as error:
        typer.echo(f"{type(error).__name__}: {error}", err=True)
        sys.exit(REFUSED)


def _report_on(work: Callable[[Told], ResponseRun], study: Study, folder: Path, quiet: bool) -> None:
    """Do the work with its progress shown, draw the report, and say who was refused."""
    from rich.console import Console

    from gaitdisc.report.page import write_report
    from gaitdisc.report.text import r2_text

    started = time.perf_counter()
    try:
        done = work(lambda *_: None) if quiet else _with_progress(work, [person.id for person in study.participants])
    except KeyboardInterrupt:
        typer.echo("Stopped. What was finished is kept; the same command goes on from there.", err=True)
        raise typer.Exit(STOPPED) from None
    page = write_report(done, folder / "report")
    if done.responses:
        Console().print(r2_text(done))
    for refusal in done.refusals:
        who = " ".join(part for part in (refusal.participant, refusal.condition) if part)
        typer.echo(f"refused: {who}: {refusal.reason}", err=True)
    typer.echo(f"{len(done.responses)} participants in {time.perf_counter() - started:.0f} s. report: {page}")
    if done.refusals:
        raise typer.Exit(SOME_REFUSED if done.responses else REFUSED)


def _with_progress(work: Callable[[Told], ResponseRun], people: list[str]) -> ResponseRun:
    from rich.console import Console
    from rich.progress import BarColumn, Progress, TextColumn, TimeElapsedColumn, TimeRemainingColumn

    elapsed, left = TimeElapsedColumn(), TimeRemainingColumn()
    columns = (TextColumn("{task.description}"), BarColumn(), elapsed, TextColumn("left"), left)
    shares = dict.fromkeys(people, 0.0)
    with Progress(*columns, console=Console(stderr=True), transient=True) as bar:
        task = bar.add_task("participants", total=len(shares))

        def told(participant: str, share: float) -> None:
            shares[participant] = share
            bar.update(task, completed=sum(shares.values()), description=f"{participant} of {len(shares)} participants")

        return work(told)


def _inspections(what: Path) -> Iterator[Inspection]:
    from gaitdisc.ingest.c3d import C3DReader
    from gaitdisc.ingest.reading import ENDINGS
    from gaitdisc.ingest.study_file import load_study
    from gaitdisc.processing.inspection import inspected_file, inspected_study

    if not what.exists():
        raise SchemaError("a study, a recording or a folder is needed", f"{what} is not there", "Check the path.")
    if what.suffix == ".toml" or (what / STUDY_FILE).is_file():
        yield from inspected_study(load_study(what))
        return
    files = [what]
    if what.is_dir():
        files = sorted(file for file in what.rglob("*") if file.suffix.lower() in ENDINGS)
        if not files:
            raise SchemaError(
                f"a study or recordings ({', '.join(ENDINGS)}) are needed",
                f"{what} holds none",
                "Name a study, a file, or a folder of recordings.",
            )
    with C3DReader() as reader:
        for file in files:
            yield inspected_file(file, reader)


def _print_inspections(seen: list[Inspection], notes: bool) -> None:
    from rich import box
    from rich.console import Console
    from rich.table import Table

    console = Console()
    table = Table("light", "who", "trial", "channels", "strides", "warnings", box=box.SIMPLE)
    for inspection in seen:
        light = LIGHTS[inspection.light]
        lines = [
            f"{side} {kept}" + (f" ({lost} dropped)" if lost else "")
            for side, (kept, lost) in inspection.strides.items()
        ]
        warnings = sum(finding.severity != "note" for finding in inspection.findings)
        table.add_row(
            f"[{light}]{inspection.light}[/]",
            inspection.participant,
            "\n".join(part for part in (inspection.condition, inspection.name) if part),
            "\n".join(f"{key} {words}" for key, words in inspection.streams.items()),
            "\n".join(lines),
            str(warnings or ""),
        )
    console.print(table)
    for inspection in seen:
        if inspection.refusal:
            console.print(f"refused: {inspection.name or inspection.participant}: {inspection.refusal}", markup=False)
        for line in inspection.grouped(notes):
            console.print(line, markup=False, highlight=False)


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
