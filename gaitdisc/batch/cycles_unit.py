"""Cycles of one participant, pooled over trials and kept on disk; taken from there where nothing has changed."""

from __future__ import annotations

import hashlib
from dataclasses import replace
from pathlib import Path

from gaitdisc.batch.public_words import PublicWords, of_trial, words_of
from gaitdisc.batch.unit_key import unit_key
from gaitdisc.errors import ReadError, SchemaError
from gaitdisc.ingest.c3d import C3DReader
from gaitdisc.ingest.file_hash import file_sha256
from gaitdisc.ingest.reading import read_planned_trial
from gaitdisc.ingest.study import Participant, PlannedTrial, Study
from gaitdisc.ingest.trial_sets import static_trial, trial_sets
from gaitdisc.recording import Trial
from gaitdisc.results import PooledCycles
from gaitdisc.results.cycles_store import cycles_name, load_cycles, save_cycles


def computed_cycles(study: Study, participant: Participant, folder: Path) -> tuple[PooledCycles, ...]:
    """Pooled cycles of a participant, computed, or loaded where an earlier run had the same files and settings."""
    key = cycles_key(study, participant)
    places = [
        folder / "cycles" / cycles_name(participant.id, one.session, one.condition)
        for one in trial_sets(study, participant)
    ]
    stored = _stored(places, key)
    if stored is not None:
        return stored
    from gaitdisc.processing.pooled import pooled_cycles  # brings scipy.signal, which a second run does not need

    words = words_of(study, participant)
    unread: list[ReadError] = []
    with C3DReader() as reader:  # one process for all trials

        def read(planned: PlannedTrial) -> Trial:
            public = of_trial(words, participant, planned)
            try:
                return public.of(lambda: public.trial(read_planned_trial(study, participant, planned, reader)))
            except ReadError as error:
                unread.append(error)
                raise

        found = tuple(_public(pooled, words) for pooled in pooled_cycles(study, participant, read))
    if unread:  # they may be readable another time, so that this stands for no key
        key = ""
    for pooled, place in zip(found, places, strict=True):
        save_cycles(pooled, place, key)
    return tuple(load_cycles(place).result for place in places)


def cycles_key(study: Study, participant: Participant) -> str:
    """Hash of all that decides a participant's pooled cycles: files, settings, and the package's own code."""
    parts = [participant.id, participant.group, f"{participant.mass_kg} {participant.height_m} {participant.sex}"]
    named = study.kinematics.marker_set if study.kinematics else ""
    if named.endswith(".toml") and study.path_of(named).is_file():
        parts.append(file_sha256(study.path_of(named)))
    for one in trial_sets(study, participant):
        standing = static_trial(study, participant, one.session)
        trials = (*one.trials, *((standing,) if standing else ()))
        parts += [one.session, one.condition, *(unit_key(study, trial) for trial in trials)]
    return hashlib.sha256("\n".join(parts).encode()).hexdigest()


def _public(pooled: PooledCycles, words: PublicWords) -> PooledCycles:
    """Same cycles, in whose sentences no word of the recordings stands."""
    return replace(
        pooled,
        findings=tuple(map(words.finding, pooled.findings)),
        refusals=tuple(replace(refusal, reason=words.said(refusal.reason)) for refusal in pooled.refusals),
    )


def _stored(places: list[Path], key: str) -> tuple[PooledCycles, ...] | None:
    try:
        found = [load_cycles(place) for place in places]
    except SchemaError:
        return None
    return tuple(pooled for pooled, _ in found) if all(stored == key for _, stored in found) else None
