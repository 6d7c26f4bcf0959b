"""Everybody of a run read beside a reference: a page for each person and session."""

from __future__ import annotations

import itertools
from collections.abc import Callable, Iterator, Sequence

from gaitdisc.clinic.reading import contrast_of, read_beside
from gaitdisc.errors import GaitdiscError, SchemaError
from gaitdisc.results.clinical_reference import ClinicalReading, ClinicalReference, Contrast, PersonSession
from gaitdisc.results.pooled_cycles import CYCLES, PooledCycles
from gaitdisc.results.study_run import StudyRun

Sessions = dict[tuple[str, str], tuple[ClinicalReading, ...]]


def readings_of(run: StudyRun, reference: ClinicalReference | None) -> Sessions:
    """Readings by person and session, the study's first condition before the others."""
    return {key: _readings(own, run, reference) for key, own in _by_session(run).items()}


def people_of(run: StudyRun) -> list[str]:
    """Title of every person and session, in the order of the study."""
    return [_title(*key) for key in _by_session(run)]


def sessions_of(
    run: StudyRun,
    reference: ClinicalReference | None,
    stands: Callable[[str, Sequence[PooledCycles]], bool] = lambda *_: False,
) -> Iterator[tuple[str, PersonSession | GaitdiscError]]:
    """Each person and session read, one after the other, or why it could not be; with its title.

    stands: whether a page of these cycles is there already, which is not read again
    """
    for key, own in _by_session(run).items():
        if stands(_title(*key), own):
            continue
        try:
            readings = _readings(own, run, reference)
            yield _title(*key), PersonSession(_title(*key), readings, contrasts_of(readings))
        except GaitdiscError as error:
            yield _title(*key), error


def _title(subject: str, session: str) -> str:
    return " ".join(part for part in (subject, session) if part)


def _by_session(run: StudyRun) -> dict[tuple[str, str], list[PooledCycles]]:
    found: dict[tuple[str, str], list[PooledCycles]] = {}
    for pooled in run.of(CYCLES):
        found.setdefault((pooled.subject, pooled.session), []).append(pooled)
    return found


def _readings(
    own: Sequence[PooledCycles], run: StudyRun, reference: ClinicalReference | None
) -> tuple[ClinicalReading, ...]:
    # kept before refused, and then the study's first condition before all others
    ordered = sorted(own, key=lambda one: (not len(one.kept), one.condition != run.nominal))
    return tuple(read_beside(one, reference) for one in ordered)


def before_and_after(readings: Sessions, person: str, words: Sequence[str]) -> tuple[ClinicalReading, ClinicalReading]:
    """Two readings of a person by the words of their sessions or conditions, of one condition or of one session."""
    own = [one for (subject, _), each in readings.items() if subject == person for one in each if one.legs]
    if not own:
        people = ", ".join(dict.fromkeys(subject for subject, _ in readings))
        raise SchemaError(
            "a person of the run with kept cycles is needed", f"{person!r}; there are {people}", "Name one."
        )
    first, second = ([one for one in own if word in (one.pooled.session, one.pooled.condition)] for word in words)
    pairs = [
        (a, b)
        for a, b in itertools.product(first, second)
        if (a.pooled.condition == b.pooled.condition) != (a.pooled.session == b.pooled.session)
    ]
    if not pairs:
        there = ", ".join(one.pooled.where for one in own)
        raise SchemaError(
            f"{person} needs kept cycles of {words[0]!r} and of {words[1]!r}, of one condition or of one session",
            f"found {there}",
            "Name two sessions, or two conditions, of these.",
        )
    return pairs[0]


def contrasts_of(readings: Sequence[ClinicalReading]) -> tuple[Contrast, ...]:
    """First condition of a session against each other one that has cycles."""
    main, *others = readings
    return tuple(contrast_of(main, other) for other in others if main.legs and other.legs)
