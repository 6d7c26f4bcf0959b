"""One unit of a run on disk: a JSON file, written last, that holds its own hash and those of the files beside it.

Whatever is read back is covered: the numbers in the JSON file by `own_sha256`, every table and array by `sha256`. What
was changed, by a hand or by a disk, is refused by `load_unit`; who can compute it again does so, and says it
(`damage_lines`). Arrays stay on the disk until they are looked at.
"""

from __future__ import annotations

import hashlib
import io
import json
import zipfile
from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import dataclass
from functools import cache, lru_cache, partial
from pathlib import Path
from typing import TYPE_CHECKING, Any, NamedTuple, TypeVar

import numpy as np

from gaitdisc._version import __version__
from gaitdisc.channel import list_names, schema_folder
from gaitdisc.errors import SchemaError
from gaitdisc.own_files import content_sha256, file_sha256, note_inputs
from gaitdisc.recording import Finding
from gaitdisc.recording.arrays import Values
from gaitdisc.spreadsheet import read_csv, write_csv
from gaitdisc.whole_file import find_written, whole_file, write_together, write_whole

if TYPE_CHECKING:
    import pandas as pd

Kind = TypeVar("Kind")
Arrays = Mapping[str, Values]
KEPT_FILES = 2  # of which the arrays stay in memory: both walks of one participant
AGAIN = "Repeat the command that wrote it. `gaitdisc run` keeps undamaged parts and computes the others again."
CHANGED = "has changed since it was saved (SHA-256 differs)"


class DamagedError(SchemaError):
    """A file of results has changed since it was saved."""

    path: Path
    what: str


@dataclass(frozen=True)
class StoredArrays(Mapping[str, Values]):
    """Arrays of one file by name, read when one of them is used."""

    path: Path
    sha256: str  # hash it had when it was saved; empty where there is no file, and no array

    def __getitem__(self, name: str) -> Values:
        return _arrays(self.path, self.sha256)[name]

    def __iter__(self) -> Iterator[str]:
        return iter(self._read())

    def __len__(self) -> int:
        return len(self._read())

    def _read(self) -> Arrays:
        return _arrays(self.path, self.sha256) if self.sha256 else {}


class OnDisk(partial[Any]):
    """Something made of the arrays of one file each time it is looked at, for a field that `may_lie_on_disk`."""


def may_lie_on_disk(*fields: str) -> Callable[[type[Kind]], type[Kind]]:
    """Let fields of a dataclass be given as `OnDisk`; who reads such a field gets its value, which is not kept.

    >>> @may_lie_on_disk("curves")
    ... @dataclass(frozen=True)
    ... class Kept:
    ...     curves: list[int]
    >>> Kept([1, 2]).curves
    [1, 2]
    """

    def marked(kind: type[Kind]) -> type[Kind]:
        for name in fields:
            setattr(kind, name, _Field(name))
        return kind

    return marked


def lies_on_disk(thing: object, field: str) -> bool:
    """Whether a field was given as `OnDisk`."""
    return isinstance(vars(thing)[field], OnDisk)


def damage(path: Path, what: str, do: str = AGAIN) -> DamagedError:
    """Return the refusal of a file that is not as it was saved."""
    error = DamagedError(
        "every file of a results folder must be as it was saved", f"{path.parent.name}/{path.name} {what}", do
    )
    error.path, error.what = path, what
    return error


def of_another_format(path: Path, theirs: object, ours: int) -> DamagedError:
    """Return the refusal of a file that another version of gaitdisc wrote."""
    do = f"Another version wrote this file. Install that version, or compute the result again with {__version__}."
    return damage(path, f"has format {str(theirs)[:20]}, not {ours}", do)


class _Field:
    """Descriptor that reads `OnDisk` when it is looked at; a dataclass sets it as any other field."""

    def __init__(self, name: str) -> None:
        self._name = name

    def __get__(self, thing: object, kind: type | None = None) -> Any:
        if thing is None:
            raise AttributeError(self._name)
        value = vars(thing)[self._name]
        return value() if isinstance(value, OnDisk) else value

    def __set__(self, thing: object, value: object) -> None:
        vars(thing)[self._name] = value


@lru_cache(maxsize=KEPT_FILES)
def _arrays(path: Path, sha256: str) -> Arrays:
    try:
        content = path.read_bytes()
        if hashlib.sha256(content).hexdigest() != sha256:
            raise damage(path, CHANGED)
        with np.load(io.BytesIO(content), allow_pickle=False) as stored:
            return {key: stored[key] for key in stored.files}
    except FileNotFoundError:
        raise damage(path, "is missing") from None
    except (OSError, ValueError, EOFError, zipfile.BadZipFile) as error:
        raise damage(path, f"cannot be read ({error})") from error


OWN = "own_sha256"


def read_sealed(path: Path) -> dict[str, Any]:
    """Read a JSON file that `seal_text` made, if it is as it was written."""
    if not path.is_file():
        raise damage(path, "is missing")
    try:
        data = json.loads(path.read_text(encoding="utf-8"))
        seal = data.pop(OWN, None) if isinstance(data, dict) else None
        sha256 = content_sha256(data) if seal is not None else None
    except RecursionError:
        raise damage(path, "cannot be read as JSON (nested too deeply)") from None
    except (OSError, ValueError) as error:
        raise damage(path, f"cannot be read as JSON ({error})") from error
    if not isinstance(data, dict):
        raise damage(path, "is not a JSON object")
    if seal is None:
        raise damage(path, f"has no hash of its own: an older version of gaitdisc wrote it, or {OWN} was removed")
    if sha256 != seal:
        raise damage(path, CHANGED)
    return data


def seal_text(data: Mapping[str, Any]) -> str:
    """Write JSON with a hash of its own, which covers everything else in it.

    >>> seal_text({"rate_hz": 100.0}) != seal_text({"rate_hz": 999.0})
    True
    """
    as_read = json.loads(json.dumps(data))
    return json.dumps({**as_read, OWN: content_sha256(as_read)}, indent=1, ensure_ascii=False) + "\n"


def check_files(folder: Path, hashes: Mapping[str, str]) -> None:
    """Refuse a folder of which a file is not as it was saved."""
    note_inputs(folder / file for file in hashes)
    for file, wanted in hashes.items():
        path = folder / file
        if not path.is_file():
            raise damage(path, "is missing")
        try:
            sha256 = file_sha256(path)
        except OSError as error:
            raise damage(path, f"cannot be read ({error.strerror})") from error
        if sha256 != wanted:
            raise damage(path, CHANGED)


FORMAT = 1
EARLIER = {"told": "reconstructed"}  # what columns were called in folders saved before
NO_KEY = "saved by itself"  # of no files and settings: what was not computed by a run in its folder


class Unit(NamedTuple):
    """What a unit holds: what its JSON file says, its tables by file name, and its arrays, read when used."""

    data: dict[str, Any]
    tables: dict[str, pd.DataFrame]
    arrays: StoredArrays


@write_together()
def save_unit(
    folder: Path, name: str, data: Mapping[str, Any], tables: Mapping[str, pd.DataFrame], arrays: Arrays
) -> None:
    """Write tables (by file name) as CSV and arrays, then the JSON file of their hashes: only then the unit stands."""
    for file, table in tables.items():
        write_csv(table, folder / file)
    files = [*tables]
    if arrays:
        files.append("arrays.npz")
        with whole_file(folder / "arrays.npz") as part, part.open("wb") as stream:
            np.savez_compressed(stream, **arrays)  # type: ignore[arg-type]
    hashes = {file: file_sha256(find_written(folder / file)) for file in files}
    write_whole(folder / name, seal_text({"format": FORMAT, **data, "sha256": hashes}))


def load_unit(folder: Path, name: str, columns: Mapping[str, Sequence[str]], words: Sequence[str] = ()) -> Unit:
    """Read a unit after comparing hashes; `columns` that tables must have, `words` whose cells are no numbers."""
    data = read_json(folder / name)
    check_files(folder, data["sha256"])
    tables: dict[str, pd.DataFrame] = {}
    for file in (name for name in data["sha256"] if name.endswith(".csv")):
        try:
            tables[file] = read_csv(folder / file, words).rename(columns=EARLIER)
        except (OSError, ValueError) as error:  # what pandas cannot parse is a ValueError
            raise damage(folder / file, f"cannot be read as a table ({error})") from error
    for file, wanted in columns.items():
        if file not in tables:
            raise damage(folder / file, f"is not among the files that {name} names")
        absent = [column for column in wanted if column not in tables[file]]
        if absent:
            raise damage(folder / file, f"lacks the columns {', '.join(absent)}")
    return Unit(data, tables, StoredArrays(folder / "arrays.npz", data["sha256"].get("arrays.npz", "")))


def damage_lines(folder: Path) -> tuple[str, ...]:
    """Say which units below a folder are not as saved: a line a kind of damage, with the files; nothing is changed."""
    kinds: dict[str, list[str]] = {}
    for path in sorted(folder.rglob("*.json")):
        if path.stem not in _schema()["$defs"] or path.name.startswith("."):
            continue
        try:
            data = read_json(path)
            check_files(path.parent, data.get("sha256", {}))
        except DamagedError as error:
            kinds.setdefault(error.what, []).append(error.path.relative_to(folder).as_posix())
    return tuple(f"{list_names(files, 4)}: {what}" for what, files in kinds.items())


def with_words(table: pd.DataFrame, column: str) -> pd.DataFrame:
    """Table, changed in place, in which an empty word of the column, if there, is no missing number any more."""
    if column in table:
        table[column] = table[column].astype(object).fillna("").astype(str)
    return table


def load_finding(row: Mapping[str, Any]) -> Finding:
    """Return a finding as it was before JSON made lists of its spans.

    >>> gap = {"severity": "warning", "kind": "gap", "file": "a.mot", "what": "0.1 s", "spoils": ""}
    >>> load_finding(gap | {"spans": [[1.0, 1.1]]}).spans
    ((1.0, 1.1),)
    """
    return Finding(**{**row, "spans": tuple(tuple(span) for span in row["spans"])})


def read_json(path: Path) -> dict[str, Any]:
    """Read a JSON file of a run, compare its own hash, and hold it against the schema that names it."""
    data = read_sealed(path)
    if data.get("format") != FORMAT:
        raise of_another_format(path, data.get("format"), FORMAT)
    wrong = next(iter(_validator(path.stem).iter_errors(data)), None)
    if wrong is not None:
        raise damage(path, f"does not have the expected form at {wrong.json_path}: {wrong.message[:200]}")
    return data


@cache
def _schema() -> dict[str, Any]:
    return json.loads((schema_folder() / "results.schema.json").read_text(encoding="utf-8"))


@cache
def _validator(part: str) -> Any:
    from jsonschema import Draft202012Validator  # not needed where nothing is read

    return Draft202012Validator({"$ref": f"#/$defs/{part}", "$defs": _schema()["$defs"]})


def unit_name(subject: str, condition: str) -> str:
    """Folder name of a unit: letters, digits, `-` and `_` only, another one for every person and condition.

    >>> unit_name("P01", "exo"), unit_name("P01", "no spring"), unit_name("P01", "no_spring")
    ('P01-exo', 'P01-no_spring-e4cfa24e', 'P01-no_spring')
    """
    who = "".join(letter if letter.isalnum() or letter in "-_" else "_" for letter in subject)
    plain = "".join(letter if letter.isalnum() or letter == "_" else "_" for letter in condition)
    if (who, plain) == (subject, condition):
        return f"{subject}-{condition}"
    hashed = hashlib.sha256(" ".join((subject, condition)).encode()).hexdigest()[:8]
    return f"{who}-{plain}-{hashed}"
