"""Header of an OpenSim storage file (`.mot`, `.sto`), modern or of the old SIMM style, or both at once."""

from __future__ import annotations

import re
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field

from gaitdisc.channel import nearest_word
from gaitdisc.errors import ReadError
from gaitdisc.ingest.columns import split_unit

_YES_NO = {"yes": True, "y": True, "true": True, "1": True, "no": False, "n": False, "false": False, "0": False}
_ROWS, _COLUMNS = ("nrows", "datarows"), ("ncolumns", "datacolumns")
_OWN_COLUMN = re.compile(r"column\s+(\d+)\s*=\s*(\w+)\s*\[([^\]]*)\]\s*(r|l|)\s*", re.IGNORECASE)


@dataclass(frozen=True)
class StorageHeader:
    """What stands above the numbers."""

    title: str  # first line: `Coordinates`, `Inverse Dynamics Generalized Forces`, or any name
    labels: tuple[str, ...]
    body_line: int  # line in which the numbers start, counted from 1
    degrees: bool | None = None  # what `inDegrees` states; None where it is absent
    rows: tuple[int, ...] = ()  # counts that the header claims; two of a kind where both styles stand in it
    columns: tuple[int, ...] = ()  # counts that the header claims; two of a kind where both styles stand in it
    # dict of int to (str, str, str), column -> quantity, unit and side, in files that `write_storage` wrote
    own: Mapping[int, tuple[str, str, str]] = field(default_factory=dict)
    separator: str = "\t"  # what stands between cells: a tab, or a blank for any run of blanks


def parsed_header(lines: Sequence[str], file: str) -> StorageHeader:
    r"""Header of a storage file.

    >>> lines = ["Coordinates", "nRows=1", "inDegrees=yes", "endheader", "time\tknee_angle_r", "0\t1"]
    >>> h = parsed_header(lines, "a.mot")
    >>> h.degrees, h.labels, h.body_line
    (True, ('time', 'knee_angle_r'), 6)
    """
    end = next((i for i, line in enumerate(lines) if line.strip().lower() == "endheader"), None)
    if end is None:
        raise ReadError(
            f"{file} should be an OpenSim storage file, whose header ends with the line 'endheader'",
            f"none of its {len(lines)} lines is that" + _near_endheader(lines),
            "Export it again from OpenSim, or rename it to .csv if it is a plain table.",
        )
    keys = list(_keys(lines[:end], file))
    at = next((i for i in range(end + 1, len(lines)) if lines[i].strip()), None)
    labels_line = lines[at].strip() if at is not None else ""
    separator = "\t" if "\t" in labels_line else " "
    labels = [label.strip() for label in (labels_line.split("\t") if separator == "\t" else labels_line.split())]
    if at is None or not labels or labels[0].lower() != "time":
        raise ReadError(
            f"{file} needs a line of labels after 'endheader', the first of them 'time'",
            f"line {(at or end) + 1} begins with {(labels[0][:40] if labels else '')!r}",
            "Export it again, or write the labels there.",
        )
    names = [split_unit(label)[0] for label in labels]
    if len(labels) < 2 or not all(names):
        blank = f"label {names.index('') + 1} is blank" if "" in names else "there is time alone"
        raise ReadError(f"{file} needs a label for every column", f"line {at + 1}: {blank}", "Name the column.")
    return StorageHeader(
        title=next((line.strip() for line in lines[:end] if line.strip()), ""),
        labels=tuple(labels),
        body_line=at + 2,
        degrees=next((bool(value) for key, value in keys if key == "indegrees"), None),
        rows=tuple(int(value) for key, value in keys if key in _ROWS),
        columns=tuple(int(value) for key, value in keys if key in _COLUMNS),
        own=_own_columns(lines[:end]),
        separator=separator,
    )


def _keys(lines: Sequence[str], file: str):
    for number, line in enumerate(lines, 1):
        key, sign, value = line.partition("=")
        if not sign:
            key, _, value = line.strip().partition(" ")  # SIMM: `datarows 4610`
        key, value = key.strip().lower(), value.strip()
        if key in (*_ROWS, *_COLUMNS) and (sign or value):
            if not re.fullmatch(r"\d{1,12}", value):
                raise ReadError(
                    f"{file}: line {number} needs a whole number after {key!r}",
                    f"found {value[:40]!r}",
                    "Write the count, or take the line away.",
                )
            yield key, int(value)
        elif key == "indegrees" and sign:
            if value.lower() not in _YES_NO:
                raise ReadError(
                    f"{file}: line {number} needs inDegrees=yes or inDegrees=no",
                    f"found {value[:40]!r}",
                    "Write yes where the angles are in degrees, no where they are in radians.",
                )
            yield key, _YES_NO[value.lower()]


def _own_columns(lines: Sequence[str]) -> dict[int, tuple[str, str, str]]:
    found = (_OWN_COLUMN.fullmatch(line.strip()) for line in lines)
    return {int(m[1]): (m[2], m[3], m[4].lower()) for m in found if m}


def _near_endheader(lines: Sequence[str]) -> str:
    nearest = nearest_word("endheader", [line.strip() for line in lines[:60] if len(line) < 30])
    return f", the nearest is {nearest!r}" if nearest else ""
