"""Which criteria of `gaitdisc discover` decide anything: each is moved alone, over made cases and real records.

    python benchmarks/criteria.py CASES [CASES ...] [--out criteria.jsonl] [--limit 120]

Each of CASES is a folder with simulation.toml and measured.csv. Each criterion (gaitdisc/discovery/criteria.py) is
doubled and halved; of a factor above 1, its excess. What is fitted is kept, so that deciding once more costs little.
OUT gets one line a case, and a case that stands there is not run again; the table counts the cases whose answer
(verdict, names, places) changes. Times of a case are those of this machine and no figure.
"""

from __future__ import annotations

import sys
from pathlib import Path

sys.path.insert(0, str(Path(__file__).parents[1] / "studies"))
from command_line import argument, command_line

GIVEN = command_line(
    __name__,
    __doc__,
    argument("cases", "folders of cases", [Path("cases")]),
    argument("--out", "one line a case", Path("criteria.jsonl")),
    argument("--limit", "seconds for one answer", 120),
)  # before the slow imports

import hashlib
import importlib
import json
import pkgutil
import signal
import time
from collections.abc import Callable, Iterator, Mapping
from dataclasses import fields, is_dataclass
from functools import wraps
from typing import Any

import numpy as np
import pandas as pd

import gaitdisc as gd
import gaitdisc.discovery
from gaitdisc.discovery.criteria import CRITERIA
from gaitdisc.discovery.linearised import Linearised
from gaitdisc.discovery.score import Scorer
from gaitdisc.discovery.shooting import Shooting

METHODS = {Shooting: ("fitted",), Scorer: ("scores", "leave_out_each"), Linearised: ("first_growth",)}
FUNCTIONS = {
    "linearised": ("linearise", "linearise_along"),
    "process_noise": ("rank_process_noise",),
    "estimated_filter": ("find_record_filter",),
    "first_states": ("guess_states",),
    "matched": ("idle_parts",),
}  # none of which reads a criterion
ABOVE_ONE = ("mere_noise", "autocorrelated", "agrees", "follows", "unlike", "apart")
BELOW_ONE = ("reading",)
TURNS = {"half": 0.5, "double": 2.0}

kept: dict[tuple[str, ...], Any] = {}
known: dict[int, tuple[object, str]] = {}  # the object itself, so that its number is not given to another


class LateError(Exception):
    """An answer took longer than the limit."""


def digest(value: object) -> str:
    """What a value is, in a few letters; that of a large object is computed once."""
    if id(value) in known and known[id(value)][0] is value:
        return known[id(value)][1]
    if isinstance(value, np.ndarray):
        parts = [str(value.dtype), str(value.shape), hashlib.sha1(np.ascontiguousarray(value).tobytes()).hexdigest()]
    elif is_dataclass(value):
        named = [one.name for one in fields(value) if one.name != "progress"]
        parts = [type(value).__name__, *(digest(getattr(value, name)) for name in named)]
    elif isinstance(value, Mapping):
        parts = [f"{digest(key)}:{digest(one)}" for key, one in value.items()]
    elif isinstance(value, (tuple, list, frozenset, set)):
        parts = [*map(digest, value)] if isinstance(value, (tuple, list)) else sorted(map(digest, value))
    elif (simulation := getattr(value, "simulation", None)) is not None:
        parts = [digest(simulation)]
    else:
        return repr(value)
    found = hashlib.sha1("|".join(parts).encode()).hexdigest()
    if is_dataclass(value):
        known[id(value)] = (value, found)
    return found


def keep(place: object, name: str) -> None:
    """Let a function keep what it computed."""
    computed: Callable[..., object] = getattr(place, name)

    @wraps(computed)
    def looked_up(*given: object, **named: object) -> object:
        key = (name, *map(digest, given), *(f"{one}={digest(value)}" for one, value in sorted(named.items())))
        if key not in kept:
            kept[key] = computed(*given, **named)
        return kept[key]

    modules = (one.name for one in pkgutil.iter_modules(gaitdisc.discovery.__path__))
    rooms = [importlib.import_module(f"gaitdisc.discovery.{one}") for one in modules]
    for room in (place, *rooms):
        if getattr(room, name, None) is computed:
            setattr(room, name, looked_up)


def answered(case: Path) -> list[str]:
    """Verdict, names and places; `late` or the refusal where there is none."""

    def late(*_: object) -> None:
        raise LateError

    signal.signal(signal.SIGALRM, late)
    signal.alarm(GIVEN.limit)
    try:
        found, _ = gd.discover(case / "simulation.toml", case / "measured.csv", progress=lambda _: None)
        return [found.verdict, *sorted(f"{one.name}@{one.place}" for one in found.effects)]
    except LateError:
        return ["late"]
    except (gd.GaitdiscError, np.linalg.LinAlgError, ValueError) as error:
        return [f"{type(error).__name__}: {error}"[:80]]
    finally:
        signal.alarm(0)


def moved() -> Iterator[tuple[str, str, float]]:
    """Yield each criterion, how it is moved, and its value then."""
    for one in fields(CRITERIA):
        value = getattr(CRITERIA, one.name)
        for how, factor in TURNS.items():
            if one.name in ABOVE_ONE:
                yield one.name, how, 1 + (value - 1) * factor
            elif one.name in BELOW_ONE:
                yield one.name, how, 1 - (1 - value) * factor
            else:
                yield one.name, how, value * factor


def run(case: Path) -> dict[str, Any]:
    """Answer a case as it is and under each criterion moved alone."""
    kept.clear()
    known.clear()
    began = time.perf_counter()
    plain = answered(case)
    changed = {}
    for name, how, value in moved() if plain != ["late"] else ():
        usual = getattr(CRITERIA, name)
        object.__setattr__(CRITERIA, name, value)
        try:
            now = answered(case)
        finally:
            object.__setattr__(CRITERIA, name, usual)
        if now != plain:
            changed[f"{name} {how}"] = now
    return {"case": str(case), "answer": plain, "changed": changed, "seconds": time.perf_counter() - began}


def table(rows: list[dict[str, Any]]) -> pd.DataFrame:
    """Count the cases whose answer each criterion changes, and name them."""
    some = [row for row in rows if row["answer"] != ["late"]]
    lines = []
    for one in fields(CRITERIA):
        of = {how: [Path(row["case"]).name for row in some if f"{one.name} {how}" in row["changed"]] for how in TURNS}
        counts = {how: len(names) for how, names in of.items()}
        which = " ".join(sorted({*of["half"], *of["double"]}))
        lines.append({"criterion": one.name, "value": getattr(CRITERIA, one.name), **counts, "cases": which})
    print(f"{len(some)} cases, {len(rows) - len(some)} late")
    return pd.DataFrame(lines)


if __name__ == "__main__":
    for place, names in METHODS.items():
        for name in names:
            keep(place, name)
    for room, names in FUNCTIONS.items():
        for name in names:
            keep(importlib.import_module(f"gaitdisc.discovery.{room}"), name)
    done = [json.loads(line) for line in GIVEN.out.read_text().splitlines()] if GIVEN.out.exists() else []
    for number, case in enumerate(GIVEN.cases):
        if str(case) not in {row["case"] for row in done}:
            done.append(run(case))
            with GIVEN.out.open("a") as file:
                file.write(json.dumps(done[-1]) + "\n")
            print(f"{number + 1} of {len(GIVEN.cases)}, {done[-1]['seconds']:.0f} s: {case.name}", flush=True)
    print(table(done).to_string(index=False))
