"""JSON that holds a hash of its own, and the hashes of the files beside it: what was changed since is refused."""

from __future__ import annotations

import json
from collections.abc import Mapping
from pathlib import Path
from typing import Any

from gaitdisc.own_files import content_sha256, file_sha256, note_inputs
from gaitdisc.results.on_disk import CHANGED, damaged

OWN = "own_sha256"


def read_sealed(path: Path) -> dict[str, Any]:
    """Read a JSON file that `sealed_text` made, if it is as it was written."""
    if not path.is_file():
        raise damaged(path, "missing")
    try:
        data = json.loads(path.read_text(encoding="utf-8"))
        own = data.pop(OWN, None) if isinstance(data, dict) else None
        found = content_sha256(data) if own is not None else None
    except RecursionError:
        raise damaged(path, "not readable as JSON (nested too deeply)") from None
    except (OSError, ValueError) as error:
        raise damaged(path, f"not readable as JSON ({error})") from error
    if not isinstance(data, dict):
        raise damaged(path, "no JSON object")
    if own is None:
        raise damaged(path, f"without a hash of its own: an older version of gaitdisc wrote it, or {OWN} was taken out")
    if found != own:
        raise damaged(path, CHANGED)
    return data


def sealed_text(data: Mapping[str, Any]) -> str:
    """Write JSON with a hash of its own, which covers everything else in it.

    >>> sealed_text({"rate_hz": 100.0}) != sealed_text({"rate_hz": 999.0})
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
            raise damaged(path, "missing")
        try:
            found = file_sha256(path)
        except OSError as error:
            raise damaged(path, f"not readable ({error.strerror})") from error
        if found != wanted:
            raise damaged(path, CHANGED)
