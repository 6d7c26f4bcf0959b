"""The study file `study.toml`: loaded with every slip named, written with every default, and grown by new files."""

from __future__ import annotations

import json
import os
from collections.abc import Mapping
from pathlib import Path
from typing import Any

from pydantic import BaseModel, ValidationError

from gaitdisc.errors import SchemaError
from gaitdisc.ingest.raw_file import read_raw
from gaitdisc.ingest.study import FUNCTIONAL, STATIC, UNKNOWN, Kinematics, Participant, PlannedTrial, Study
from gaitdisc.ingest.study_errors import schema_error
from gaitdisc.toml_text import parsed_toml, quoted
from gaitdisc.whole_file import write_whole

LARGEST_STUDY_BYTES = 16 * 2**20  # a hundred thousand trials
EXAMPLES = {  # of what a study does not have
    "speed_m_per_s": 1.3,
    "crop_s": (10.0, 250.0),
    "seconds": 30.0,
    "share": 0.125,
    "device": "exo",
    "unnamed": "walking",
    "session": "before",
    "angles": "markers",
    "joints": "held",
    "hip": "harrington",
    "part": "3",
}
UNSET = {  # parts that a study may lack
    "treadmill": "# [treadmill]\n# speed_m_per_s = 1.3  # belt speed [m/s], for strides found from markers\n",
    "kinematics": '# [kinematics]\n# angles = "markers"  # joint angles from markers, those of the file not used\n',
}

_TOP = """\
# A study of gaitdisc. Every setting stands here with its default; paths are relative to this file.
# Participants have pseudonyms only; whoever keeps the key keeps it elsewhere.
"""
MEASURES = ("mass_kg", "height_m", "sex", "age_years", "group")


def load_study(path: Path | str) -> Study:
    """Study of a file, or of the `study.toml` in a folder."""
    path = Path(path)
    if path.is_dir():
        path = path / "study.toml"
    raw = read_raw(path, LARGEST_STUDY_BYTES)
    text = "\n".join(raw.lines())
    try:
        content = parsed_toml(text)
    except ValueError as error:
        raise SchemaError(
            f"{raw.name} must be a TOML file",
            f"it says: {str(error)[:200]}",
            "Correct that line: text in quotes, numbers without, lists in brackets.",
        ) from error
    try:
        as_json = json.dumps(content, default=str)  # JSON, since strict validation takes its lists for tuples
        return Study.model_validate_json(as_json).placed(path.parent).with_unnamed()
    except ValidationError as error:
        raise schema_error(error, Study, text, raw.name) from error


def write_study(study: Study, path: Path | str) -> Path:
    """Write a study file with every default and a word on each key, whole or not at all.

    study: what to write; its paths are made relative to the new file where they were relative to another one
    """
    path = Path(path)
    if path.is_dir():
        path = path / "study.toml"
    return write_whole(path, study_text(study, path.parent))


def study_text(study: Study, folder: Path | None = None) -> str:
    """Text of a study file.

    folder: folder of the new file; that of the study by default
    """
    parts = [_TOP + _pair(study, "title") + _pair(study, "sessions")]
    for key in (
        "conditions", "treadmill", "channels", "filters", "kinematics", "strides", "models", "held_out", "quality",
    ):  # fmt: skip
        value = getattr(study, key)
        if isinstance(value, Kinematics) and value.marker_set.endswith(".toml"):
            value = value.model_copy(update={"marker_set": _moved(value.marker_set, study.folder, folder)})
        about = (type(value).__doc__ or "").split("\n")[0] if isinstance(value, BaseModel) else ""
        if value is None:
            parts.append(UNSET[key])
        elif isinstance(value, BaseModel):
            pairs = "".join(_pair(value, name) for name in type(value).model_fields)
            parts.append(f"# {about}\n[{key}]\n{pairs}")
        else:
            about = type(study).model_fields[key].description
            pairs = "".join(f"{quoted(label)} = {quoted(name)}\n" for label, name in value.items())
            parts.append(f"# {about}\n[{key}]\n{pairs}")
    explained = False  # each key is explained where it stands first
    for participant in study.participants:
        measured = tuple(name for name in ("mass_kg", "height_m", "sex", "age_years") if getattr(participant, name))
        text = f"[[participants]]\n{_pairs(participant, ('id', 'group', 'excluded', *measured), explained)}"
        for trial in participant.trials:
            files = tuple(_moved(file, study.folder, folder) for file in trial.files)
            moved = trial.model_copy(update={"files": files})
            text += f"\n[[participants.trials]]\n{_pairs(moved, tuple(type(moved).model_fields), explained)}"
            explained = True
        parts.append(text)
    return "\n".join(parts)


def _pairs(part: BaseModel, names: tuple[str, ...], explained: bool) -> str:
    if not explained:
        return "".join(_pair(part, name) for name in names)
    values = {name: getattr(part, name) for name in names}
    return "".join(f"{name} = {_value(value)}\n" for name, value in values.items() if value not in (None, ""))


def _pair(part: BaseModel, name: str) -> str:
    value = getattr(part, name)
    about = type(part).model_fields[name].description
    unused = value is None or (name == "share" and getattr(part, "seconds", None) is not None)
    example = EXAMPLES.get(name)
    text = f"{name} = {_value(example if unused else value)}"
    if "\n" in text:
        return f"# {about}\n{text}\n"
    return f"{'# ' if unused else ''}{text}  # {about}\n"


def _value(value: Any) -> str:
    if isinstance(value, str):
        return quoted(value)
    if isinstance(value, tuple):
        items = [_value(item) for item in value]
        one_line = f"[{', '.join(items)}]"
        return one_line if len(one_line) <= 90 else "[\n" + "".join(f"    {item},\n" for item in items) + "]"
    return repr(value)


def _moved(file: str, old: Path, new: Path | None) -> str:
    if new is None or Path(file).is_absolute() or old.resolve() == new.resolve():
        return file
    return Path(os.path.relpath((old / file).resolve(), new.resolve())).as_posix()


def study_schema() -> Mapping[str, Any]:
    """JSON Schema of the study file, as it stands in `data_schema/study.schema.json`.

    >>> study_schema()["title"]
    'Study'
    """
    return Study.model_json_schema()


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
        # the pseudonym of a draft, or the next that nobody has
        free = (name for name in (drafted.id, *(f"P{k:02d}" for k in range(1, 10_000))) if name not in people)
        name = own[0] if own else next(free)
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


def _place(study: Study, file: str) -> Path:
    return study.path_of(file).resolve()
