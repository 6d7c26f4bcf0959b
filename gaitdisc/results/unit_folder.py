"""One unit of a run on disk: a JSON file, written last, that holds the hashes of the tables and arrays beside it."""

from __future__ import annotations

import hashlib
import json
from collections.abc import Mapping
from functools import cache
from pathlib import Path
from typing import Any

import numpy as np
import pandas as pd
from jsonschema import Draft202012Validator
from numpy.typing import NDArray

from gaitdisc.channel import schema_folder
from gaitdisc.recording import Finding
from gaitdisc.results.on_disk import StoredArrays, damaged
from gaitdisc.whole_file import whole_file

FORMAT = 1
Unit = tuple[dict[str, Any], dict[str, pd.DataFrame], StoredArrays]


def save_unit(
    folder: Path,
    name: str,
    data: Mapping[str, Any],
    tables: Mapping[str, pd.DataFrame],
    arrays: Mapping[str, NDArray[np.float64]],
) -> None:
    """Write tables and arrays, then the JSON file with their hashes: only then does the unit stand.

    Parameters
    ----------
    folder : Path
        Folder of this unit alone.
    name : str
        Name of the JSON file, which is also its place in `results.schema.json`.
    data : mapping
        What is named.
    tables : mapping of str to DataFrame
        File name -> table, written as CSV.
    arrays : mapping of str to ndarray
        Written as `arrays.npz`; no file where there are none.

    Raises
    ------
    WriteError
        If a file cannot be written; an older unit of that place is then told as damaged by its hashes.
    """
    for file, table in tables.items():
        with whole_file(folder / file) as part:
            table.to_csv(part, index=False, lineterminator="\n")
    files = [*tables]
    if arrays:
        files.append("arrays.npz")
        with whole_file(folder / "arrays.npz") as part, part.open("wb") as stream:
            np.savez_compressed(stream, **arrays)  # type: ignore[arg-type]
    hashes = {file: _sha256(folder / file) for file in files}
    with whole_file(folder / name) as part:
        part.write_text(json_text({"format": FORMAT, **data, "sha256": hashes}), encoding="utf-8")


def load_unit(folder: Path, name: str) -> Unit:
    """Read a unit, after its hashes were compared.

    Parameters
    ----------
    folder : Path
        Folder that `save_unit` wrote.
    name : str
        Name of the JSON file.

    Returns
    -------
    data : dict
        What is named.
    tables : dict of str to DataFrame
        By file name.
    arrays : StoredArrays
        By name; they are not read here.

    Raises
    ------
    SchemaError
        If a file is missing, damaged or of another form.
    """
    data = read_json(folder / name)
    for file, wanted in data["sha256"].items():
        path = folder / file
        if not path.is_file() or _sha256(path) != wanted:
            raise damaged(path, "missing" if not path.is_file() else "changed since it was saved (SHA-256 differs)")
    tables = {
        file: pd.read_csv(folder / file, engine="python", keep_default_na=False, na_values=[""])
        for file in data["sha256"]
        if file.endswith(".csv")
    }
    return data, tables, StoredArrays(folder / "arrays.npz", data["sha256"].get("arrays.npz", ""))


def with_words(table: pd.DataFrame, column: str) -> pd.DataFrame:
    """Table in which an empty word is an empty word again, and not the missing number that a CSV makes of it.

    Parameters
    ----------
    table : DataFrame
        From `load_unit`; changed in place.
    column : str
        Of words; where the table has none of that name, nothing is changed.
    """
    if column in table:
        table[column] = table[column].astype(object).fillna("").astype(str)
    return table


def stored_finding(row: Mapping[str, Any]) -> Finding:
    """Return a finding as it was before JSON made lists of its spans.

    Parameters
    ----------
    row : mapping
        `asdict` of a finding, read back.

    Examples
    --------
    >>> gap = {"severity": "warning", "kind": "gap", "file": "a.mot", "what": "0.1 s", "spoils": ""}
    >>> stored_finding(gap | {"spans": [[1.0, 1.1]]}).spans
    ((1.0, 1.1),)
    """
    return Finding(**{**row, "spans": tuple(tuple(span) for span in row["spans"])})


def read_json(path: Path) -> dict[str, Any]:
    """Read a JSON file of a run and hold it against the schema.

    Parameters
    ----------
    path : Path
        `run.json`, `walk.json`, `response.json` or `tests.json`.

    Raises
    ------
    SchemaError
        If the file is missing, no JSON, or not of the agreed form.
    """
    try:
        data = json.loads(path.read_text(encoding="utf-8"))
    except FileNotFoundError:
        raise damaged(path, "missing") from None
    except (OSError, ValueError) as error:
        raise damaged(path, f"not readable as JSON ({error})") from error
    if not isinstance(data, dict) or data.get("format") != FORMAT:
        raise damaged(path, f"of format {data.get('format') if isinstance(data, dict) else None!r}, not {FORMAT}")
    wrong = next(iter(_validator(path.stem).iter_errors(data)), None)
    if wrong is not None:
        raise damaged(path, f"not of the agreed form at {wrong.json_path}: {wrong.message[:200]}")
    return data


@cache
def _validator(part: str) -> Draft202012Validator:
    schema = json.loads((schema_folder() / "results.schema.json").read_text(encoding="utf-8"))
    return Draft202012Validator({"$ref": f"#/$defs/{part}", "$defs": schema["$defs"]})


def json_text(data: Mapping[str, Any]) -> str:
    """Write JSON the same way each time.

    Parameters
    ----------
    data : mapping
        What is named.
    """
    return json.dumps(data, indent=1, ensure_ascii=False) + "\n"


def _sha256(path: Path) -> str:
    with path.open("rb") as file:
        return hashlib.file_digest(file, "sha256").hexdigest()
