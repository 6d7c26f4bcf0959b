"""Rules of a study that one key alone cannot break: words, pseudonyms, names and units that must fit together."""

from __future__ import annotations

import difflib
import re
from collections import Counter
from collections.abc import Mapping, Sequence
from typing import TYPE_CHECKING, NoReturn

from pydantic_core import PydanticCustomError

from gaitdisc.channel import hint_nearest, nearest_word, vocabulary
from gaitdisc.ingest.columns import split_unit
from gaitdisc.units import known_units, parsed_unit

if TYPE_CHECKING:
    from gaitdisc.ingest.study import Conditions, Models, Study

_DATE = re.compile(r"(?<!\d)(?:\d{1,4}[-_./ ]\d{1,2}[-_./ ]\d{1,4}|\d{6}|\d{8}|(?:19|20)\d{2})(?!\d)")
MISSPELT = 0.85  # likeness to a known name above which another name is taken for a slip


def refuse(place: Sequence[str | int], needed: str, found: str, remedy: str) -> NoReturn:
    """Refuse from within validation; place: keys and places in lists, from the part that is being checked."""
    words = {"place": tuple(place), "needed": needed, "found": found, "remedy": remedy}
    raise PydanticCustomError("gaitdisc", "{needed}; {found}. {remedy}", words)


def check_conditions(conditions: Conditions, unknown: str) -> None:
    """Refuse conditions of which two share a word, and a word for unnamed trials that is no condition."""
    words = conditions.words
    if len(set(words)) < len(words) or unknown in words:
        found = f"found {' and '.join(map(repr, words))}"
        needed = "be two different words" if len(words) == 2 else "be different words"
        name = "Name the two conditions." if len(words) == 2 else "Name each condition once."
        refuse(("conditions",), f"{needed}, neither of them {unknown!r}", found, name)
    if conditions.unnamed is not None and conditions.unnamed not in words:
        found = f"found {conditions.unnamed!r}"
        refuse(("conditions", "unnamed"), f"be one of {', '.join(map(repr, words))}", found, "Write one of them.")


def check_sessions(study: Study) -> None:
    """Refuse sessions that are dates or stand twice, and trials of a session that the study does not list."""
    for i, word in enumerate(study.sessions):
        if _DATE.search(word):
            remedy = 'Write words in the order of the dates, such as sessions = ["before", "after"].'
            refuse(("sessions", i), "not be a date, because a date can identify a person", f"found {word!r}", remedy)
        if study.sessions.index(word) != i:
            refuse(("sessions", i), "list each session once", f"{word!r} occurs twice", "Remove one.")
    for i, participant in enumerate(study.participants):
        for j, trial in enumerate(participant.trials):
            if trial.session is not None and trial.session not in study.sessions:
                nearest = nearest_word(trial.session, study.sessions)
                remedy = f"Did you mean {nearest!r}?" if nearest else f"Add it: sessions = [{trial.session!r}]."
                listed = ", ".join(map(repr, study.sessions)) or "none"
                place = ("participants", i, "trials", j, "session")
                refuse(place, f"be a session that the study lists ({listed})", f"found {trial.session!r}", remedy)


def check_participants(study: Study, others: Sequence[str]) -> None:
    """Refuse conditions that are neither the study's nor `others`, pseudonyms twice, names that no file can have."""
    words = study.conditions.words
    ids = Counter(each.id.lower() for each in study.participants)
    for i, participant in enumerate(study.participants):
        if ids[participant.id.lower()] > 1:
            found = f"{participant.id!r} occurs {ids[participant.id.lower()]} times"
            place = ("participants", i, "id")
            refuse(place, "be used for one person only", found, "List all trials under one pseudonym.")
        for j, trial in enumerate(participant.trials):
            if trial.condition not in (*words, *others):
                nearest = nearest_word(trial.condition, (*words, *others))
                remedy = f"Did you mean {nearest!r}?" if nearest else f"Use one of them, or {others[0]!r}."
                place = ("participants", i, "trials", j, "condition")
                refuse(place, " or ".join(map(repr, words)), f"found {trial.condition!r}", remedy)
            for k, file in enumerate(trial.files):
                if "\0" in file:
                    place = ("participants", i, "trials", j, "files", k)
                    refuse(place, "be a name without a NUL character", f"found {file!r}", "Correct the name.")


def check_channels(channels: Mapping[str, str]) -> None:
    """Refuse a map (label -> `name` or `name [unit]`) with an unknown unit, a misspelt name, or a name twice."""
    owners: dict[str, str] = {}
    for label, said in channels.items():
        name, unit = split_unit(said)
        place = ("channels", label)
        if not name:
            refuse(place, "be the name of a channel", f"found {said!r}", 'Write for example "emg_sol_r [V]".')
        if unit is not None and parsed_unit(unit) is None:
            found = f"found {unit!r}" + hint_nearest(unit, known_units())
            refuse(place, "be in the list of units", found, f"Use one of: {', '.join(known_units())}.")
        if unit is None:
            _check_spelling(place, name)
        if name in owners:
            found = f"{owners[name]!r} and {label!r} both mean {name!r}"
            refuse(place, "be used for one label only", found, "Use two names, or remove one label.")
        owners[name] = label


def check_variables(models: Models, channels: Mapping[str, str]) -> None:
    """Refuse misspelt or doubled variables, outputs not among inputs; names of the study's channels are known too."""
    mapped = {split_unit(said)[0] for said in channels.values()}
    inputs = (*models.angles, *models.emg)
    for key in ("angles", "emg", "outputs"):
        names: tuple[str, ...] = getattr(models, key)
        for i, name in enumerate(names):
            if names.count(name) > 1:
                refuse(("models", key), "list each name once", f"{name!r} occurs twice", "Remove one of them.")
            if key == "outputs" and name not in inputs:
                found = f"{name!r} is not{hint_nearest(name, inputs)}"
                remedy = "Add it to angles or emg, or remove it from outputs."
                refuse(("models", key), "be among the inputs (angles and emg)", found, remedy)
            if name not in mapped:
                _check_spelling(("models", key, i), name)
    both = sorted(set(models.angles) & set(models.emg))
    if both:
        refuse(("models", "emg"), "not repeat a channel of angles", f"{both[0]!r} is in both", "Remove it from one.")


def _check_spelling(place: Sequence[str | int], name: str) -> None:
    """Refuse a name that is nearly one of the vocabulary; other names are the laboratory's own."""
    known = [channel.name for channel in vocabulary().channels]
    if name in known or f"{name}_r" in known:
        return
    near = difflib.get_close_matches(name, known, n=1, cutoff=MISSPELT)
    if near:
        remedy = f'Did you mean {near[0]!r}? A channel of your own must have its unit in [channels]: "{name} [V]".'
        refuse(place, "be a channel name", f"found {name!r}", remedy)
