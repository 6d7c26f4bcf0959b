"""Work on a run with its progress shown, then its report, then who was refused."""

from __future__ import annotations

import time
from collections.abc import Callable, Sequence
from pathlib import Path
from typing import TYPE_CHECKING, TypeVar

import typer

from gaitdisc.commands.clinic_pages import page_of_run
from gaitdisc.commands.exit_codes import REFUSED, SOME_REFUSED, STOPPED

if TYPE_CHECKING:
    from gaitdisc.batch.workers import StudyProgress
    from gaitdisc.ingest.study import Study
    from gaitdisc.results import Refusal, ResponseRun

Result = TypeVar("Result")


def report_on(work: Callable[[StudyProgress], ResponseRun], study: Study, folder: Path, quiet: bool) -> None:
    """Do the work with its progress shown, draw the report, and say who was refused."""
    started = time.perf_counter()
    done = worked(work, [person.id for person in study.participants], quiet)
    say_renewed(done.renewed)
    page = page_of_run(done, folder)
    if done.responses:
        from rich.console import Console

        from gaitdisc.report.sentences import r2_text

        Console().print(r2_text(done))
    for quantity in done.quantities:
        for length_s, reason in quantity.left_away.items():
            typer.echo(f"left out: {quantity.participant}, training length {length_s:g} s: {reason}", err=True)
    if done.cycles:
        typer.echo(f"people: {folder / 'report' / 'index.html'}")
    end(done.refusals, len(done.reported), page, time.perf_counter() - started)


def say_renewed(renewed: Sequence[str]) -> None:
    """Say which files of an earlier run were not used."""
    for line in renewed:
        typer.echo(f"not used, computed again: {line}", err=True)


def worked(work: Callable[[StudyProgress], Result], people: list[str], quiet: bool) -> Result:
    """Do the work, with a bar that counts participants unless it shall be quiet."""
    try:
        return work(lambda *_: None) if quiet else with_progress(work, people)
    except KeyboardInterrupt:
        typer.echo("Stopped. What was finished is kept; the same command goes on from there.", err=True)
        raise typer.Exit(STOPPED) from None


def end(refusals: Sequence[Refusal], count: int, page: Path, seconds: float) -> None:
    """Say who was refused, how many were done and where the report is.

    Parameters
    ----------
    seconds : float
        That it took [s].
    """
    from gaitdisc.report.wording import counted

    for refusal in refusals:
        who = " ".join(part for part in (refusal.participant, refusal.condition) if part)
        typer.echo(f"refused: {who}: {refusal.reason}", err=True)
    typer.echo(f"{counted(count, 'participant')} in {seconds:.0f} s. report: {page}")
    if refusals:
        raise typer.Exit(SOME_REFUSED if count else REFUSED)


def with_progress(work: Callable[[StudyProgress], Result], people: list[str]) -> Result:
    """Do the work with a bar that counts participants."""
    from rich.console import Console
    from rich.progress import BarColumn, Progress, TextColumn, TimeElapsedColumn, TimeRemainingColumn

    elapsed, left = TimeElapsedColumn(), TimeRemainingColumn()
    columns = (
        TextColumn("{task.description}", markup=False),
        BarColumn(),
        elapsed,
        TextColumn("left", markup=False),
        left,
    )
    shares = dict.fromkeys(people, 0.0)
    with Progress(*columns, console=Console(stderr=True), transient=True) as bar:
        task = bar.add_task("participants", total=len(shares))

        def progress(participant: str, share: float) -> None:
            shares[participant] = share
            bar.update(task, completed=sum(shares.values()), description=f"{participant} of {len(shares)} participants")

        return work(progress)
