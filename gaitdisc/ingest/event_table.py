"""Events of a walk from a table of their own: a row an event, or a column a kind of event."""

from __future__ import annotations

import csv
import re
from collections.abc import Sequence

from gaitdisc.errors import ReadError
from gaitdisc.ingest.c3d_labels import FOOT_OFF, INITIAL_CONTACT, event_kind
from gaitdisc.recording.trial import Event

LEADING = 10  # lines above the header
STEPS = (INITIAL_CONTACT, FOOT_OFF)
_KIND = ("name", "event", "label", "type", "event name", "event type")
_SIDE = ("context", "side", "foot", "leg")
_TIME = re.compile(r"(?:event )?times?(?:_| )?[\[(]?(s|ms|sec|seconds)?[\])]?")


def read_events(lines: Sequence[str], file: str) -> tuple[Event, ...]:
    r"""Contacts and foot offs of a table; none of a table that is not one of events.

    A row an event: columns `time` [s] (or ms), `event` and, where the event's own name does not say it, `side`, in any
    order and under the names that laboratories and exports give them. A column a kind: `LHS`, `RTO` or `Left Foot
    Strike` above times [s].

    >>> read_events(["Subject,Context,Name,Time (s)", "A,Left,Foot Strike,0.52", "A,Left,Foot Off,1.21"], "a.csv")[0]
    Event(label='initial contact', side='l', time=0.52)
    >>> read_events(["LHS\tRTO", "0.52\t0.64"], "a.tsv")[1]
    Event(label='foot off', side='r', time=0.64)
    """
    for top, line in enumerate(lines[:LEADING]):
        for separator in ",;\t" if line.strip() else "":
            header = next(csv.reader([line], delimiter=separator))
            labels = [re.sub(r"\s+", " ", cell).strip().lower() for cell in header]
            rows = enumerate(csv.reader(lines[top + 1 :], delimiter=separator), top + 2)
            kinds = [event_kind(label, "") for label in labels]
            named, aside = (next((i for i, one in enumerate(labels) if one in words), -1) for words in (_KIND, _SIDE))
            timed = next((i for i, label in enumerate(labels) if _TIME.fullmatch(label)), -1)
            cells: list[tuple[int, str, str, str]] = []  # line, kind, side and time of each event
            if all(kind in STEPS for kind, _ in kinds):
                cells = [(n, *kind, cell) for n, row in rows for kind, cell in zip(kinds, row, strict=False)]
            elif min(named, timed) >= 0:
                whole = ((n, row) for n, row in rows if len(row) >= len(labels))
                cells = [(n, *event_kind(row[named], row[aside] if aside >= 0 else ""), row[timed]) for n, row in whole]
            if any(kind in STEPS for _, kind, _, _ in cells):
                unit_s = 1e-3 if timed >= 0 and "ms" in labels[timed] else 1.0
                steps = (cell for cell in cells if cell[1] in STEPS and cell[3].strip())
                return tuple(_event(*cell, unit_s, file) for cell in steps)
    return ()


def _event(line: int, kind: str, side: str, text: str, unit_s: float, file: str) -> Event:
    where = f"{file}, line {line}"
    if not side:
        remedy = "Write l or r in a column 'side', or 'Left' before the event."
        raise ReadError(f"{where}: each {kind} must have a side", "it has none", remedy)
    try:
        return Event(kind, side, unit_s * float(text.replace(",", ".")))
    except ValueError as error:
        needed = f"{where}: the time of an event must be a number"
        raise ReadError(needed, f"found {text[:40]!r}", "Write seconds, such as 1.23.") from error
