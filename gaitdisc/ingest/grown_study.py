"""A study that grows: files that came since it was written are added, and nothing of what stands in it is changed."""

from __future__ import annotations

from collections.abc import Mapping
from pathlib import Path

from pydantic import ValidationError

from gaitdisc.ingest.study import FUNCTIONAL, STATIC, UNKNOWN, Participant, PlannedTrial, Study
from gaitdisc.ingest.study_errors import schema_error

MEASURES = ("mass_kg", "height_m", "sex", "age_years", "group")


def grown_study(study: Study, draft: Study) -> Study:
    """Study with what a draft of the same folder of recordings has and it has not.

    Whoever is in the study keeps the pseudonym, also where the draft has another one for the same files; each trial
    keeps its condition and session. Files that belong to a trial of the study are added to it.

    draft: of all recordings, its paths relative to the same folder
    """
    owner = {_place(study, file): one.id for one in study.participants for trial in one.trials for file in trial.files}
    people = {one.id: one for one in study.participants}
    for drafted in draft.participants:
        own = [
            owner[place] for trial in drafted.trials for file in trial.files if (place := _place(draft, file)) in owner
        ]
        name = own[0] if own else _free(drafted.id, people)
        new = [trial for trial in drafted.trials if any(_place(draft, file) not in owner for file in trial.files)]
        if new:
            people[name] = _grown(people.get(name) or Participant(id=name), drafted, new, study)
    trials = [trial for one in people.values() for trial in one.trials]
    kinds = (*study.conditions.words, STATIC, FUNCTIONAL, UNKNOWN)
    others = dict.fromkeys(trial.condition for trial in trials if trial.condition not in kinds)
    sessions = dict.fromkeys(
        (*study.sessions, *(word for word in draft.sessions if word in {t.session for t in trials}))
    )
    conditions = study.conditions.model_copy(update={"others": (*study.conditions.others, *others)})
    update = {"participants": tuple(people.values()), "conditions": conditions, "sessions": tuple(sessions)}
    try:
        return Study.model_validate({**dict(study), **update}).placed(study.folder)
    except ValidationError as error:
        raise schema_error(error, Study, "", "the study with the new recordings") from error


def _grown(person: Participant, drafted: Participant, new: list[PlannedTrial], study: Study) -> Participant:
    """Person with the new trials, and with measures that were lacking."""
    trials = list(person.trials)
    for trial in new:
        files = {_place(study, file): file for file in trial.files}
        place = next((k for k, one in enumerate(trials) if any(_place(study, f) in files for f in one.files)), None)
        if place is None:
            trials.append(trial)
            continue
        held = {_place(study, file) for file in trials[place].files}
        more = tuple(file for where, file in files.items() if where not in held)
        trials[place] = trials[place].model_copy(update={"files": (*trials[place].files, *more)})
    measures = {name: getattr(person, name) or getattr(drafted, name) for name in MEASURES}
    return person.model_copy(update={"trials": tuple(trials), **measures})


def _free(wanted: str, people: Mapping[str, Participant]) -> str:
    """The pseudonym of a draft, or the next that nobody has."""
    return next(name for name in (wanted, *(f"P{k:02d}" for k in range(1, 10_000))) if name not in people)


def _place(study: Study, file: str) -> Path:
    return study.path_of(file).resolve()
