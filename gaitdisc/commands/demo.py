"""`gaitdisc demo`: the whole job on the embedded cohort."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated

import typer

from gaitdisc.commands.exit_codes import SOME_REFUSED
from gaitdisc.commands.options import Jobs, Quiet
from gaitdisc.commands.run_report import report_on


def demo(  # noqa: PLR0913, PLR0917 these are the options of a command
    folder: Annotated[Path, typer.Argument(help="Folder to make.")] = Path("demo"),
    seconds: Annotated[float, typer.Option(min=30.0, help="Length of each walk; the dissertation's is 240.")] = 60.0,
    people: Annotated[int, typer.Option(min=1, max=12, help="How many of the twelve.")] = 12,
    hide: Annotated[
        str, typer.Option(help="What differs between the walks: spring, weak plantarflexor, stiff knee, drop foot, ...")
    ] = "spring",
    clinic: Annotated[bool, typer.Option("--clinic", help="A week of a clinic instead: people, pages, index.")] = False,
    laboratory: Annotated[
        str, typer.Option(help="What it gives: angles; markers and belts; or overground, short trials over two plates.")
    ] = "angles",
    jobs: Jobs = 2,
    quiet: Quiet = False,
) -> None:
    """Let the embedded cohort walk without and with an ankle spring, and do the whole job on its recordings."""
    if clinic:
        from gaitdisc.commands.clinic_demo import clinic_demo

        return clinic_demo(folder, jobs, quiet)
    from gaitdisc.batch.demonstration import write_demonstration
    from gaitdisc.batch.run_study import run_study
    from gaitdisc.batch.workers import Workers
    from gaitdisc.ingest.study_file import load_study
    from gaitdisc.own_files import claim_folder
    from gaitdisc.results.run_store import claim_run

    claim_folder(folder, "study.toml", "raw", "truth")
    claim_run(folder / "run")
    typer.echo(f"{people} of the embedded cohort walk {seconds:g} s in each condition: simulated, no people.")
    write_demonstration(
        folder, seconds, people, hide, lambda who, _: typer.echo(f"  {who}", err=True, nl=not quiet), laboratory
    )
    study = load_study(folder)
    try:
        run = folder / "run"
        report_on(lambda progress: run_study(study, run, Workers(jobs), progress), study, run, quiet)
    except typer.Exit as ended:
        if ended.exit_code != SOME_REFUSED:
            raise
        typer.echo(
            "Whoever changes the way of walking late in a trial is meant to be refused; that is the demonstration."
        )
