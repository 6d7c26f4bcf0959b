"""TOML that a person wrote: read, parsed, and refused where it is nested too deep; and texts as it has them."""

from __future__ import annotations

import json
import re
import tomllib
from pathlib import Path
from typing import Any

from gaitdisc.errors import MissingFileError, ReadError, SchemaError
from gaitdisc.regular_file import check_regular, size_in_words

LARGEST_BYTES = 2**20  # of what a person writes
DEEPEST = 40  # tables in tables; the parser and all who walk its answer call themselves once a level
_MANY_DOTS = re.compile(rf"(?:\.[^.\n]{{0,80}}){{{DEEPEST}}}")
_NO_KEYS = re.compile(r"\d\.\d|#.*|\"[^\"\n]*\"|'[^'\n]*'")


def read_toml(path: Path, needed: str, remedy: str) -> tuple[str, dict[str, Any]]:
    """Text and table of a TOML file; `needed` says in a refusal what the file must be, `remedy` what to do about it."""
    text = read_text(path, needed)
    try:
        return text, parse_toml(text)
    except ValueError as error:
        raise SchemaError(needed, f"{path.name}: {error}", remedy) from error


def read_text(path: Path, needed: str) -> str:
    """Text of a file that a person wrote, with the ends of its lines as they are."""
    try:
        size = check_regular(path)
        if size > LARGEST_BYTES:
            found = f"{path.name} has {size_in_words(size)}, more than {size_in_words(LARGEST_BYTES)}"
            raise ReadError(needed, found, "Check the path, or shorten the file.")
        return path.read_bytes().decode("utf-8-sig")
    except OSError as error:
        kind = MissingFileError if isinstance(error, FileNotFoundError) else ReadError
        raise kind(needed, f"{path.name}: {error.strerror or error}", "Check the path.") from error
    except UnicodeDecodeError as error:
        found = f"{path.name} is not UTF-8 text: it has an invalid byte at offset {error.start}"
        raise ReadError(needed, found, "Save it as UTF-8.") from error


def parse_toml(text: str) -> dict[str, Any]:
    r"""Table of a TOML text.

    >>> parse_toml("[filters]\norder = 4")
    {'filters': {'order': 4}}
    >>> parse_toml("a = " + "[" * 50 + "]" * 50)
    Traceback (most recent call last):
    ...
    tomllib.TOMLDecodeError: tables or lists are nested more than 40 levels deep
    """
    if _MANY_DOTS.search(_NO_KEYS.sub("", text)):
        raise tomllib.TOMLDecodeError(f"a key has more than {DEEPEST} parts")
    too_deep = f"tables or lists are nested more than {DEEPEST} levels deep"
    try:
        table = tomllib.loads(text)
    except (RecursionError, MemoryError) as error:
        raise tomllib.TOMLDecodeError(too_deep) from error
    level: list[Any] = [table]
    for _ in range(DEEPEST):
        level = [inner for node in level for inner in (node.values() if isinstance(node, dict) else node)
                 if isinstance(inner, dict | list)]  # fmt: skip
        if not level:
            return table
    raise tomllib.TOMLDecodeError(too_deep)


def quote(text: str) -> str:
    r"""Text as a basic string of TOML; JSON's escapes are among TOML's.

    >>> print(quote('a "b"\\'))
    "a \"b\"\\"
    """
    return json.dumps(text, ensure_ascii=False).replace("\x7f", "\\u007f")
