"""Add to a run what less training data would have given: how much is enough (section 4.2.4)."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import replace
from functools import partial
from pathlib import Path

from gaitdisc.batch.participant_unit import response_settings
from gaitdisc.batch.processed_walks import processed_walks
from gaitdisc.batch.run_study import run_study
from gaitdisc.batch.unit_key import response_key, unit_keys
from gaitdisc.batch.workers import StudyProgress, Workers, computed_units
from gaitdisc.errors import GaitdiscError
from gaitdisc.ingest.study import Participant, Study
from gaitdisc.response.data_quantity import LENGTHS_S, fit_data_quantity
from gaitdisc.response.over_participants import compare_participants
from gaitdisc.results.over_participants import OVER
from gaitdisc.results.participant_response import QUANTITY, RESPONSE, DataQuantity
from gaitdisc.results.provenance import Refusal
from gaitdisc.results.response_run import ResponseRun
from gaitdisc.results.study_run import save_run
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
            run.with_units(QUANTITY, quantities).with_units(
                OVER, (compare_participants(run.responses, quantities, study.models.seed),)
            ),
            refusals=(*run.refusals, *(each for each in found if isinstance(each, Refusal))),
        )
        save_run(run, folder)
    return run


def computed_quantity(
    study: Study,
    participant: Participant,
    folder: Path,
    lengths_s: Sequence[float],
    part: str,
    progress: Callable[[float], None],
) -> DataQuantity | Refusal:
    """Compute what less data gives one participant, or load what was computed from the same files and settings.

    lengths_s: lengths of the training part [s]
    """
    key = response_key(unit_keys(study, participant))
    place = folder / "quantities" / participant.id
    stored = QUANTITY.kept(place, key)
    if stored is not None and stored.part == part:
        there = {round(float(length), 6) for length in stored.table["length_s"]} | set(stored.left_away)
        if {round(length, 6) for length in lengths_s} <= there:
            return stored
    walks, refusals = processed_walks(study, participant)
    if refusals:
        return refusals[0]
    nominal, exo = (walks[word].trajectory for word in study.conditions.both)
    try:
        whole = RESPONSE.kept(folder / "responses" / participant.id, key)
        quantity = fit_data_quantity(nominal, exo, response_settings(study), lengths_s, part, progress, whole)
    except GaitdiscError as error:
        return Refusal(participant.id, "", str(error))
    QUANTITY.save(quantity, place, key)
    return QUANTITY.kept(place, key) or quantity
