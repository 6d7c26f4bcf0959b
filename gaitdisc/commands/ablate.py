"""`gaitdisc ablate`: the models on less and less data."""

from __future__ import annotations

from typing import Annotated

import typer

from gaitdisc.commands.options import Cluster, Jobs, Quiet, RunPlace, StudyPlace
from gaitdisc.commands.run_report import report_on


def ablate(
    study: StudyPlace,
    out: RunPlace = None,
    length: Annotated[list[float] | None, typer.Option(help="Training length [s]; may be repeated.")] = None,
    part: Annotated[str, typer.Option(help="Seconds of the training part that are taken: first or last.")] = "first",
    jobs: Jobs = 1,
    cluster: Cluster = "",
    quiet: Quiet = False,
) -> None:
    """Fit the models to less and less data: how much is enough."""
    from gaitdisc.batch.ablate_study import ablate_study
    from gaitdisc.batch.workers import Workers
    from gaitdisc.ingest.study_file import load_study
    from gaitdisc.response.data_quantity import LENGTHS_S
    from gaitdisc.results.run_store import claim_run

    loaded = load_study(study)
    folder, lengths = out or loaded.folder / "run", tuple(length) if length else LENGTHS_S
    claim_run(folder)
    report_on(
        lambda progress: ablate_study(loaded, folder, lengths, part, Workers(jobs, cluster), progress),
        loaded,
        folder,
        quiet,
    )
