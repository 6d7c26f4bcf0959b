"""Work on a run with its progress shown, then its page, then who was refused."""

from __future__ import annotations

import os
import time
from collections.abc import Callable, Iterator, Sequence
from contextlib import contextmanager
from pathlib import Path
from typing import TYPE_CHECKING, TypeVar

import typer

from gaitdisc.commands.options import REFUSED, SOME_REFUSED, STOPPED
from gaitdisc.errors import LOG

if TYPE_CHECKING:
    from rich.progress import Progress

    from gaitdisc.ingest.study import Study
    from gaitdisc.response.participant_response import ResponseRun
    from gaitdisc.run.workers import StudyProgress
    from gaitdisc.saved.provenance import Refusal

Result = TypeVar("Result")


def claim_run(place: Path, out: Path | None) -> tuple[Study, Path]:
    """A study and the folder of its run, which is held until the command ends."""
    from gaitdisc.ingest.study_file import load_study
    from gaitdisc.saved.study_run import claim_run

    study = load_study(place)
    folder = out or study.folder / "run"
    claim_run(folder)
    return study, folder


def report_on(work: Callable[[StudyProgress], ResponseRun], study: Study, folder: Path, quiet: bool) -> None:
    """Do the work with its progress shown, draw the report, and say who was refused."""
    from gaitdisc.clinic.run_pages import page_of_run

    started = time.perf_counter()
    done = work_with_bar(work, [person.id for person in study.participants], quiet)
    say_renewed(done.renewed)
    say_new_recordings(study)
    page = page_of_run(done, folder)
    if done.responses:
        from rich.console import Console

        from gaitdisc.response.sentences import r2_text

        Console().print(r2_text(done))
    for quantity in done.quantities:
        for length_s, reason in quantity.left_away.items():
            LOG.info(f"{quantity.participant}, training length {length_s:g} s, is left out: {reason}")
    if done.cycles:
        typer.echo(f"people: {folder / 'report' / 'index.html'}")
    end(done.refusals, len(done.reported), page, time.perf_counter() - started)


def vary(place: Path, out: Path | None, question: str, jobs: int, cluster: str, quiet: bool) -> None:
    """Answer a question beside the study with the progress shown, and write its page."""
    from gaitdisc.own_files import claim_file
    from gaitdisc.response.variants_page import variant_sentences, write_variants
    from gaitdisc.run.vary_study import vary_study
    from gaitdisc.run.workers import Workers

    study, folder = claim_run(place, out)
    started, side_by_side = time.perf_counter(), Workers(jobs, cluster)
    claim_file(folder / question / "report.html")
    people = [person.id for person in study.participants]
    done = work_with_bar(lambda progress: vary_study(study, folder, question, side_by_side, progress), people, quiet)
    say_renewed(done.renewed)
    page = write_variants(done, folder / question)
    for sentence in variant_sentences(done):
        typer.echo(sentence)
    end(done.refusals, len(done.people), page, time.perf_counter() - started)


def say_renewed(renewed: Sequence[str]) -> None:
    """Say which files of an earlier run were not used."""
    for line in renewed:
        LOG.info(f"{line}; computed again")


def work_with_bar(work: Callable[[StudyProgress], Result], people: list[str], quiet: bool) -> Result:
    """Do the work, with a bar that counts participants unless it shall be quiet."""
    shares = dict.fromkeys(people, 0.0)
    with stoppable_bar(quiet) as bar:
        task = bar.add_task("participants", total=len(shares))

        def progress(participant: str, share: float) -> None:
            shares[participant] = share
            bar.update(task, completed=sum(shares.values()), description=f"{participant} of {len(shares)} participants")

        return work(progress)


@contextmanager
def stoppable(again: str = "the same command") -> Iterator[None]:
    """Whoever stops the work reads that nothing is lost."""
    try:
        yield
    except KeyboardInterrupt as stop:
        LOG.info(" ".join(["Stopped.", *stop.args, f"Finished parts are kept; {again} continues from there."]))
        raise typer.Exit(STOPPED) from None


@contextmanager
def stoppable_bar(quiet: bool) -> Iterator[Progress]:
    """Bar of work whose finished parts are kept."""
    with stoppable(), progress_bar(quiet) as bar:
        yield bar


@contextmanager
def progress_bar(quiet: bool) -> Iterator[Progress]:
    """Bar with the time that is left, where somebody looks on."""
    from rich.console import Console
    from rich.progress import BarColumn, Progress, TextColumn, TimeElapsedColumn, TimeRemainingColumn

    columns = (
        TextColumn("{task.description}", markup=False),
        BarColumn(),
        TimeElapsedColumn(),
        TextColumn("left", markup=False),
        TimeRemainingColumn(),
    )
    screen = Console(stderr=True)
    disable = quiet or not screen.is_terminal
    with Progress(*columns, console=screen, transient=True, disable=disable) as bar:
        yield bar


def end(refusals: Sequence[Refusal], count: int, page: Path, seconds: float) -> None:
    """Say who was refused, how many were done in how many seconds, and where the report is."""
    from gaitdisc.words import counted

    for refusal in refusals:
        who = " ".join(part for part in (refusal.participant, refusal.condition) if part)
        LOG.info(f"refused: {who}: {refusal.reason}")
    typer.echo(f"{counted(count, 'participant')} in {seconds:.0f} s. report: {page}")
    if refusals:
        raise typer.Exit(SOME_REFUSED if count else REFUSED)


def say_new_recordings(study: Study) -> None:
    """Say how many recordings beside those of the study it does not name, and of whom; their names stay away.

    Looked at is the folder that all recordings lie in, or, where that is the study's own, the folder of each.
    """
    from gaitdisc.ingest.people_table import is_people_table

    people = study.participants
    owners = {study.path_of(file).resolve(): person.id for person in people for t in person.trials for file in t.files}
    folders = {path.parent: who for path, who in owners.items()}
    above = Path(os.path.commonpath(folders)) if len(set(folders.values())) > 1 else Path()
    inside = above.parts[2:] and not study.folder.resolve().is_relative_to(above)
    endings = {path.suffix.lower() for path in owners}
    counts: dict[str, int] = {}
    paths = above.rglob("*") if inside else (path for folder in folders if folder.is_dir() for path in folder.iterdir())
    for path in paths:
        if path.suffix.lower() in endings and path.resolve() not in owners and not is_people_table(path):
            who = next((folders[folder] for folder in path.parents if folder in folders), "")
            beside = f"in the folder of {who}" if who else "in another folder"
            counts[beside] = counts.get(beside, 0) + 1
    new = ", ".join(f"{count} {beside}" for beside, count in sorted(counts.items()))
    if new:
        words = "New recordings are not in the study file: {}. Add them: gaitdisc watch STUDY --from RECORDINGS."
        typer.echo(words.format(new), err=True)
