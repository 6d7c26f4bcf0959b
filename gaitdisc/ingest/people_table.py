"""Who was measured: a table beside the recordings with mass, sex, stature and age of each person, BIDS's among them."""

from __future__ import annotations

import csv
import math
import re
from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Literal

from gaitdisc.errors import GaitdiscError
from gaitdisc.ingest.columns import split_unit
from gaitdisc.ingest.raw_file import read_raw
from gaitdisc.recording.body_measures import LENGTHS_M, MASS_KG
from gaitdisc.spreadsheet import unquoted

TABLES = ("participants", "subjects", "patients", "people", "persons", "demographics", "anthropometry", "manifest")
LARGEST_BYTES = 2**22
_IDS = ("participantid", "subjectid", "patientid", "personid", "id", "participant", "subject", "patient", "person",
        "pseudonym", "code")  # fmt: skip
_MASSES = ("masskg", "mass", "bodymass", "bodymasskg", "weight", "weightkg", "bodyweight", "bodyweightkg")
_SEXES = ("sex", "gender")
_STATURES = ("heightm", "height", "heightcm", "heightmm", "stature", "staturem", "staturecm", "staturemm", "bodyheight")
_AGES = ("age", "ageyears", "ageyear", "ageyr", "ageyrs", "agey", "age in years", "age in y", "age in yr")
OLDEST_YEARS = 120
Sex = Literal["", "f", "m"]
_MISSING = ("", "n/a", "na", "nan", "none", "null", "-", "unknown")
_SEX: dict[str, Sex] = {
    **dict.fromkeys(("f", "female", "woman", "girl", "w"), "f"),
    **dict.fromkeys(("m", "male", "man", "boy"), "m"),
}
_METRES = {"m": 1.0, "cm": 1e-2, "mm": 1e-3}


@dataclass(frozen=True)
class Measured:
    """What a table says of a person; None or empty where it says nothing."""

    mass_kg: float | None = None  # body mass [kg] and stature [m]
    height_m: float | None = None  # body mass [kg] and stature [m]
    sex: Sex = ""
    age_years: int | None = None  # whole years; a date of birth is never read


def is_people_table(path: Path) -> bool:
    """Whether a file's name is that of a table of people: `participants.tsv`, `manifest.csv` and the like.

    >>> is_people_table(Path("raw/participants.tsv")), is_people_table(Path("S01/walk.csv"))
    (True, False)
    """
    return path.suffix.lower() in (".csv", ".tsv") and path.stem.lower() in TABLES


def measured_people(folder: Path, files: Iterable[Path], notes: list[str]) -> dict[str, Measured]:
    """Mass, sex, stature, age by a person's folded word, from tables of people; what was taken is added to `notes`."""
    found: dict[str, Measured] = {}
    for file in sorted(files):
        try:
            read = _read(read_raw(folder / file, LARGEST_BYTES).lines(), file.as_posix(), notes)
        except (GaitdiscError, csv.Error) as error:
            notes.append(f"left out: {file.as_posix()}: {error}")
            continue
        for word, one in read.items():
            before = found.setdefault(word, one)
            if before != one:
                notes.append(f"{file.as_posix()}: {word!r} differs from another table, which counts")
    return found


def person_key(word: str) -> str:
    """Word by which a row of a table and a folder of recordings are the same person.

    >>> person_key("sub-01"), person_key("S_07 ")
    ('01', 's07')
    """
    return re.sub(r"[^a-z0-9]", "", re.sub(r"^(sub|subject|participant)[-_ ]", "", word.strip().lower()))


def _read(lines: Sequence[str], file: str, notes: list[str]) -> dict[str, Measured]:
    rows = list(csv.reader(lines, delimiter=max("\t;,", key=lines[0].count)))
    labels = [unquoted(label.strip()) for label in rows[0]]
    at = {
        key: next((i for word in words for i, label in enumerate(labels) if _folded(label) == word), None)
        for key, words in (("id", _IDS), ("mass", _MASSES), ("sex", _SEXES), ("height", _STATURES), ("age", _AGES))
    }
    if at["id"] is None or all(at[key] is None for key in ("mass", "sex", "height", "age")):
        notes.append(
            f"{file} holds no column for who (such as participant_id) beside one of mass_kg, sex, height_m, age: "
            f"its columns are {', '.join(labels[:8])}"
        )
        return {}
    found: dict[str, list[Measured]] = {}
    for number, row in enumerate(rows[1:], 2):
        cells = {key: row[i].strip() if i is not None and i < len(row) else "" for key, i in at.items()}
        if cells["id"]:
            where = f"{file}, line {number}"
            age = _within(cells["age"], "age", (1, OLDEST_YEARS, "years"), where, notes)
            one = Measured(
                _within(cells["mass"], "body mass", (*MASS_KG, "kg"), where, notes),
                _height(cells["height"], labels[at["height"]] if at["height"] is not None else "", where, notes),
                _sex(cells["sex"], where, notes),
                None if age is None else int(age),
            )
            found.setdefault(person_key(unquoted(cells["id"])), []).append(one)
    return {word: _agreed(rows, word, file, notes) for word, rows in found.items()}


def _agreed(rows: Sequence[Measured], word: str, file: str, notes: list[str]) -> Measured:
    """What all rows of a person say; where two differ nothing is taken."""
    values: dict[str, float | str | None] = {}
    for name, empty in (("mass_kg", None), ("height_m", None), ("sex", ""), ("age_years", None)):
        said = list(dict.fromkeys(getattr(one, name) for one in rows if getattr(one, name) != empty))
        values[name] = said[0] if len(said) == 1 else empty
        if len(said) > 1:
            notes.append(f"{file}: {name} of {word!r} differs between rows ({said[0]}, {said[1]}); not used")
    return Measured(**values)  # type: ignore[arg-type]


def _folded(label: str) -> str:
    plain = re.sub(r"\(([^()]*)\)\s*$", r"[\1]", label)
    name, unit = split_unit(plain)
    known = re.sub(r"[^a-z0-9]", "", name.lower())
    return known if unit is None or unit in ("kg", *_METRES, "m/f", "f/m") else f"{known} in {unit}"


def _number(text: str, where: str, what: str, notes: list[str]) -> float | None:
    if text.lower() in _MISSING:
        return None
    try:
        value = float(text.replace(",", "."))
    except ValueError:
        value = math.nan
    if not math.isfinite(value):
        notes.append(f"{where}: {what} {text!r} is no number; not used")
        return None
    return value


def _within(text: str, what: str, limits: tuple[float, float, str], where: str, notes: list[str]) -> float | None:
    value, (low, high, unit) = _number(text, where, what, notes), limits
    if value is None or low <= value <= high:
        return value
    article = "an" if what[0] in "ae" else "a"
    notes.append(f"{where}: {article} {what} of {value:g} is none of {low:g} to {high:g} {unit}; not used")
    return None


def _height(text: str, label: str, where: str, notes: list[str]) -> float | None:
    """Stature in m, of the unit that its label states, else of the one in which it is a person's."""
    value = _number(text, where, "stature", notes)
    if value is None:
        return None
    stated = re.search(r"(?:^|[^a-z])(m|cm|mm)\W*$", label.lower())
    low, high = LENGTHS_M["height_m"]
    for factor in (_METRES[stated[1]],) if stated else _METRES.values():
        if low <= value * factor <= high:
            return round(value * factor, 4)
    unit = stated[1] if stated else "m, cm or mm"
    notes.append(f"{where}: a stature of {value:g} {unit} is none of {low:g} to {high:g} m; not used")
    return None


def _sex(text: str, where: str, notes: list[str]) -> Sex:
    found = _SEX.get(text.lower(), "")
    if not found and text.lower() not in _MISSING:
        notes.append(f"{where}: sex {text!r} is neither f nor m; the mean of both is taken")
    return found


def said_of(people: Mapping[str, Measured], files: Iterable[Path]) -> str:
    """One note that says how many people got their mass, sex, stature and age from which tables."""
    counts = [
        f"{what} {sum(bool(getattr(one, name)) for one in people.values())} of {len(people)}"
        for name, what in (("mass_kg", "body mass"), ("sex", "sex"), ("height_m", "stature"), ("age_years", "age"))
        if any(getattr(one, name) for one in people.values())
    ]
    return f"{', '.join(counts)} people from {', '.join(file.as_posix() for file in files)}" if counts else ""
