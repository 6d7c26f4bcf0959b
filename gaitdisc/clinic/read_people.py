"""Everybody of a run read beside a reference, by person and session."""

from __future__ import annotations

import itertools
from collections.abc import Sequence

from gaitdisc.clinic.clinical_reference import ClinicalReference, PersonSession
from gaitdisc.clinic.reading import contrast, read_beside
from gaitdisc.errors import SchemaError
from gaitdisc.processing.pooled_cycles import CYCLES, PooledCycles
from gaitdisc.saved.study_run import StudyRun


def cycles_of_people(run: StudyRun) -> dict[str, list[PooledCycles]]:
    """Cycles of every person and session by its title, in the order of the study."""
    found: dict[str, list[PooledCycles]] = {}
    for pooled in run.of(CYCLES):
        found.setdefault(f"{pooled.subject} {pooled.session}".strip(), []).append(pooled)
    return found


def read_session(
    title: str, cycles: Sequence[PooledCycles], nominal: str, reference: ClinicalReference | None
) -> PersonSession:
    """A session read: kept before refused, then the study's first condition, which each other one is compared with."""
    ordered = sorted(cycles, key=lambda one: (not len(one.kept), one.condition != nominal))
    main, *others = readings = tuple(read_beside(one, reference) for one in ordered)
    contrasts = tuple(contrast(main, other) for other in others if main.legs and other.legs)
    return PersonSession(title, readings, contrasts)


def before_and_after(
    run: StudyRun, reference: ClinicalReference | None, person: str, words: Sequence[str]
) -> PersonSession:
    """A person after and before, by the words of two sessions or conditions, of one condition or of one session."""
    cycles = [one for one in run.of(CYCLES) if one.subject == person]
    ordered = sorted(cycles, key=lambda one: one.condition != run.nominal)
    own = [one for one in (read_beside(each, reference) for each in ordered) if one.legs]
    if not own:
        people = ", ".join(dict.fromkeys(pooled.subject for pooled in run.of(CYCLES)))
        raise SchemaError(
            f"the person must be one with kept cycles ({people})", f"found {person!r}", "Name one of them."
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
    before, after = pairs[0]
    return PersonSession(" ".join((person, *words)), (after, before), (contrast(before, after),))
