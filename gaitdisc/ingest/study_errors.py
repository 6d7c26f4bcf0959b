"""What is wrong with a study file, said with its file, line, key, what was found and what to do."""

from __future__ import annotations

import re
import typing
from collections.abc import Iterator, Mapping, Sequence
from typing import Any

from pydantic import BaseModel, ValidationError

from gaitdisc.channel import nearest_word
from gaitdisc.errors import SchemaError

_KINDS = {
    "float": ("be a number", "Write it without quotes, for example 6.0."),
    "int": ("be a whole number", "Write it without quotes and without a point, for example 4."),
    "string": ("be text", 'Write it in quotes: "...".'),
    "tuple": ("be a list", "Write it in brackets: [...]."),
    "model": ("be a table", "Write its keys under a header in brackets."),
    "dict": ("be a table", "Write its keys under a header in brackets."),
}
_OTHERS = {
    "finite_number": ("be a finite number", "Write a number."),
    "too_short": ("not be empty", "Fill it in, or take the key away."),
    "too_long": ("have fewer entries", "Take some away."),
    "string_too_short": ("not be empty", "Fill it in, or take the key away."),
    "string_too_long": ("be shorter", "Use at most 40 characters."),
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


def schema_error(error: ValidationError, model: type[BaseModel], text: str, file: str) -> SchemaError:
    """Sentence for the first of pydantic's findings, with the count of the others."""
    findings = [
        each
        for each in error.errors(include_url=False)  # a list is called too short, too, when an entry of it was refused
        if each["type"] != "too_short" or each.get("ctx", {})["actual_length"] >= len(each["input"])
    ]
    first = min(findings, key=lambda each: (each["type"] != "extra_forbidden", line_of(text, _place(each)) or 0))
    place = _place(first)
    line = line_of(text, place)
    where = file if line is None else f"{file}, line {line}"
    needed, found, remedy = _sentence(first, place, model)
    if len(findings) > 1:
        remedy += f" ({len(findings) - 1} more to correct after this.)"
    return SchemaError(f"{where}: {needed}", found, remedy)


def _place(finding: Mapping[str, Any]) -> Place:
    return (*finding["loc"], *finding.get("ctx", {}).get("place", ()))


def _sentence(finding: Mapping[str, Any], place: Place, model: type[BaseModel]) -> tuple[str, str, str]:
    kind, given, context = finding["type"], finding.get("input"), finding.get("ctx", {})
    if kind == "extra_forbidden":
        return _unknown_key(place, model)
    if kind == "missing" and isinstance(place[-1], int):
        return f"{_named(place[:-1])} needs {place[-1] + 1} or more entries", f"found {place[-1]}", "Add the other."
    if kind == "missing":
        remedy = f"Add {place[-1]} ({_about(place, model)})."
        return f"{_table(place[:-1])} needs {place[-1]!r}", "it is absent", remedy
    if kind == "gaitdisc":
        return f"{_named(place)} needs {context['needed']}", context["found"], context["remedy"]
    found = f"found {given!r}" if isinstance(given, str | int | float) else f"found {_what(given)}"
    wanted, remedy = _wanted(kind, given, context)
    if kind == "tuple_type" and isinstance(given, dict):
        remedy = f"Write its header in two pairs of brackets: [[{place[-1]}]]."
    return f"{_named(place)} must {wanted or finding['msg']}", found, remedy


def _wanted(kind: str, given: Any, context: Mapping[str, Any]) -> tuple[str, str]:
    """What a value must be, and what to do about it."""
    wanted, remedy = "", "Correct it."
    if kind in _LIMITS:
        word, key = _LIMITS[kind]
        wanted, remedy = f"be {word} {context[key]:g}", "Correct the number."
    elif kind == "literal_error":
        words = str(context["expected"])
        nearest = nearest_word(str(given), [word.strip(" '") for word in words.replace(" or ", ",").split(",")])
        wanted, remedy = f"be one of {words}", f"Did you mean {nearest!r}?" if nearest else "Choose one of them."
    elif kind == "string_pattern_mismatch":
        wanted = "be a pseudonym: letters, digits, _ and -, at most 16"
        remedy = "Use for example P01, and keep names out of the study."
    elif kind in _OTHERS:
        wanted, remedy = _OTHERS[kind]
    else:
        wanted, remedy = next((words for key, words in _KINDS.items() if kind.startswith(key)), (wanted, remedy))
    return wanted, remedy


def _unknown_key(place: Place, model: type[BaseModel]) -> tuple[str, str, str]:
    owner = _part(place[:-1], model)
    keys = list(owner.model_fields) if owner else []
    nearest = nearest_word(str(place[-1]), keys)
    needed = f"the keys of {_table(place[:-1])} are {', '.join(keys)}"
    return needed, f"{place[-1]!r} is not known", f"Did you mean {nearest!r}?" if nearest else "Remove it."


def _named(place: Place) -> str:
    if not place:
        return "the study"
    if isinstance(place[-1], int):
        return f"{_named(place[:-1])}, entry {place[-1] + 1},"
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
    return next((found for inner in typing.get_args(annotation) if (found := _model_in(inner))), None)


def _what(given: Any) -> str:
    if isinstance(given, list | tuple):
        return f"a list of {len(given)}"
    return "a table" if isinstance(given, dict) else "nothing" if given is None else repr(given)


def line_of(text: str, place: Place) -> int | None:
    r"""Line of a key, or of the table it belongs to where the key itself is absent.

    returns: counted from 1; None where not even the table is there

    >>> line_of("title = 'x'\n[filters]\norder = 3\n", ("filters", "order"))
    3
    """
    best, deepest = None, 0
    for found, line in _places(text):
        depth = _shared(found, place)
        if depth == len(found) and depth > deepest:
            best, deepest = line, depth
    return best


def _places(text: str) -> Iterator[tuple[Place, int]]:
    table: Place = ()
    counts: dict[Place, int] = {}
    for line, words in enumerate(text.split("\n"), 1):
        header, pair = _TABLE.match(words), _PAIR.match(words)
        if header:
            table = _resolved(_keys(header[2]), counts)
            if header[1] == "[[":
                counts[table] = counts.get(table, -1) + 1
                table = (*table, counts[table])
            yield table, line
        elif pair:
            yield (*table, *_keys(pair[1])), line


def _resolved(keys: Sequence[str], counts: dict[Place, int]) -> Place:
    """Path of a table, with the place in each array of tables on the way to it."""
    place: Place = ()
    for i, key in enumerate(keys):
        place = (*place, key)
        if place in counts and i < len(keys) - 1:
            place = (*place, counts[place])
    return place


def _keys(dotted: str) -> list[str]:
    return [key.strip("\"'") for key in re.findall(_KEY, dotted)]


def _shared(one: Place, other: Place) -> int:
    return next((i for i, (a, b) in enumerate(zip(one, other, strict=False)) if a != b), min(len(one), len(other)))
