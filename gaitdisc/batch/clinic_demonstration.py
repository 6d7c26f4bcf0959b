"""A week of a clinic, made: controls, healthy people, and some with gait planted that their pages must find."""

from __future__ import annotations

import json
from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace
from pathlib import Path

from gaitdisc.batch.demonstration import FORCES, planted, write_trial
from gaitdisc.cohort.measurement import measured
from gaitdisc.cohort.person import Person, drawn
from gaitdisc.cohort.walk import walked
from gaitdisc.ingest.study import Conditions, Participant, PlannedTrial, Study
from gaitdisc.ingest.study_file import write_study
from gaitdisc.recording import Trial
from gaitdisc.whole_file import write_whole

WALK_S = 16.0
CONTROLS_SEED, WEEK_SEED = 50_000, 60_000
CONDITION = "walking"


@dataclass(frozen=True)
class Visit:
    """One walk of a made person."""

    name: str
    number: int  # of the person, who is drawn by it
    session: str = ""
    # what is planted, and where; empty for a healthy walk, `bad file` for a recording that cannot be read, `child` for
    # somebody of eight years and that size
    what: str = ""
    # what is planted, and where; empty for a healthy walk, `bad file` for a recording that cannot be read, `child` for
    # somebody of eight years and that size
    side: str = "r"


WEEK = (
    Visit("P01", 0),
    Visit("P02", 1, what="stiff knee", side="l"),
    Visit("P03", 2),
    Visit("P04", 3, what="drop foot", side="r"),
    Visit("P05", 4, "before", "stiff knee", "r"),
    Visit("P05", 4, "after"),
    Visit("P06", 5, what="bad file"),
    Visit("P07", 6),
    Visit("P08", 8, what="child"),
)
CHILD = {"age_years": 8.0, "height_m": 1.26, "mass_kg": 26.0}
NO_GAIT = ("bad file", "child")  # planted, but not into the way of walking


def person_of(visit: Visit, seed: int) -> Person:
    """Somebody drawn; a child walks as fast as the grown person of the same draw, for its size (Hof 1996)."""
    person = drawn(visit.name, seed + visit.number, "fm"[visit.number % 2])
    if visit.what != "child":
        return person
    smaller = (CHILD["height_m"] / person.height_m) ** 0.5
    return replace(person, **CHILD, speed_m_per_s=smaller * person.speed_m_per_s, stride_s=smaller * person.stride_s)


def made_walk(visit: Visit, seed: int) -> Trial:
    """Walk of a visit on a treadmill, measured, with what is planted."""
    person = person_of(visit, seed)
    walk = walked(person, None, WALK_S, seed=seed + 7 * visit.number + len(visit.session))
    what = "" if visit.what in NO_GAIT else visit.what
    return planted(measured(walk, f"{visit.name}_{CONDITION}", CONDITION), what, visit.side)


def write_week(
    folder: Path, controls: int = 20, progress: Callable[[str], None] = lambda _: None
) -> tuple[Study, Study, dict[str, str]]:
    """Write `controls/` and `week/`, and apart from them what was planted by person and session, "" for the healthy."""
    visits = [Visit(f"C{k + 1:02d}", k) for k in range(controls)]
    own = _written(folder / "controls", visits, "Controls, made", CONTROLS_SEED, progress)
    truth = {f"{one.name} {one.session}".strip(): _words(one) for one in WEEK}
    said = "; ".join(f"{who} {what}" for who, what in truth.items() if what)
    week = _written(folder / "week", WEEK, f"A week, made (simulated, no people). Planted: {said}", WEEK_SEED, progress)
    write_whole(folder / "planted.json", json.dumps(truth, indent=1))
    return own, week, truth


def _words(visit: Visit) -> str:
    if visit.what in ("", *NO_GAIT):
        return visit.what
    return f"{visit.what} {'left' if visit.side == 'l' else 'right'}"


def _written(folder: Path, visits: Sequence[Visit], title: str, seed: int, progress: Callable[[str], None]) -> Study:
    trials: dict[str, list[PlannedTrial]] = {}
    people: dict[str, Person] = {}
    sessions = tuple(word for word in ("before", "after") if any(one.session == word for one in visits))
    for visit in visits:
        stem = f"raw/{visit.name}/{visit.session or 'only'}/{CONDITION}"
        files = write_trial(made_walk(visit, seed), folder, stem)
        if visit.what == "bad file":
            for file in files:
                whole = (folder / file).read_bytes()
                write_whole(folder / file, whole[: len(whole) // 3])
        people[visit.name] = person = person_of(visit, seed)
        planned = PlannedTrial(
            condition=CONDITION, session=visit.session or None, files=files, speed_m_per_s=person.speed_m_per_s
        )
        trials.setdefault(visit.name, []).append(planned)
        progress(visit.name)
    study = Study(
        title=title,
        sessions=sessions,
        conditions=Conditions(nominal=CONDITION),
        channels={name: f"{name} [N]" for name in FORCES},
        participants=tuple(participant_of(people[name], tuple(own)) for name, own in trials.items()),
    ).placed(folder)
    write_study(study, folder / "study.toml")
    return study


def participant_of(person: Person, trials: tuple[PlannedTrial, ...]) -> Participant:
    """What a study says of a made person."""
    return Participant(
        id=person.name, height_m=round(person.height_m, 3), age_years=int(person.age_years), trials=trials
    )
