"""A participant's walks and the cycles of all trials, kept on disk under a hash of files, settings and code."""

from __future__ import annotations

import hashlib
import json
from collections.abc import Mapping
from dataclasses import replace
from functools import partial
from pathlib import Path
from typing import TYPE_CHECKING

from gaitdisc.errors import GaitdiscError, ReadError
from gaitdisc.ingest.c3d import C3DReader
from gaitdisc.ingest.public_words import PublicWords, list_words, of_trial
from gaitdisc.ingest.reading import read_planned_trial
from gaitdisc.ingest.study import FUNCTIONAL, STATIC, Participant, PlannedTrial, Study
from gaitdisc.ingest.trial_sets import calibration_trial, not_compared, trial_sets
from gaitdisc.processing.pooled_cycles import CYCLES, PooledCycles, cycles_name
from gaitdisc.recording import Trial
from gaitdisc.regular_file import file_sha256
from gaitdisc.saved.provenance import Refusal, code_sha256

if TYPE_CHECKING:
    from gaitdisc.processing.process import Walk


def unit_keys(study: Study, participant: Participant) -> dict[str, str]:
    """Key of each of the two walks of a complete participant, by condition."""
    keys = {}
    for word in study.conditions.both:
        trial = participant.trials_of(word)[0]
        beside = (calibration_trial(study, participant, trial.session or "", kind) for kind in (STATIC, FUNCTIONAL))
        texts = [person_key(study, participant), *(unit_key(study, planned) for planned in (trial, *beside) if planned)]
        keys[word] = hashlib.sha256("\n".join(texts).encode()).hexdigest()
    return keys


def person_key(study: Study, participant: Participant) -> str:
    """What the study says of a person's body, and the bytes of its marker-set file."""
    body = f"{participant.mass_kg} {participant.height_m} {participant.sex} {participant.age_years}"
    named = study.kinematics.marker_set if study.kinematics else ""
    has_file = named.endswith(".toml") and study.path_of(named).is_file()
    return f"{body} {file_sha256(study.path_of(named))}" if has_file else body


def response_key(keys: Mapping[str, str]) -> str:
    """Key of what is fitted to both walks."""
    return hashlib.sha256("".join(keys.values()).encode()).hexdigest()


def unit_key(study: Study, trial: PlannedTrial) -> str:
    """Hash of all that decides a walk's numbers: bytes of its files, settings, and the package's own code."""
    settings = study.model_dump(mode="json", exclude={"participants", "title"})
    texts = [code_sha256(), json.dumps(settings, sort_keys=True), trial.model_dump_json(exclude={"files"})]
    for file in trial.files:
        try:
            texts.append(file_sha256(study.path_of(file)))
        except OSError as error:
            texts.append(f"{file}: {error.strerror}")
    return hashlib.sha256("\n".join(texts).encode()).hexdigest()


def process_walks(study: Study, participant: Participant) -> tuple[dict[str, Walk], tuple[Refusal, ...]]:
    """Both walks of a participant by condition, and why one could not be had, in public words; it needs one of each."""
    if lacking := not_compared(study, participant):
        return {}, (Refusal(participant.id, "", lacking),)
    walks, errors = walks_and_errors(study, participant)
    return walks, tuple(Refusal(participant.id, word, str(error)) for word, error in errors.items())


def walks_and_errors(study: Study, participant: Participant) -> tuple[dict[str, Walk], dict[str, GaitdiscError]]:
    """Both walks of a complete participant, by condition, and the error of one that could not be, in public words."""
    from gaitdisc.processing.process import StudyWalks  # brings scipy.signal, which a second run does not need
    from gaitdisc.processing.samples import gait_samples

    walks, errors = {}, {}
    words = list_words(study, participant)
    with C3DReader() as reader:  # starts its process at the first C3D file, one for both walks
        study_walks = StudyWalks(study, participant, partial(public_trial, study, participant, words, reader))
        for word in study.conditions.both:
            planned = participant.trials_of(word)[0]
            public = of_trial(words, participant, planned)
            try:
                walk = study_walks.read_walk(planned).processed(study)
                left_away = gait_samples(walk.trajectory, study.models.outputs)[1]
            except GaitdiscError as error:
                errors[word] = public.error(error)
            else:
                walks[word] = replace(walk, findings=tuple(map(public.finding, (*walk.findings, left_away))))
    return walks, errors


def public_trial(
    study: Study, participant: Participant, words: PublicWords, reader: C3DReader, planned: PlannedTrial
) -> Trial:
    """Trial of a study, read, whose files and findings are called by public words alone."""
    public = of_trial(words, participant, planned)
    return public.of(lambda: public.trial(read_planned_trial(study, participant, planned, reader)))


def compute_cycles(study: Study, participant: Participant, folder: Path) -> tuple[PooledCycles, ...]:
    """Pooled cycles of a participant, computed, or loaded where an earlier run had the same files and settings."""
    key = cycles_key(study, participant)
    places = [
        folder / "cycles" / cycles_name(participant.id, trial_set.session, trial_set.condition)
        for trial_set in trial_sets(study, participant)
    ]
    stored = tuple(pooled for pooled in (CYCLES.kept(place, key) for place in places) if pooled is not None)
    if len(stored) == len(places):
        return stored
    cycles, unread = pool_public(study, participant)
    for pooled, place in zip(cycles, places, strict=True):  # unread files may be readable another time
        CYCLES.save(pooled, place, "" if unread else key)
    return tuple(CYCLES.load(place) for place in places)


def pool_public(study: Study, participant: Participant) -> tuple[list[PooledCycles], bool]:
    """Pooled cycles of a participant in public words, and whether a file could not be read."""
    from gaitdisc.processing.pooled import pool_cycles  # brings scipy.signal

    words = list_words(study, participant)
    unread: list[ReadError] = []
    with C3DReader() as reader:  # one process for all trials

        def read(planned: PlannedTrial) -> Trial:
            try:
                return public_trial(study, participant, words, reader, planned)
            except ReadError as error:
                unread.append(error)
                raise

        cycles = [
            replace(  # no word of the recordings stands in a sentence
                pooled,
                findings=tuple(map(words.finding, pooled.findings)),
                refusals=tuple(replace(refusal, reason=words.said(refusal.reason)) for refusal in pooled.refusals),
            )
            for pooled in pool_cycles(study, participant, read)
        ]
    return cycles, bool(unread)


def cycles_key(study: Study, participant: Participant) -> str:
    """Hash of all that decides a participant's pooled cycles: files, settings, and the package's own code."""
    texts = [participant.id, participant.group, person_key(study, participant)]
    for trial_set in trial_sets(study, participant):
        beside = (calibration_trial(study, participant, trial_set.session, kind) for kind in (STATIC, FUNCTIONAL))
        trials = (*trial_set.trials, *(trial for trial in beside if trial))
        texts += [trial_set.session, trial_set.condition, *(unit_key(study, trial) for trial in trials)]
    return hashlib.sha256("\n".join(texts).encode()).hexdigest()
