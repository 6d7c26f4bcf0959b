"""The study file, read and written; what is wrong in one, said with its file, line, key and what to do."""

import json
import os
import re
import typing
from collections.abc import Mapping
from pathlib import Path
from typing import Any

from pydantic import BaseModel, ValidationError

from gaitdisc.channel import did_you_mean
from gaitdisc.errors import SchemaError
from gaitdisc.ingest.raw_file import read_raw
from gaitdisc.ingest.study import FUNCTIONAL, MEASURES, STATIC, UNKNOWN, Participant, PlannedTrial, Study
from gaitdisc.ingest.study_settings import Kinematics
from gaitdisc.toml_text import parse_toml, quote
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
    "kinematics": '# [kinematics]\n# angles = "markers"  # joint angles from markers; those of the file are not used\n',
}

_TOP = """\
# A study of gaitdisc. Every setting is listed with its default; paths are relative to this file.
# Participants have pseudonyms only; the key to the pseudonyms must be kept elsewhere.
"""
_KINDS = {  # kind of a finding of pydantic, or how it begins -> what a value must, and what to do
    "finite_number": ("be a finite number", "Write a number."),
    "too_short": ("not be empty", "Fill it in, or remove the key."),
    "too_long": ("have fewer entries", "Remove some entries."),
    "string_pattern": (
        "be a pseudonym: letters, digits, _ and -, at most 16",
        "Use for example P01, and keep names out of the study.",
    ),
    "string_too_short": ("not be empty", "Fill it in, or remove the key."),
    "string_too_long": ("be shorter", "Use at most 40 characters."),
    "float": ("be a number", "Write the number without quotes, for example 6.0."),
    "int": ("be a whole number", "Write the number without quotes and without a point, for example 4."),
    "string": ("be text", 'Write the text in quotes: "...".'),
    "tuple": ("be a list", "Write the list in brackets: [...]."),
    **dict.fromkeys(("model", "dict"), ("be a table", "Write the keys under a header in brackets.")),
}
_LIMITS = {
    "greater_than": ("above", "gt"),
    "greater_than_equal": ("at least", "ge"),
    "less_than": ("below", "lt"),
    "less_than_equal": ("at most", "le"),
}
Place = tuple[str | int, ...]
# where keys stand; the parser of the standard library does not say
_KEY = r"""(?:"[^"]*"|'[^']*'|[A-Za-z0-9_-]+)"""
_DOTTED = rf"{_KEY}(?:\s*\.\s*{_KEY})*"
_TABLE = re.compile(rf"\s*(\[\[?)\s*({_DOTTED})\s*\]\]?")
_PAIR = re.compile(rf"\s*({_DOTTED})\s*=")


def load_study(path: Path | str) -> Study:
    """Study of a file, or of the `study.toml` in a folder."""
    path = Path(path)
    if path.is_dir():
        path = path / "study.toml"
    raw = read_raw(path, LARGEST_STUDY_BYTES)
    text = "\n".join(raw.lines())
    try:
        content = parse_toml(text)
    except ValueError as error:
        raise SchemaError(
            f"{raw.name} must be a TOML file",
            f"the parser reports: {str(error)[:200]}",
            "Correct that line: text in quotes, numbers without quotes, lists in brackets.",
        ) from error
    try:
        as_json = json.dumps(content, default=str)  # JSON, since strict validation takes its lists for tuples
        return Study.model_validate_json(as_json).placed(path.parent).with_unnamed()
    except ValidationError as error:
        raise schema_error(error, Study, text, raw.name) from error


def write_study(study: Study, path: Path | str) -> Path:
    """Write a study with every default, a word on each key, and paths relative to the new file, whole or not at all."""
    path = Path(path)
    if path.is_dir():
        path = path / "study.toml"
    return write_whole(path, study_text(study, path.parent))


def study_text(study: Study, folder: Path | None = None) -> str:
    """Text of a study file in a folder, its own by default."""
    tables = [_TOP + _pair(study, "title") + _pair(study, "sessions")]
    for key in (
        "conditions", "treadmill", "channels", "filters", "kinematics", "strides", "models", "held_out", "quality",
    ):  # fmt: skip
        value = getattr(study, key)
        if isinstance(value, Kinematics) and value.marker_set.endswith(".toml"):
            value = value.model_copy(update={"marker_set": _relocate(value.marker_set, study.folder, folder)})
        if value is None:
            tables.append(UNSET[key])
            continue
        if isinstance(value, BaseModel):
            about = (type(value).__doc__ or "").split("\n")[0]
            pairs = "".join(_pair(value, name) for name in type(value).model_fields)
        else:
            about = type(study).model_fields[key].description
            pairs = "".join(f"{quote(label)} = {quote(name)}\n" for label, name in value.items())
        tables.append(f"# {about}\n[{key}]\n{pairs}")
    explained = False  # each key is explained where it stands first
    for participant in study.participants:
        measured = tuple(name for name in MEASURES if getattr(participant, name))
        text = f"[[participants]]\n{_pairs(participant, ('id', 'group', 'excluded', *measured), explained)}"
        for trial in participant.trials:
            files = tuple(_relocate(file, study.folder, folder) for file in trial.files)
            moved = trial.model_copy(update={"files": files})
            text += f"\n[[participants.trials]]\n{_pairs(moved, tuple(type(moved).model_fields), explained)}"
            explained = True
        tables.append(text)
    return "\n".join(tables)


def _pairs(part: BaseModel, names: tuple[str, ...], explained: bool) -> str:
    if not explained:
        return "".join(_pair(part, name) for name in names)
    values = {name: getattr(part, name) for name in names}
    return "".join(f"{name} = {_value(value)}\n" for name, value in values.items() if value not in (None, "", ()))


def _pair(part: BaseModel, name: str) -> str:
    value = getattr(part, name)
    about = type(part).model_fields[name].description
    unused = value is None or (name == "share" and getattr(part, "seconds", None) is not None)
    text = f"{name} = {_value(EXAMPLES.get(name) if unused else value)}"
    if "\n" in text:
        return f"# {about}\n{text}\n"
    return f"{'# ' if unused else ''}{text}  # {about}\n"


def _value(value: Any) -> str:
    if isinstance(value, str):
        return quote(value)
    if isinstance(value, tuple):
        items = [_value(item) for item in value]
        one_line = f"[{', '.join(items)}]"
        return one_line if len(one_line) <= 90 else "[\n" + "".join(f"    {item},\n" for item in items) + "]"
    return repr(value)


def _relocate(file: str, old: Path, new: Path | None) -> str:
    if new is None or Path(file).is_absolute() or old.resolve() == new.resolve():
        return file
    return Path(os.path.relpath((old / file).resolve(), new.resolve())).as_posix()


def grow_study(study: Study, draft: Study) -> Study:
    """Study with what a draft of the same folder of recordings has and it has not.

    Whoever is in the study keeps the pseudonym, also where the draft has another one for the same files; each trial
    keeps its condition and session. Files that belong to a trial of the study are added to it.
    """
    owner = {_place(study, file): p.id for p in study.participants for trial in p.trials for file in trial.files}
    people = {p.id: p for p in study.participants}
    for drafted in draft.participants:
        names = [
            owner[place] for trial in drafted.trials for file in trial.files if (place := _place(draft, file)) in owner
        ]
        # the pseudonym of a draft, or the next that nobody has
        free = (name for name in (drafted.id, *(f"P{k:02d}" for k in range(1, 10_000))) if name not in people)
        name = names[0] if names else next(free)
        new = [trial for trial in drafted.trials if any(_place(draft, file) not in owner for file in trial.files)]
        if new:
            people[name] = _grow(people.get(name) or Participant(id=name), drafted, new, study)
    trials = [trial for person in people.values() for trial in person.trials]
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


def _grow(person: Participant, drafted: Participant, new: list[PlannedTrial], study: Study) -> Participant:
    """Person with the new trials, and with measures that were lacking."""
    trials = list(person.trials)
    for trial in new:
        files = {_place(study, file): file for file in trial.files}
        place = next((k for k, t in enumerate(trials) if any(_place(study, f) in files for f in t.files)), None)
        if place is None:
            trials.append(trial)
            continue
        held = {_place(study, file) for file in trials[place].files}
        more = tuple(file for where, file in files.items() if where not in held)
        trials[place] = trials[place].model_copy(update={"files": (*trials[place].files, *more)})
    measures = {name: getattr(person, name) or getattr(drafted, name) for name in (*MEASURES, "group")}
    return person.model_copy(update={"trials": tuple(trials), **measures})


def _place(study: Study, file: str) -> Path:
    return study.path_of(file).resolve()


def schema_error(error: ValidationError, model: type[BaseModel], text: str, file: str) -> SchemaError:
    """Sentence for the first of pydantic's findings, with the count of the others."""
    findings = [
        finding
        for finding in error.errors(include_url=False)  # a list is called too short when an entry of it was refused
        if finding["type"] != "too_short" or finding.get("ctx", {})["actual_length"] >= len(finding["input"])
    ]
    first = min(findings, key=lambda f: (f["type"] != "extra_forbidden", find_line(text, _place_in(f)) or 0))
    place = _place_in(first)
    line = find_line(text, place)
    where = file if line is None else f"{file}, line {line}"
    needed, fault, remedy = _sentence(first, place, model)
    if len(findings) > 1:
        remedy += f" (Further settings to correct: {len(findings) - 1}.)"
    return SchemaError(f"{where}: {needed}", fault, remedy)


def _place_in(finding: Mapping[str, Any]) -> Place:
    return (*finding["loc"], *finding.get("ctx", {}).get("place", ()))


def _sentence(finding: Mapping[str, Any], place: Place, model: type[BaseModel]) -> tuple[str, str, str]:
    kind, value, context = finding["type"], finding.get("input"), finding.get("ctx", {})
    if kind == "extra_forbidden":
        owner = _part(place[:-1], model)
        keys = list(owner.model_fields) if owner else []
        needed = f"the keys of {_table(place[:-1])} must be among {', '.join(keys)}"
        return needed, f"{place[-1]!r} is unknown", did_you_mean(str(place[-1]), keys, "Remove it.")
    if kind == "missing" and isinstance(place[-1], int):
        return f"{_name(place[:-1])} must have at least {place[-1] + 1} entries", f"found {place[-1]}", "Add one."
    if kind == "missing":
        remedy = f"Add {place[-1]} ({_about(place, model)})."
        return f"{_table(place[:-1])} must have {place[-1]!r}", "it is missing", remedy
    if kind == "gaitdisc":
        return f"{_name(place)} must {context['needed']}", context["found"], context["remedy"]
    fault = f"found {value!r}"
    if isinstance(value, list | tuple):
        fault = f"found a list of {len(value)}"
    elif value is None or isinstance(value, dict):
        fault = "found nothing" if value is None else "found a table"
    words, remedy = _state_need(kind, value, context)
    if kind == "tuple_type" and isinstance(value, dict):
        remedy = f"Write its header in two pairs of brackets: [[{place[-1]}]]."
    return f"{_name(place)} must {words or finding['msg']}", fault, remedy


def _state_need(kind: str, value: Any, context: Mapping[str, Any]) -> tuple[str, str]:
    """What a value must be, and what to do about it."""
    if kind in _LIMITS:
        word, key = _LIMITS[kind]
        return f"be {word} {context[key]:g}", "Correct the number."
    if kind == "literal_error":
        words = str(context["expected"])
        listed = [word.strip(" '") for word in words.replace(" or ", ",").split(",")]
        return f"be one of {words}", did_you_mean(str(value), listed, "Choose one of them.")
    return next((words for key, words in _KINDS.items() if kind.startswith(key)), ("", "Correct it."))


def _name(place: Place) -> str:
    if not place:
        return "the study"
    if isinstance(place[-1], int):
        return f"{_name(place[:-1])}, entry {place[-1] + 1},"
    return f"{_table(place[:-1])} {place[-1]}" if place[:-1] else str(place[-1])


def _table(place: Place) -> str:
    words = [str(part) for part in place if isinstance(part, str)]
    if not words:
        return "the study"
    if len(words) == len(place):
        return f"[{'.'.join(words)}]"
    return "".join(f" {part + 1}" if isinstance(part, int) else f", {part}" for part in place).lstrip(", ") + ":"


def _about(place: Place, model: type[BaseModel]) -> str:
    owner = _part(place[:-1], model)
    info = owner.model_fields.get(str(place[-1])) if owner else None
    if info is not None and info.description:
        return info.description
    part = _part(place, model)
    return " ".join((part.__doc__ or "").split("\n")[0].rstrip(".").split()) if part else "as the example shows"


def _part(place: Place, model: type[BaseModel]) -> type[BaseModel] | None:
    """Part of the study that a place belongs to."""
    part: type[BaseModel] | None = model
    for key in place:
        if isinstance(key, int) or part is None:
            continue
        info = part.model_fields.get(key)
        part = _model_in(info.annotation) if info is not None else None
    return part


def _model_in(annotation: Any) -> type[BaseModel] | None:
    if isinstance(annotation, type) and issubclass(annotation, BaseModel):
        return annotation
    return next((model for inner in typing.get_args(annotation) if (model := _model_in(inner))), None)


def find_line(text: str, place: Place) -> int | None:
    r"""Line, from 1, of a key, or of its table where the key is absent; None where not even the table is there.

    >>> find_line("title = 'x'\n[filters]\norder = 3\n", ("filters", "order"))
    3
    """
    lines: dict[Place, int] = {}
    counts: dict[Place, int] = {}  # of each array of tables, so far
    table: Place = ()
    for line, words in enumerate(text.split("\n"), 1):
        header, pair = _TABLE.match(words), _PAIR.match(words)
        if header:
            table = ()
            keys = _keys(header[2])
            for key in keys[:-1]:
                table = (*table, key)
                table = (*table, counts[table]) if table in counts else table
            table = (*table, keys[-1])
            if header[1] == "[[":
                counts[table] = counts.get(table, -1) + 1
                table = (*table, counts[table])
            lines.setdefault(table, line)
        elif pair:
            lines.setdefault((*table, *_keys(pair[1])), line)
    return next((lines[place[:depth]] for depth in range(len(place), 0, -1) if place[:depth] in lines), None)


def _keys(dotted: str) -> list[str]:
    return [key.strip("\"'") for key in re.findall(_KEY, dotted)]
