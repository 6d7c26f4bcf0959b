"""In which line of a TOML file a key stands; the parser of the standard library does not say."""

from __future__ import annotations

import re
from collections.abc import Iterator, Sequence

Place = tuple[str | int, ...]
_KEY = r"""(?:"[^"]*"|'[^']*'|[A-Za-z0-9_-]+)"""
_DOTTED = rf"{_KEY}(?:\s*\.\s*{_KEY})*"
_TABLE = re.compile(rf"\s*(\[\[?)\s*({_DOTTED})\s*\]\]?")
_PAIR = re.compile(rf"\s*({_DOTTED})\s*=")


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
