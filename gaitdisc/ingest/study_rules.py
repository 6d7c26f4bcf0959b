"""Rules of a study that one key alone cannot break: words, pseudonyms, names and units that must fit together."""

from __future__ import annotations

import difflib
from collections import Counter
from collections.abc import Mapping, Sequence
from typing import TYPE_CHECKING, NoReturn

from pydantic_core import PydanticCustomError

from gaitdisc.channel import nearest_word, vocabulary
from gaitdisc.ingest.columns import split_unit
from gaitdisc.units import known_units, parsed_unit

if TYPE_CHECKING:
    from gaitdisc.ingest.study import Models, Study

MISSPELT = 0.85  # likeness to a known name above which another name is taken for a slip


def refuse(place: Sequence[str | int], needed: str, found: str, remedy: str) -> NoReturn:
    """Refuse a study from within its validation.

    Parameters
    ----------
    place : sequence of str or int
        Keys and places in lists that lead to what is wrong, from the part that is being checked.
    needed, found, remedy : str
        The three parts of the sentence.

    Raises
    ------
    PydanticCustomError
        Always; `load_study` makes a SchemaError of it.

    Examples
    --------
    >>> refuse(("id",), "a pseudonym", "found 'P01' twice", "Rename one.")
    Traceback (most recent call last):
    ...
    pydantic_core._pydantic_core.PydanticCustomError: a pseudonym; found 'P01' twice. Rename one.
    """
    words = {"place": tuple(place), "needed": needed, "found": found, "remedy": remedy}
    raise PydanticCustomError("gaitdisc", "{needed}; {found}. {remedy}", words)


def check_participants(study: Study, unknown: str) -> None:
    """Refuse conditions that are none of the study's two, and pseudonyms that stand twice.

    Parameters
    ----------
    study : Study
        All of it.
    unknown : str
        The word for a condition that is not known.

    Examples
    --------
    >>> check_participants(study, "unknown")  # doctest: +SKIP
    """
    words = study.conditions.both
    if words[0] == words[1] or unknown in words:
        found = f"found {words[0]!r} and {words[1]!r}"
        refuse(("conditions",), f"two different words, neither of them {unknown!r}", found, "Name the two conditions.")
    ids = Counter(each.id.lower() for each in study.participants)
    for i, participant in enumerate(study.participants):
        if ids[participant.id.lower()] > 1:
            found = f"{participant.id!r} stands {ids[participant.id.lower()]} times"
            refuse(("participants", i, "id"), "a pseudonym for one person only", found, "Put all trials under one.")
        for j, trial in enumerate(participant.trials):
            if trial.condition not in (*words, unknown):
                nearest = nearest_word(trial.condition, words)
                remedy = f"Did you mean {nearest!r}?" if nearest else f"Use one of them, or {unknown!r}."
                place = ("participants", i, "trials", j, "condition")
                refuse(place, f"{words[0]!r} or {words[1]!r}", f"found {trial.condition!r}", remedy)


def check_channels(channels: Mapping[str, str]) -> None:
    """Refuse a channel map with an unknown unit, a misspelt name, or one name for two labels.

    Parameters
    ----------
    channels : mapping of str to str
        Label -> `name` or `name [unit]`.

    Examples
    --------
    >>> check_channels({"Sensor 1": "emg_sol_r [mV]"})
    """
    owners: dict[str, str] = {}
    for label, said in channels.items():
        name, unit = split_unit(said)
        place = ("channels", label)
        if not name:
            refuse(place, "the name of a channel", f"found {said!r}", 'Write for example "emg_sol_r [V]".')
        if unit is not None and parsed_unit(unit) is None:
            nearest = nearest_word(unit, known_units())
            found = f"found {unit!r}" + (f", the nearest is {nearest!r}" if nearest else "")
            refuse(place, "a unit of the closed list", found, f"Use one of: {', '.join(known_units())}.")
        if unit is None:
            _check_spelling(place, name)
        if name in owners:
            found = f"{owners[name]!r} and {label!r} both mean {name!r}"
            refuse(place, "a name for one label only", found, "Give them two names, or leave one out.")
        owners[name] = label


def check_variables(models: Models, channels: Mapping[str, str]) -> None:
    """Refuse model variables that are misspelt, doubled, or outputs that are not among the inputs.

    Parameters
    ----------
    models : Models
        Inputs and outputs.
    channels : mapping of str to str
        The study's channel map; its names are known as well.

    Examples
    --------
    >>> check_variables(models, {})  # doctest: +SKIP
    """
    mapped = {split_unit(said)[0] for said in channels.values()}
    inputs = (*models.angles, *models.emg)
    for key in ("angles", "emg", "outputs"):
        names: tuple[str, ...] = getattr(models, key)
        for i, name in enumerate(names):
            if names.count(name) > 1:
                refuse(("models", key), "each name once", f"{name!r} stands twice", "Remove one of them.")
            if key == "outputs" and name not in inputs:
                nearest = nearest_word(name, inputs)
                found = f"{name!r} is none" + (f", the nearest is {nearest!r}" if nearest else "")
                remedy = "Add it to angles or emg, or take it out of outputs."
                refuse(("models", key), "outputs among the inputs (angles and emg)", found, remedy)
            if name not in mapped:
                _check_spelling(("models", key, i), name)
    both = sorted(set(models.angles) & set(models.emg))
    if both:
        refuse(("models", "emg"), "angles and EMG apart", f"{both[0]!r} is in both", "Remove it from one of them.")


def _check_spelling(place: Sequence[str | int], name: str) -> None:
    """Refuse a name that is nearly one of the vocabulary; other names are the laboratory's own."""
    known = [channel.name for channel in vocabulary().channels]
    if name in known or f"{name}_r" in known:
        return
    near = difflib.get_close_matches(name, known, n=1, cutoff=MISSPELT)
    if near:
        remedy = f'Did you mean {near[0]!r}? A channel of your own needs its unit in [channels]: "{name} [V]".'
        refuse(place, "a channel name", f"found {name!r}", remedy)
