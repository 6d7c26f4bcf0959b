"""A table of the report, as read and as numbers beside the page; and the tables that every page ends with."""

import re
from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import pandas as pd

from gaitdisc.recording import Finding
from gaitdisc.saved.provenance import Provenance, Refusal
from gaitdisc.saved.study_run import StudyRun
from gaitdisc.spreadsheet import write_csv


@dataclass(frozen=True, eq=False)
class Table:
    """A table as it is printed."""

    name: str
    caption: str  # what it shows, with n, unit and split where there are numbers
    columns: tuple[str, ...]
    rows: tuple[tuple[str, ...], ...]
    numbers: pd.DataFrame  # what the CSV holds
    # tuple of (str, int), headings above the headings, with the number of columns that each spans
    groups: tuple[tuple[str, int], ...] = ()
    summary: bool = False  # the last row sums up the others


def words_table(name: str, caption: str, headings: tuple[str, ...], rows: Iterable[tuple[str, ...]]) -> Table:
    """Table whose CSV holds the very words that are read: settings, hashes, findings, reasons.

    >>> words_table("files", "Files.", ("file", "SHA-256"), [("a.c3d", "ff")]).numbers["file"].tolist()
    ['a.c3d']
    """
    cells = tuple(rows)
    return Table(name, caption, headings, cells, pd.DataFrame(cells, columns=pd.Index(headings)))


def save_tables(tables: Iterable[Table], folder: Path) -> None:
    """Write the numbers of tables into the folder `tables/` of a report, each as CSV of its name."""
    for table in tables:
        save_table(table.numbers, folder / "tables" / f"{table.name}.csv")


def save_table(table: pd.DataFrame, path: Path, rest: Iterable[pd.DataFrame] = ()) -> None:
    """Write a table without its index, and further rows, as CSV, whole, with the same bytes for the same numbers."""
    write_csv(table, path, "%.8g", rest)


def tabulate_findings(findings: Sequence[Finding], caption: str, what: str = "what") -> Table:
    """What was seen in the files, in the order given.

    >>> tabulate_findings([Finding("note", "unit", "a.c3d", "mm taken as m", "")], "Seen, n = 1.").rows
    (('note', 'a.c3d', '', 'unit: mm taken as m', ''),)
    """
    rows = [(f.severity, f.file, f.channel, f"{f.kind}: {f.what}", f.spoils) for f in findings]
    return words_table("findings", caption, ("severity", "file", "channel", what, "spoils"), rows)


def tabulate_refusals(refusals: Sequence[Refusal], name: str, caption: str) -> Table:
    """Everybody and everything left out, with the reason.

    >>> tabulate_refusals([Refusal("P01", "", "no file")], "left-out", "Left out, n = 1.").rows
    (('P01', 'all', 'no file'),)
    """
    rows = [(refusal.participant, refusal.condition or "all", refusal.reason) for refusal in refusals]
    return words_table(name, caption, ("participant", "walk", "reason"), rows)


def refusals_table(run: StudyRun) -> Table:
    """Everybody and everything left out, with the reason."""
    return tabulate_refusals(run.refusals, "refusals", f"Participants and walks left out, n = {len(run.refusals)}.")


def findings_table(run: StudyRun) -> Table:
    """Every finding of every walk, the severest first."""
    numbers = run.findings_table()
    rows = tuple(
        (
            str(row.severity),
            f"{row.participant} {row.condition}",
            ", ".join(part for part in (str(row.file), str(row.channel)) if part),
            f"{row.kind}: {row.what}" + (f" (from-to: {row.spans_s} s)" if row.spans_s else ""),
            str(row.spoils),
        )
        for row in numbers.itertuples(index=False)
    )
    headings = ("severity", "walk", "where", "finding", "affects")
    caption = f"Findings of the reader and of the quality checks, n = {len(rows)} (all)."
    return Table("findings", caption, headings, rows, numbers)


def provenance_tables(made: Provenance) -> dict[str, Table]:
    """Tables `settings`, `versions` and `files` of a result."""
    files = sorted(made.files.items())
    return {
        "settings": words_table(
            "settings", "Settings, including all defaults.", ("setting", "value"), flatten(made.settings)
        ),
        "versions": words_table("versions", "Circumstances.", ("what", "value"), provenance_rows(made)),
        "files": words_table("files", f"Files read, n = {len(files)}, with their SHA-256.", ("file", "SHA-256"), files),
    }


def flatten(settings: Mapping[str, Any], prefix: str = "") -> list[tuple[str, str]]:
    """Settings as rows of dotted name and value; of files the name alone, without the folders of this machine.

    >>> flatten({"seed": 1, "filters": {"cutoff_hz": 6.0}})
    [('seed', '1'), ('filters.cutoff_hz', '6.0')]
    """
    rows: list[tuple[str, str]] = []
    for key, value in settings.items():
        name = f"{prefix}{key}"
        if isinstance(value, Mapping):
            rows.extend(flatten(value, f"{name}."))
        elif isinstance(value, list | tuple) and any(isinstance(item, Mapping) for item in value):
            rows.extend(flatten({str(number + 1): item for number, item in enumerate(value)}, f"{name}."))
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
