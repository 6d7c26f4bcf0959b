"""`gaitdisc demo --clinic`: a made week of a clinic, from recordings to pages that find what was planted."""

from __future__ import annotations

from pathlib import Path

import typer


def clinic_demo(folder: Path, jobs: int, quiet: bool) -> None:
    """Make controls and a week, the reference, and the pages of the week."""
    from gaitdisc.batch.clinic_demonstration import write_week
    from gaitdisc.batch.run_study import run_study
    from gaitdisc.batch.workers import Workers
    from gaitdisc.clinic.reference import reference_of
    from gaitdisc.commands.clinic_pages import keep_reference, write_people
    from gaitdisc.own_files import claim_folder
    from gaitdisc.results.clinical_reference import save_reference
    from gaitdisc.results.run_store import claim_run

    claim_folder(folder, "planted.json", "reference", "controls", "controls/study.toml", "week", "week/study.toml")
    for part in ("controls", "week"):
        claim_run(folder / part / "run")
    typer.echo("20 controls and a week of 8 people, one of them a child, walk 16 s each: simulated, no people.")
    controls, week, planted = write_week(folder, progress=lambda who: typer.echo(f"  {who}", err=True, nl=not quiet))
    workers = Workers(jobs)
    own = run_study(controls, controls.folder / "run", workers)
    save_reference(reference_of(own.cycles, own.title, own.provenance), folder / "reference")
    run_folder = week.folder / "run"
    keep_reference(folder / "reference", run_folder)
    index = write_people(run_study(week, run_folder, workers), run_folder)
    for who, what in planted.items():
        typer.echo(f"  {who}: {what or 'nothing planted'}")
    typer.echo(f"people: {index}")
