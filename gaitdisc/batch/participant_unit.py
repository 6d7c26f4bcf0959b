"""One participant: both walks processed, the models fitted, everything kept on disk as soon as it is whole."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass, replace
from functools import partial
from pathlib import Path
from typing import TYPE_CHECKING

from gaitdisc.batch.processed_walks import computed_cycles, cycles_key
from gaitdisc.batch.unit_key import response_key, unit_keys
from gaitdisc.errors import GaitdiscError, ReadError
from gaitdisc.ingest.study import Participant, Study
from gaitdisc.ingest.trial_sets import not_compared, refused_participant
from gaitdisc.networks.training_settings import TrainingSettings
from gaitdisc.processing.walk import Walk
from gaitdisc.results.kind import Kind
from gaitdisc.results.participant_response import RESPONSE, ParticipantResponse
from gaitdisc.results.pooled_cycles import WALK, PooledCycles, WalkSummary
from gaitdisc.results.provenance import Refusal
from gaitdisc.results.unit_folder import unit_name

if TYPE_CHECKING:
    from gaitdisc.response.fit_response import ResponseSettings

Progress = Callable[[float], None]
SHARE_OF_PROCESSING = 0.1


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


def computed_unit(study: Study, participant: Participant, folder: Path, progress: Progress) -> ParticipantUnit:
    """Compute one participant, or load what an earlier run computed from the same files and settings.

    What is given back was loaded from the folder in either case, so that arrays stay there until they are looked at,
    and a run that went on has the numbers of one that was never stopped, to the last bit.

    returns: a refusal is part of the result; it stops this participant and nobody else
    """
    refused = refused_participant(study, participant)
    if refused:
        return ParticipantUnit(refusals=(Refusal(participant.id, "", refused),))
    lacking = not_compared(study, participant)
    if lacking:
        return pooled_unit(study, participant, folder, lacking)
    unit = _compared_unit(study, participant, folder, progress)
    if unit.response is None and any(refusal.condition for refusal in unit.refusals):
        from gaitdisc.processing.pooled import pooled_instead

        pooled = pooled_unit(study, participant, folder, unit.refusals[0].reason)
        if pooled_instead(pooled.cycles):
            return pooled
    return unit


def pooled_unit(study: Study, participant: Participant, folder: Path, unfitted: str) -> ParticipantUnit:
    """Pool the cycles of one participant over trials, or load what an earlier run pooled."""
    cycles = computed_cycles(study, participant, folder)
    refusals = tuple(refusal for one in cycles for refusal in one.refusals)
    why = unfitted if study.conditions.device is not None else ""
    return ParticipantUnit((), None, refusals, cycles_key(study, participant), cycles, why)


def _compared_unit(study: Study, participant: Participant, folder: Path, progress: Progress) -> ParticipantUnit:
    keys = unit_keys(study, participant)
    stored = _stored(participant, keys, folder)
    if stored is not None:
        return stored
    from gaitdisc.batch.processed_walks import walks_and_errors  # brings scipy.signal, which a second run does not need

    walks, errors = walks_and_errors(study, participant)
    for word, walk in walks.items():
        WALK.save(walk.summary(), _walk_folder(folder, participant, word), keys[word])
    if not errors:
        progress(SHARE_OF_PROCESSING)
        try:
            response = _fitted(study, participant, walks, partial(_after_processing, progress))
        except GaitdiscError as error:
            errors[""] = error
        else:
            RESPONSE.save(response, folder / "responses" / participant.id, response_key(keys))
            return _stored(participant, keys, folder) or ParticipantUnit(_loaded(walks, participant, folder), response)
    refusals = tuple(Refusal(participant.id, word, str(error)) for word, error in errors.items())
    if not any(isinstance(error, ReadError) for error in errors.values()):  # that may be readable another time
        REFUSED.save(Refused(refusals, tuple(walks)), folder / "refused" / participant.id, response_key(keys))
    return ParticipantUnit(_loaded(walks, participant, folder), None, refusals, response_key(keys))


def response_settings(study: Study) -> ResponseSettings:
    """Settings of the fits that a study states; what it does not say is the package's default."""
    from gaitdisc.response.fit_response import ResponseSettings

    training = TrainingSettings(seed=study.models.seed)
    return ResponseSettings(study.models.outputs, study.held_out.seconds, study.held_out.share or 0.0, training)


def _after_processing(progress: Progress, share: float) -> None:
    progress(SHARE_OF_PROCESSING + (1 - SHARE_OF_PROCESSING) * share)


def _fitted(
    study: Study, participant: Participant, walks: Mapping[str, Walk], progress: Progress
) -> ParticipantResponse:
    from gaitdisc.processing.filter_null import filter_null_of
    from gaitdisc.response.fit_response import fit_response

    nominal, exo = (walks[word] for word in study.conditions.both)
    settings = response_settings(study)
    null = filter_null_of(exo, study.filters)
    response = fit_response(nominal.trajectory, exo.trajectory, settings, null, progress, banded=True)
    return replace(response, participant=participant.id)


def _stored(participant: Participant, keys: Mapping[str, str], folder: Path) -> ParticipantUnit | None:
    """Whole unit of an earlier run, if all of it rests on the same files and settings."""
    key = response_key(keys)
    refused = REFUSED.kept(folder / "refused" / participant.id, key)
    response = None if refused else RESPONSE.kept(folder / "responses" / participant.id, key)
    if refused is None and response is None:
        return None
    words = refused.walks if refused else tuple(keys)
    walks = [WALK.kept(_walk_folder(folder, participant, word), keys[word]) for word in words if word in keys]
    whole = tuple(walk for walk in walks if walk is not None)
    return (
        ParticipantUnit(whole, response, refused.refusals if refused else (), key) if len(whole) == len(words) else None
    )


def _loaded(walks: Mapping[str, Walk], participant: Participant, folder: Path) -> tuple[WalkSummary, ...]:
    return tuple(WALK.load(_walk_folder(folder, participant, word)) for word in walks)


def _walk_folder(folder: Path, participant: Participant, word: str) -> Path:
    return folder / "walks" / unit_name(participant.id, word)
