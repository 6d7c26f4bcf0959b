"""`gaitdisc run`: process, fit, test and report."""

from pathlib import Path
from typing import Annotated

import typer

from gaitdisc.commands.options import Cluster, Jobs, Quiet, RunPlace, StudyPlace
from gaitdisc.commands.run_report import claim_run, report_on


def run(
    study: StudyPlace,
    out: RunPlace = None,
    participant: Annotated[list[str] | None, typer.Option(help="Use only this participant; may be repeated.")] = None,
    jobs: Jobs = 1,
    cluster: Cluster = "",
    reference: Annotated[Path | None, typer.Option(help="Folder from `gaitdisc reference`: bands and scores.")] = None,
    quiet: Quiet = False,
) -> None:
    """Process, fit, test and report; finished parts of an earlier run are kept."""
    from gaitdisc.clinic.run_pages import keep_reference
    from gaitdisc.run.run_study import run_study
    from gaitdisc.run.workers import Workers

    loaded, folder = claim_run(study, out)
    if participant:
        chosen = tuple(loaded.participant(name) for name in participant)
        loaded = loaded.model_copy(update={"participants": chosen})
    keep_reference(reference, folder)
    report_on(lambda progress: run_study(loaded, folder, Workers(jobs, cluster), progress), loaded, folder, quiet)
