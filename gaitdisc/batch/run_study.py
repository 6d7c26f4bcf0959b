"""Run a study: every participant, one after the other or side by side, kept as they come, taken up where it stopped."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import asdict
from functools import partial
from pathlib import Path

from gaitdisc.batch.participant_unit import ParticipantUnit, computed_unit, response_settings
from gaitdisc.batch.public_words import public_settings, public_title
from gaitdisc.batch.workers import StudyProgress, Workers, computed_units
from gaitdisc.ingest.study import Study
from gaitdisc.results.over_participants import OVER, TESTS, OverParticipants, PairTests
from gaitdisc.results.participant_response import QUANTITY, RESPONSE, DataQuantity, ParticipantResponse, ResponseRun
from gaitdisc.results.pooled_cycles import CYCLES, WALK
from gaitdisc.results.provenance import Provenance, Refusal, made_now
from gaitdisc.results.study_run import created_before, save_run
from gaitdisc.results.unit_folder import damaged_units
from gaitdisc.write_lock import write_lock

SECTION = "4.2, Eqs. 4.1-4.5"
POOLED = "none: cycles pooled over trials"


def run_study(
    study: Study,
    folder: Path,
    workers: Workers | None = None,
    progress: StudyProgress = lambda *_: None,
) -> ResponseRun:
    """Process every walk of a study; fit models to two walks of a participant, or pool cycles over many trials.

    A participant whose files, settings and package version are those of an earlier run in the same folder is loaded,
    not computed; so a run that was stopped goes on, and loses at most the participant it was at. What was changed since
    it was saved, in a table or in a JSON file, is not loaded but computed again, and said in `renewed`.

    workers: where participants are computed; in this process, one after the other, by default
    progress: called with a participant's pseudonym and the fraction of that participant's work that is done
    returns: also saved in the folder; refusals are part of it
    """
    with write_lock(folder, run=True):
        renewed = damaged_units(folder)
        compute = partial(computed_unit, study, folder=folder.absolute())
        people, where = study.participants, workers or Workers()
        units = list(computed_units(where, compute, people, progress, lambda one: ParticipantUnit(refusals=(one,))))
        responses = tuple(unit.response for unit in units if unit.response is not None)
        fitted = [(unit.response.participant, unit.key) for unit in units if unit.response is not None]
        stored = (QUANTITY.kept(folder / "quantities" / name, key) for name, key in fitted)
        quantities = tuple(quantity for quantity in stored if quantity is not None)
        tests, over = _compared(study, responses, quantities)
        run = ResponseRun(
            public_title(study),
            study.conditions.nominal,
            study.conditions.device or "",
            tuple(refusal for unit in units for refusal in unit.refusals),
            _provenance(study, units),
            {
                WALK.file: tuple(walk for unit in units for walk in unit.walks),
                RESPONSE.file: responses,
                TESTS.file: tests,
                QUANTITY.file: quantities,
                OVER.file: over,
                CYCLES.file: tuple(pooled for unit in units for pooled in unit.cycles),
            },
            tuple(Refusal(who.id, "", one.unfitted) for who, one in zip(people, units, strict=True) if one.unfitted),
            renewed,
        )
        run = created_before(run, folder)
        save_run(run, folder)
    return run


def _compared(
    study: Study, responses: tuple[ParticipantResponse, ...], quantities: tuple[DataQuantity, ...]
) -> tuple[tuple[PairTests, ...], tuple[OverParticipants, ...]]:
    """What the participants say together of the models; nothing where the study compares no device."""
    if study.conditions.device is None:
        return (), ()
    from gaitdisc.response.over_participants import compare_models, compare_participants

    return (compare_models(responses),), (compare_participants(responses, quantities, study.models.seed),)


def _provenance(study: Study, units: Sequence[ParticipantUnit]) -> Provenance:
    files = {name: sha for unit in units for walk in (*unit.walks, *unit.cycles) for name, sha in walk.files.items()}
    if study.conditions.device is None:
        return made_now(public_settings(study), study.models.seed, files, POOLED)
    settings = {**public_settings(study), "fits": asdict(response_settings(study))}
    return made_now(settings, study.models.seed, files, SECTION)
