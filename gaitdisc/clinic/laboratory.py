"""What a laboratory says of its pages and people: `clinic.toml`."""

import csv
from collections.abc import Mapping
from dataclasses import dataclass, field
from functools import cache
from pathlib import Path
from typing import Any

from gaitdisc.channel import schema_folder
from gaitdisc.errors import SchemaError
from gaitdisc.processing.leg_curves import BY_NAME
from gaitdisc.report.figure import data_uri
from gaitdisc.toml_text import parse_toml

FILE, TABLE = "clinic.toml", "clinical_axes.csv"
LARGEST_LOGO = 2**19  # [bytes] a page stays one file that can be mailed
LONGEST = 1000  # letters of a comment
PICTURES = {b"\x89PNG": "png", b"\xff\xd8\xff": "jpeg"}  # by their first bytes
FORM = f"{FILE} may have only laboratory, logo, pdf, [axes], and tables such as [people.P07] with affected and comment"
KINDS: dict[str, type] = {"laboratory": str, "logo": str, "pdf": bool, "axes": dict, "people": dict}
AFFECTED = ("left", "right", "both")
Axes = Mapping[str, tuple[float, float]]


@cache
def clinical_axes() -> Axes:
    """Ends of the axis of every curve, the same on all pages: `data_schema/clinical_axes.csv`.

    >>> clinical_axes()["knee_flexion"]
    (-15.0, 75.0)
    """
    with (schema_folder() / TABLE).open(encoding="utf-8", newline="") as file:
        return {row["variable"]: (float(row["low"]), float(row["high"])) for row in csv.DictReader(file)}


@dataclass(frozen=True)
class Laboratory:
    """Name and logo of a laboratory, its axes, and what it says of its people."""

    name: str = ""
    logo: str = ""  # as a data: address
    pdf: bool = False  # whether a run writes PDF too
    axes: Axes = field(default_factory=clinical_axes)
    affected: Mapping[str, str] = field(default_factory=dict)  # pseudonym -> side
    comments: Mapping[str, str] = field(default_factory=dict)  # pseudonym -> what the laboratory says


def load_laboratory(run_folder: Path) -> Laboratory:
    """Laboratory of a run: its `clinic.toml`, or the one beside the study file above; the package's own without one."""
    path = next((file for file in (run_folder / FILE, run_folder.parent / FILE) if file.is_file()), None)
    if path is None:
        return Laboratory()
    try:
        data = parse_toml(path.read_text(encoding="utf-8"))
    except (ValueError, OSError) as error:
        raise SchemaError(f"{FILE} must be a TOML file", f"found: {str(error)[:200]}", "Correct the file.") from error
    for key, value in data.items():
        if key not in KINDS or not isinstance(value, KINDS[key]):
            raise _refusal(f"{key} = {str(value)[:60]!r}")
    people = data.get("people", {})
    for person, note in people.items():
        comment = note.get("comment", "") if isinstance(note, dict) and note.keys() <= {"affected", "comment"} else None
        if not isinstance(comment, str) or len(comment) > LONGEST or note.get("affected", "left") not in AFFECTED:
            raise _refusal(f"[people.{person}] {str(note)[:80]}")
    notes: dict[str, dict[str, str]] = {
        word: {who: note[word] for who, note in people.items() if word in note} for word in ("affected", "comment")
    }
    axes = {**clinical_axes(), **{name: _ends(name, ends) for name, ends in data.get("axes", {}).items()}}
    logo = _picture(path.parent / data["logo"]) if data.get("logo") else ""
    name = str(data.get("laboratory", ""))
    return Laboratory(name, logo, bool(data.get("pdf", False)), axes, notes["affected"], notes["comment"])


def _ends(name: str, ends: Any) -> tuple[float, float]:
    numbers = isinstance(ends, list) and len(ends) == 2 and all(isinstance(end, int | float) for end in ends)
    if name not in BY_NAME or not numbers or not ends[0] < ends[1]:
        raise SchemaError(
            f"each axis must be given by one of {', '.join(BY_NAME)} and its two ends, the lower first",
            f"{FILE}, [axes]: {name} = {str(ends)[:60]}",
            "Write, for example, knee_flexion = [-15, 75].",
        )
    return float(ends[0]), float(ends[1])


def _picture(path: Path) -> str:
    content = path.read_bytes()[: LARGEST_LOGO + 1] if path.is_file() else b""
    kind = next((kind for start, kind in PICTURES.items() if content.startswith(start)), None)
    if kind is None or len(content) > LARGEST_LOGO:
        raise SchemaError(
            f"a logo must be a PNG or JPEG file in the folder of {FILE}, of at most {LARGEST_LOGO // 1024} KiB",
            f"{path.name} is missing, larger, or of another format",
            "Save the logo again.",
        )
    return data_uri(kind, content)


def _refusal(mistake: str) -> SchemaError:
    return SchemaError(FORM, f"found {mistake}", f"Correct the line. Words for affected: {', '.join(AFFECTED)}.")
