"""TOML that a person wrote: parsed, and refused where it is nested too deep; and texts as it has them."""

import json
import re
import tomllib
from typing import Any

DEEPEST = 40  # tables in tables; the parser and all who walk its answer call themselves once a level
_MANY_DOTS = re.compile(rf"(?:\.[^.\n]{{0,80}}){{{DEEPEST}}}")
_NO_KEYS = re.compile(r"\d\.\d|#.*|\"[^\"\n]*\"|'[^'\n]*'")


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
