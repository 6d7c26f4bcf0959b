"""`gaitdisc ablate`: the models on less and less data."""

from typing import Annotated

import typer

from gaitdisc.commands.options import Cluster, Jobs, Quiet, RunPlace, StudyPlace
from gaitdisc.commands.run_report import claim_run, report_on


def ablate(
    study: StudyPlace,
    out: RunPlace = None,
    length: Annotated[list[float] | None, typer.Option(help="Length of training data [s]; may be repeated.")] = None,
    part: Annotated[str, typer.Option(help="Part of the training data to use: first or last.")] = "first",
    jobs: Jobs = 1,
    cluster: Cluster = "",
    quiet: Quiet = False,
) -> None:
    """Fit the models to shorter and shorter training data, to find how much data they require."""
    from gaitdisc.response.vary import LENGTHS_S
    from gaitdisc.run.vary_study import ablate_study
    from gaitdisc.run.workers import Workers

    loaded, folder = claim_run(study, out)
    lengths, workers = tuple(length) if length else LENGTHS_S, Workers(jobs, cluster)
    report_on(lambda progress: ablate_study(loaded, folder, lengths, part, workers, progress), loaded, folder, quiet)
