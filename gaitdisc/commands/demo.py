"""`gaitdisc demo`: the whole job on the embedded cohort."""

from pathlib import Path
from typing import Annotated

import typer

from gaitdisc.commands.options import SOME_REFUSED, Jobs, Quiet
from gaitdisc.commands.run_report import report_on
from gaitdisc.errors import LOG


def demo(  # noqa: PLR0913, PLR0917 these are the options of a command
    folder: Annotated[Path, typer.Argument(help="Folder to create.")] = Path("demo"),
    seconds: Annotated[float, typer.Option(min=30.0, help="Length of each walk [s]; dissertation: 240 s.")] = 60.0,
    people: Annotated[int, typer.Option(min=1, max=12, help="Number of participants, at most twelve.")] = 12,
    hide: Annotated[
        str, typer.Option(help="Difference between the walks, such as spring, weak plantarflexor or stiff knee.")
    ] = "spring",
    clinic: Annotated[
        bool, typer.Option("--clinic", help="Simulate a week of a clinic instead, with a page for each person.")
    ] = False,
    laboratory: Annotated[
        str, typer.Option(help="Data of each walk: `angles`, `markers` (two belts), `overground` (short; two plates).")
    ] = "angles",
    jobs: Jobs = 2,
    quiet: Quiet = False,
) -> None:
    """Simulate walks of the embedded cohort without and with an ankle spring, and run the complete analysis."""
    LOG.setLevel("WARNING" if quiet else "INFO")
    if clinic:
        return _clinic(folder, jobs)
    from gaitdisc.cohort.demonstration import write_demonstration
    from gaitdisc.ingest.study_file import load_study
    from gaitdisc.own_files import claim_folder
    from gaitdisc.run.run_study import run_study
    from gaitdisc.run.workers import Workers
    from gaitdisc.saved.study_run import claim_run

    claim_folder(folder, "study.toml", "raw", "truth")
    claim_run(folder / "run")
    typer.echo(f"Data of the embedded cohort (simulated people, n = {people}), {seconds:g} s in each condition.")
    write_demonstration(folder, seconds, people, hide, lambda who, _: LOG.info(f"  {who}"), laboratory)
    study = load_study(folder)
    try:
        run = folder / "run"
        report_on(lambda progress: run_study(study, run, Workers(jobs), progress), study, run, quiet)
    except typer.Exit as ended:
        if ended.exit_code != SOME_REFUSED:
            raise
        typer.echo("A participant whose gait changes towards the end is refused on purpose, to show a refusal.")


def _clinic(folder: Path, jobs: int) -> None:
    """A made week of a clinic, from recordings to pages that find what was planted."""
    from gaitdisc.clinic.clinical_reference import save_reference
    from gaitdisc.clinic.demonstration import write_week
    from gaitdisc.clinic.reference import make_reference
    from gaitdisc.clinic.run_pages import keep_reference, write_people
    from gaitdisc.own_files import claim_folder
    from gaitdisc.run.run_study import run_study
    from gaitdisc.run.workers import Workers
    from gaitdisc.saved.study_run import claim_run

    studies = ("controls", "week")
    files = [f"{part}/study.toml" for part in studies]
    claim_folder(folder, "planted.json", "reference", *studies, *files, "week/clinic.toml")
    for part in studies:
        claim_run(folder / part / "run")
    typer.echo("Simulating 20 controls and 8 patients (one of them a child), 16 s each.")
    controls, week, planted = write_week(folder, progress=lambda who: LOG.info(f"  {who}"))
    workers = Workers(jobs)
    control_run = run_study(controls, controls.folder / "run", workers)
    save_reference(make_reference(control_run.cycles, control_run.title, control_run.provenance), folder / "reference")
    run_folder = week.folder / "run"
    keep_reference(folder / "reference", run_folder)
    index = write_people(run_study(week, run_folder, workers), run_folder)
    for who, what in planted.items():
        typer.echo(f"  {who}: {what or 'nothing planted'}")
    typer.echo(f"people: {index}")
