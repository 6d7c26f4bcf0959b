"""Lines and files of each room of the house, held against budget.toml beside this file.

    python tests/house/budget.py [--target]

A room owns the files that its patterns name. Lines of Python and lines of other texts (templates, TOML, tables) are
counted apart, so that nothing shrinks by moving from one to the other. The exit code is 1 where a file has no room or
a room has more than it may (with --target: more than its target).
"""

import sys
import tomllib
from fnmatch import fnmatchcase
from pathlib import Path
from typing import Any, NamedTuple

CHECKOUT = Path(__file__).parents[2]
TEXTS = frozenset((".css", ".csv", ".j2", ".js", ".json", ".pyi", ".toml", ".typ", ".bib"))
Rooms = dict[str, dict[str, Any]]


class Size(NamedTuple):
    """Of a room: lines of Python, lines of other texts, files of Python."""

    lines: int = 0
    texts: int = 0
    files: int = 0


def read_rooms() -> tuple[Rooms, dict[str, int]]:
    """Each room with its files and limits, and the limits of all of gaitdisc/ together."""
    table = tomllib.loads(Path(__file__).with_name("budget.toml").read_text(encoding="utf-8"))
    return {name: room for name, room in table.items() if name != "whole"}, table["whole"]


def measure(rooms: Rooms) -> tuple[dict[str, Size], list[str]]:
    """Size of each room, and the files that are in none."""
    owner = {pattern: name for name, room in rooms.items() for pattern in room["files"]}
    sizes, homeless = dict.fromkeys(rooms, Size()), []
    tops = ("gaitdisc", "studies", "tests", "data_schema")
    for path in sorted(path for top in tops for path in (CHECKOUT / top).rglob("*")):
        python = path.suffix == ".py"
        if not (python or path.suffix in TEXTS):
            continue
        place = path.relative_to(CHECKOUT).as_posix()
        fitting = [pattern for pattern in owner if fnmatchcase(place, pattern)]
        if not fitting:
            homeless.append(f"{place}: in no room")
            continue
        name = owner[max(fitting, key=len)]
        if not (python or rooms[name].get("package", True)):  # tables of studies and tests are data
            continue
        lines, size = path.read_text(encoding="utf-8").count("\n"), sizes[name]
        sizes[name] = Size(size.lines + lines * python, size.texts + lines * (not python), size.files + python)
    return sizes, homeless


def list_excess(sizes: dict[str, Size], rooms: Rooms, key: str = "now") -> list[str]:
    """Rooms with more lines than their table says, in words."""
    rows = [(name, "lines of Python", sizes[name].lines, room[key]) for name, room in rooms.items()]
    rows += [(name, "lines of other texts", sizes[name].texts, room.get("texts", 0)) for name, room in rooms.items()]
    return [f"{name}: {lines} {kind}, {limit} allowed" for name, kind, lines, limit in rows if lines > limit]


def sum_package(sizes: dict[str, Size], rooms: Rooms) -> Size:
    """Size of gaitdisc/ and of the tables that the wheel carries."""
    package = [sizes[name] for name, room in rooms.items() if room.get("package", True)]
    return Size(*map(sum, zip(*package, strict=True)))


if __name__ == "__main__":
    rooms, whole = read_rooms()
    sizes, homeless = measure(rooms)
    rows = {name: (*sizes[name], rooms[name]["now"], rooms[name]["target"]) for name in rooms}
    targets = sum(room["target"] for room in rooms.values() if room.get("package", True))
    rows["gaitdisc/"] = (*sum_package(sizes, rooms), whole["now"], targets)
    for name, row in {"room": ("lines", "texts", "files", "now", "target"), **rows}.items():
        print(f"{name:13}" + "".join(f"{cell:>9}" for cell in row))
    sys.exit("\n".join(homeless + list_excess(sizes, rooms, "target" if "--target" in sys.argv else "now")) or 0)
