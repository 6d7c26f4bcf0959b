"""What a result rests on, as the last tables of every page: settings, circumstances, files."""

from __future__ import annotations

import re
from collections.abc import Mapping
from typing import Any

from gaitdisc.report.table import Table, words_table
from gaitdisc.results.provenance import Provenance


def provenance_tables(made: Provenance) -> dict[str, Table]:
    """Tables `settings`, `versions` and `files` of a result."""
    files = sorted(made.files.items())
    return {
        "settings": words_table(
            "settings", "Settings, with all defaults.", ("setting", "value"), flattened(made.settings)
        ),
        "versions": words_table("versions", "Circumstances.", ("what", "value"), provenance_rows(made)),
        "files": words_table("files", f"Files read, n = {len(files)}, with their SHA-256.", ("file", "SHA-256"), files),
    }


def flattened(settings: Mapping[str, Any], prefix: str = "") -> list[tuple[str, str]]:
    """Settings as rows of dotted name and value; of files the name alone, without the folders of this machine.

    >>> flattened({"seed": 1, "filters": {"cutoff_hz": 6.0}})
    [('seed', '1'), ('filters.cutoff_hz', '6.0')]
    """
    rows: list[tuple[str, str]] = []
    for key, value in settings.items():
        name = f"{prefix}{key}"
        if isinstance(value, Mapping):
            rows.extend(flattened(value, f"{name}."))
        elif isinstance(value, list | tuple) and any(isinstance(item, Mapping) for item in value):
            rows.extend(flattened({str(number + 1): item for number, item in enumerate(value)}, f"{name}."))
        elif isinstance(value, list | tuple):
            items = [re.split(r"[\\/]", str(item))[-1] if key == "files" else str(item) for item in value]
            rows.append((name, ", ".join(items)))
        else:
            rows.append((name, str(value)))
    return rows


def provenance_rows(provenance: Provenance) -> list[tuple[str, str]]:
    """Circumstances of the run: section, date, seed, versions."""
    return [
        ("follows section", provenance.section),
        ("computed", provenance.created),
        ("seed", str(provenance.seed)),
        *((f"version of {name}", value) for name, value in provenance.versions.items()),
    ]
