"""Cycles of one participant, pooled over trials and kept on disk; taken from there where nothing has changed."""

from __future__ import annotations

import hashlib
from dataclasses import replace
from pathlib import Path

from gaitdisc.batch.processed_walks import public_trial
from gaitdisc.batch.public_words import words_of
from gaitdisc.batch.unit_key import person_key, unit_key
from gaitdisc.errors import ReadError
from gaitdisc.ingest.c3d import C3DReader
from gaitdisc.ingest.study import Participant, PlannedTrial, Study
from gaitdisc.ingest.trial_sets import functional_trial, static_trial, trial_sets
from gaitdisc.recording import Trial
from gaitdisc.results.pooled_cycles import CYCLES, PooledCycles, cycles_name


def computed_cycles(study: Study, participant: Participant, folder: Path) -> tuple[PooledCycles, ...]:
    """Pooled cycles of a participant, computed, or loaded where an earlier run had the same files and settings."""
    key = cycles_key(study, participant)
    places = [
        folder / "cycles" / cycles_name(participant.id, one.session, one.condition)
        for one in trial_sets(study, participant)
    ]
    stored = tuple(one for one in (CYCLES.kept(place, key) for place in places) if one is not None)
    if len(stored) == len(places):
        return stored
    from gaitdisc.processing.pooled import pooled_cycles  # brings scipy.signal, which a second run does not need

    words = words_of(study, participant)
    unread: list[ReadError] = []
    with C3DReader() as reader:  # one process for all trials

        def read(planned: PlannedTrial) -> Trial:
            try:
                return public_trial(study, participant, words, reader, planned)
            except ReadError as error:
                unread.append(error)
                raise

        found = [
            replace(  # no word of the recordings stands in a sentence
                pooled,
                findings=tuple(map(words.finding, pooled.findings)),
                refusals=tuple(replace(refusal, reason=words.said(refusal.reason)) for refusal in pooled.refusals),
            )
            for pooled in pooled_cycles(study, participant, read)
        ]
    if unread:  # they may be readable another time, so that this stands for no key
        key = ""
    for pooled, place in zip(found, places, strict=True):
        CYCLES.save(pooled, place, key)
    return tuple(CYCLES.load(place) for place in places)


def cycles_key(study: Study, participant: Participant) -> str:
    """Hash of all that decides a participant's pooled cycles: files, settings, and the package's own code."""
    parts = [participant.id, participant.group, person_key(study, participant)]
    for one in trial_sets(study, participant):
        beside = (static_trial(study, participant, one.session), functional_trial(study, participant, one.session))
        trials = (*one.trials, *(trial for trial in beside if trial))
        parts += [one.session, one.condition, *(unit_key(study, trial) for trial in trials)]
    return hashlib.sha256("\n".join(parts).encode()).hexdigest()
