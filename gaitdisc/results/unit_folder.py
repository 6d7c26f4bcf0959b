"""One unit of a run on disk: a JSON file, written last, that holds its own hash and those of the files beside it.

Whatever is read back is covered: the numbers in the JSON file by `own_sha256`, every table and array by `sha256`. What
was changed, by a hand or by a disk, is refused by `load_unit`; who can compute it again does so, and says it
(`damaged_units`).
"""

from __future__ import annotations

import hashlib
import json
from collections.abc import Mapping, Sequence
from functools import cache
from pathlib import Path
from typing import TYPE_CHECKING, Any, Generic, NamedTuple, TypeVar

import numpy as np
from numpy.typing import NDArray

from gaitdisc.channel import list_names, schema_folder
from gaitdisc.recording import Finding
from gaitdisc.results.on_disk import DamagedError, StoredArrays, damaged, of_another_format
from gaitdisc.results.sealed_json import check_files, file_sha256, read_sealed, sealed_text
from gaitdisc.spreadsheet import read_csv, write_csv
from gaitdisc.whole_file import whole_file, write_whole, written_so_far, written_together

if TYPE_CHECKING:
    import pandas as pd

FORMAT = 1
EARLIER = {"told": "reconstructed"}  # what columns were called in folders saved before
NO_KEY = "saved by itself"  # of no files and settings: what was not computed by a run in its folder
T = TypeVar("T")


class Unit(NamedTuple):
    """What a unit holds: what its JSON file says, its tables by file name, and its arrays, read when used."""

    data: dict[str, Any]
    tables: dict[str, pd.DataFrame]
    arrays: StoredArrays


class Keyed(NamedTuple, Generic[T]):
    """A result as it was stored, and the key of what it was computed from."""

    result: T
    key: str


@written_together()
def save_unit(
    folder: Path,
    name: str,
    data: Mapping[str, Any],
    tables: Mapping[str, pd.DataFrame],
    arrays: Mapping[str, NDArray[np.float64]],
) -> None:
    """Write tables (by file name) as CSV and arrays, then the JSON file of their hashes: only then the unit stands."""
    for file, table in tables.items():
        write_csv(table, folder / file)
    files = [*tables]
    if arrays:
        files.append("arrays.npz")
        with whole_file(folder / "arrays.npz") as part, part.open("wb") as stream:
            np.savez_compressed(stream, **arrays)  # type: ignore[arg-type]
    hashes = {file: file_sha256(written_so_far(folder / file)) for file in files}
    write_whole(folder / name, sealed_text({"format": FORMAT, **data, "sha256": hashes}))


def load_unit(
    folder: Path, name: str, columns: Mapping[str, Sequence[str]] | None = None, words: Sequence[str] = ()
) -> Unit:
    """Read a unit after comparing hashes; `columns` that tables must have, `words` whose cells are no numbers."""
    data = read_json(folder / name)
    check_files(folder, data["sha256"])
    tables = {file: _read_table(folder / file, words) for file in data["sha256"] if file.endswith(".csv")}
    for file, wanted in (columns or {}).items():
        if file not in tables:
            raise damaged(folder / file, f"not among the files that {name} names")
        absent = [column for column in wanted if column not in tables[file]]
        if absent:
            raise damaged(folder / file, f"without the columns {', '.join(absent)}")
    return Unit(data, tables, StoredArrays(folder / "arrays.npz", data["sha256"].get("arrays.npz", "")))


def damaged_units(folder: Path) -> tuple[str, ...]:
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


def stored_finding(row: Mapping[str, Any]) -> Finding:
    """Return a finding as it was before JSON made lists of its spans.

    >>> gap = {"severity": "warning", "kind": "gap", "file": "a.mot", "what": "0.1 s", "spoils": ""}
    >>> stored_finding(gap | {"spans": [[1.0, 1.1]]}).spans
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
        raise damaged(path, f"not of the agreed form at {wrong.json_path}: {wrong.message[:200]}")
    return data


def _read_table(path: Path, words: Sequence[str]) -> pd.DataFrame:
    try:
        return read_csv(path, words).rename(columns=EARLIER)
    except (OSError, ValueError) as error:  # what pandas cannot parse is a ValueError
        raise damaged(path, f"not readable as a table ({error})") from error


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
