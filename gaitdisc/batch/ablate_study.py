"""Add to a run what less training data would have given: how much is enough (section 4.2.4)."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace
from functools import partial
from pathlib import Path

from gaitdisc.batch.quantity_unit import computed_quantity
from gaitdisc.batch.run_study import run_study
from gaitdisc.batch.workers import StudyProgress, Workers, computed_units
from gaitdisc.ingest.study import Study
from gaitdisc.response.data_quantity import LENGTHS_S
from gaitdisc.response.over_participants import compare_participants
from gaitdisc.results import DataQuantity, Refusal, ResponseRun
from gaitdisc.results.run_store import save_run
from gaitdisc.write_lock import write_lock


def ablate_study(
    study: Study,
    folder: Path,
    lengths_s: Sequence[float] = LENGTHS_S,
    part: str = "first",
    workers: Workers | None = None,
    progress: StudyProgress = lambda *_: None,
) -> ResponseRun:
    """Fit every participant's models to less and less data; the run itself is made first where it is not there.

    lengths_s: lengths of the training part [s]; its whole length is always added
    workers: where participants are computed; in this process, one after the other, by default
    progress: called with a participant's pseudonym and the fraction of that participant's work that is done
    returns: with `quantities`; whoever had to be refused is in `refusals`
    """
    workers = workers or Workers()
    run = run_study(study, folder, workers)
    with write_lock(folder, run=True):
        people = [study.participant(response.participant) for response in run.responses]
        compute = partial(computed_quantity, study, folder=folder.absolute(), lengths_s=lengths_s, part=part)
        found = list(computed_units(workers, compute, people, progress, lambda refusal: refusal))
        quantities = tuple(each for each in found if isinstance(each, DataQuantity))
        run = replace(
            run,
            quantities=quantities,
            refusals=(*run.refusals, *(each for each in found if isinstance(each, Refusal))),
            over=compare_participants(run.responses, quantities, study.models.seed),
        )
        save_run(run, folder)
    return run
