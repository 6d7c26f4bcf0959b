"""Parts of a report that stand for as long as the cycles that they show, the code and their own files do."""

import hashlib
from collections.abc import Iterable, Mapping, Sequence
from dataclasses import fields
from pathlib import Path
from typing import Any

import numpy as np
import pandas as pd

from gaitdisc.errors import SchemaError
from gaitdisc.saved.provenance import code_sha256
from gaitdisc.saved.unit_folder import file_sha256, read_sealed, seal_text
from gaitdisc.whole_file import write_whole

FOLDER = "kept"  # of a report: a file for each part


def hash_content(content: Sequence[Any], *more: str) -> str:
    """Hash of all that dataclasses hold, of this package's code, and of what else a part rests on."""
    digest = hashlib.sha256("\n".join((code_sha256(), *more)).encode())
    for value in (getattr(record, field.name) for record in content for field in fields(record)):
        if isinstance(value, np.ndarray):
            digest.update(np.ascontiguousarray(value).tobytes())
        elif isinstance(value, pd.DataFrame):
            digest.update(value.to_csv().encode())
        else:
            digest.update(repr(dict(value) if isinstance(value, Mapping) else value).encode())
    return digest.hexdigest()


def read_part(report: Path, name: str, key: str) -> Any:
    """What was kept of a part, if it rests on the same and its files are whole; else None."""
    try:
        part = read_sealed(report / FOLDER / f"{name}.json")
        unchanged = part["key"] == key and all(file_sha256(report / file) == sha for file, sha in part["files"].items())
        return part["data"] if unchanged else None
    except (SchemaError, OSError, KeyError, AttributeError):
        return None


def keep_part(report: Path, name: str, key: str, data: Any, files: Iterable[Path]) -> None:
    """Keep what a part shows elsewhere, beside hashes of its files."""
    hashes = {file.relative_to(report).as_posix(): file_sha256(file) for file in sorted(files)}
    write_whole(report / FOLDER / f"{name}.json", seal_text({"key": key, "data": data, "files": hashes}))
