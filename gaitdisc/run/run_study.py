"""Run a study: every participant computed, kept on disk as soon as whole, and taken up where it stopped."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import asdict, dataclass, replace
from functools import partial
from pathlib import Path
from typing import TYPE_CHECKING

from gaitdisc.errors import GaitdiscError, ReadError
from gaitdisc.ingest.study import Participant, Study
from gaitdisc.ingest.trial_sets import not_compared, why_refused
from gaitdisc.models.training_settings import TrainingSettings
from gaitdisc.processing.pooled_cycles import CYCLES, WALK, PooledCycles, WalkSummary
from gaitdisc.processing.processed_walks import compute_cycles, cycles_key, response_key, unit_keys, walks_and_errors
from gaitdisc.response.participant_response import QUANTITY, RESPONSE, ParticipantResponse, ResponseRun
from gaitdisc.response.participants_result import OVER, TESTS
from gaitdisc.run.workers import StudyProgress, Workers, compute_units
from gaitdisc.saved.kind import Kind
from gaitdisc.saved.provenance import Refusal, provenance_now
from gaitdisc.saved.study_run import keep_creation, save_run
from gaitdisc.saved.unit_folder import damage_lines, unit_name
from gaitdisc.write_lock import write_lock

if TYPE_CHECKING:
    from gaitdisc.processing.process import Walk
    from gaitdisc.response.fit_response import ResponseSettings

Progress = Callable[[float], None]
SHARE_OF_PROCESSING = 0.1  # of a participant's work
SECTION = "4.2, Eqs. 4.1-4.5"
POOLED = "none: cycles pooled over trials"


@dataclass(frozen=True)
class Refused:
    """Why a participant was refused: a run that goes on does not read and process the walks again."""

    refusals: tuple[Refusal, ...]
    walks: tuple[str, ...]  # conditions whose walk was processed


REFUSED = Kind(Refused, "refused.json", ("refusals", "walks"))


@dataclass(frozen=True, eq=False)
class ParticipantUnit:
    """What a run has of one participant."""

    walks: tuple[WalkSummary, ...] = ()
    response: ParticipantResponse | None = None  # none where a walk or the fit was refused
    refusals: tuple[Refusal, ...] = ()  # why, in the words of the error
    key: str = ""  # what the unit rests on, of `response_key`; empty where nothing was read
    cycles: tuple[PooledCycles, ...] = ()  # where cycles are pooled over trials: each session and condition
    # why no models were fitted, where the study compares a device and cycles are pooled instead; or empty
    unfitted: str = ""


def compute_unit(study: Study, participant: Participant, folder: Path, progress: Progress) -> ParticipantUnit:
    """Compute one participant, or load what an earlier run computed from the same files and settings.

    What is given back was loaded in either case, so that a run that went on has the numbers of one never stopped,
    to the last bit, and arrays stay on disk. A refusal stops this participant and nobody else.
    """
    refused = why_refused(study, participant)
    if refused:
        return ParticipantUnit(refusals=(Refusal(participant.id, "", refused),))
    lacking = not_compared(study, participant)
    if lacking:
        return pool_unit(study, participant, folder, lacking)
    unit = _compare_unit(study, participant, folder, progress)
    if unit.response is None and any(refusal.condition for refusal in unit.refusals):
        from gaitdisc.processing.pooled import can_pool

        pooled = pool_unit(study, participant, folder, unit.refusals[0].reason)
        if can_pool(pooled.cycles):
            return pooled
    return unit


def pool_unit(study: Study, participant: Participant, folder: Path, unfitted: str) -> ParticipantUnit:
    """Pool the cycles of one participant over trials, or load what an earlier run pooled."""
    cycles = compute_cycles(study, participant, folder)
    refusals = tuple(refusal for pooled in cycles for refusal in pooled.refusals)
    why = unfitted if study.conditions.device is not None else ""
    return ParticipantUnit((), None, refusals, cycles_key(study, participant), cycles, why)


def _compare_unit(study: Study, participant: Participant, folder: Path, progress: Progress) -> ParticipantUnit:
    keys = unit_keys(study, participant)
    stored = _find_stored(participant, keys, folder)
    if stored is not None:
        return stored
    walks, errors = walks_and_errors(study, participant)
    for word, walk in walks.items():
        WALK.save(walk.summary(), _walk_folder(folder, participant, word), keys[word])
    if not errors:
        progress(SHARE_OF_PROCESSING)
        try:
            rest = 1 - SHARE_OF_PROCESSING
            response = _fitted(study, participant, walks, lambda share: progress(SHARE_OF_PROCESSING + rest * share))
        except GaitdiscError as error:
            errors[""] = error
        else:
            RESPONSE.save(response, folder / "responses" / participant.id, response_key(keys))
            return _find_stored(participant, keys, folder) or ParticipantUnit(
                _load(walks, participant, folder), response
            )
    refusals = tuple(Refusal(participant.id, word, str(error)) for word, error in errors.items())
    if not any(isinstance(error, ReadError) for error in errors.values()):  # that may be readable another time
        REFUSED.save(Refused(refusals, tuple(walks)), folder / "refused" / participant.id, response_key(keys))
    return ParticipantUnit(_load(walks, participant, folder), None, refusals, response_key(keys))


def response_settings(study: Study) -> ResponseSettings:
    """Settings of the fits that a study states; what it does not say is the package's default."""
    from gaitdisc.response.fit_response import ResponseSettings

    training = TrainingSettings(seed=study.models.seed)
    return ResponseSettings(study.models.outputs, study.held_out.seconds, study.held_out.share or 0.0, training)


def _fitted(
    study: Study, participant: Participant, walks: Mapping[str, Walk], progress: Progress
) -> ParticipantResponse:
    from gaitdisc.processing.process import make_filter_null
    from gaitdisc.response.fit_response import fit_response

    nominal, exo = (walks[word] for word in study.conditions.both)
    settings = response_settings(study)
    null = make_filter_null(exo, study.filters)
    response = fit_response(nominal.trajectory, exo.trajectory, settings, null, progress, banded=True)
    return replace(response, participant=participant.id)


def _find_stored(participant: Participant, keys: Mapping[str, str], folder: Path) -> ParticipantUnit | None:
    """Whole unit of an earlier run, if all of it rests on the same files and settings."""
    key = response_key(keys)
    refused = REFUSED.kept(folder / "refused" / participant.id, key)
    response = None if refused else RESPONSE.kept(folder / "responses" / participant.id, key)
    if refused is None and response is None:
        return None
    words = refused.walks if refused else tuple(keys)
    walks = [WALK.kept(_walk_folder(folder, participant, word), keys[word]) for word in words if word in keys]
    stored = tuple(walk for walk in walks if walk is not None)
    if len(stored) < len(words):
        return None
    return ParticipantUnit(stored, response, refused.refusals if refused else (), key)


def _load(walks: Mapping[str, Walk], participant: Participant, folder: Path) -> tuple[WalkSummary, ...]:
    return tuple(WALK.load(_walk_folder(folder, participant, word)) for word in walks)


def _walk_folder(folder: Path, participant: Participant, word: str) -> Path:
    return folder / "walks" / unit_name(participant.id, word)


def run_study(
    study: Study, folder: Path, workers: Workers | None = None, progress: StudyProgress = lambda *_: None
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
        renewed = damage_lines(folder)
        compute = partial(compute_unit, study, folder=folder.absolute())
        people, where = study.participants, workers or Workers()
        units = list(compute_units(where, compute, people, progress, lambda r: ParticipantUnit(refusals=(r,))))
        responses = tuple(unit.response for unit in units if unit.response is not None)
        fitted = [(unit.response.participant, unit.key) for unit in units if unit.response is not None]
        stored = (QUANTITY.kept(folder / "quantities" / name, key) for name, key in fitted)
        quantities = tuple(quantity for quantity in stored if quantity is not None)
        settings, tests, over = study.public_settings(), (), ()
        if study.conditions.device is not None:
            from gaitdisc.response.over_participants import compare_models, compare_participants

            settings |= {"fits": asdict(response_settings(study))}
            tests = (compare_models(responses),)
            over = (compare_participants(responses, quantities, study.models.seed),)
        files = {name: sha for u in units for walk in (*u.walks, *u.cycles) for name, sha in walk.files.items()}
        run = ResponseRun(
            title=study.public_title,
            nominal=study.conditions.nominal,
            exo=study.conditions.device or "",
            refusals=tuple(refusal for unit in units for refusal in unit.refusals),
            provenance=provenance_now(settings, study.models.seed, files, SECTION if tests else POOLED),
            units={
                WALK.file: tuple(walk for unit in units for walk in unit.walks),
                RESPONSE.file: responses,
                TESTS.file: tests,
                QUANTITY.file: quantities,
                OVER.file: over,
                CYCLES.file: tuple(pooled for unit in units for pooled in unit.cycles),
            },
            unfitted=tuple(
                Refusal(who.id, "", unit.unfitted) for who, unit in zip(people, units, strict=True) if unit.unfitted
            ),
            renewed=renewed,
        )
        run = keep_creation(run, folder)
        save_run(run, folder)
    return run
