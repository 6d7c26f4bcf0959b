"""Add to a run what less training data would have given: how much is enough (section 4.2.4)."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace
from functools import partial
from pathlib import Path

from gaitdisc.batch.quantity_unit import computed_quantity
from gaitdisc.batch.run_lock import run_lock
from gaitdisc.batch.run_study import Told, run_study
from gaitdisc.ingest.study import Study
from gaitdisc.response.data_quantity import LENGTHS_S
from gaitdisc.results import DataQuantity, Refusal, ResponseRun
from gaitdisc.results.store import save_run


def ablate_study(
    study: Study,
    folder: Path,
    lengths_s: Sequence[float] = LENGTHS_S,
    part: str = "first",
    told: Told = lambda *_: None,
) -> ResponseRun:
    """Fit every participant's models to less and less data; the run itself is made first where it is not there.

    Parameters
    ----------
    study : Study
        Who, which files, which settings.
    folder : Path
        Folder of the run.
    lengths_s : sequence of float
        Lengths of the training part [s]; its whole length is always added.
    part : str
        `first` or `last` seconds of the training part.
    told : callable
        Called with a participant's pseudonym and the fraction of that participant's work that is done.

    Returns
    -------
    ResponseRun
        With `quantities`; whoever had to be refused is in `refusals`.

    Raises
    ------
    WriteError
        If another run works in the folder, or it cannot be written.
    """
    run = run_study(study, folder)
    with run_lock(folder):
        found = []
        for response in run.responses:
            person = study.participant(response.participant)
            found.append(computed_quantity(study, person, folder, lengths_s, part, partial(told, person.id)))
            told(person.id, 1.0)
        run = replace(
            run,
            quantities=tuple(each for each in found if isinstance(each, DataQuantity)),
            refusals=(*run.refusals, *(each for each in found if isinstance(each, Refusal))),
        )
        save_run(run, folder)
    return run
