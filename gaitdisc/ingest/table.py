"""Plain tables (`.csv`, `.tsv`, `.parquet`): a column `time [s]`, then one column a channel, `name [unit]`."""

from __future__ import annotations

import csv
import io
import math
import re
from collections.abc import Mapping, Sequence
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from gaitdisc.errors import ReadError
from gaitdisc.ingest.angle_unit import judged_unit
from gaitdisc.ingest.cells import Form, parsed_cells
from gaitdisc.ingest.clock import even_time, printed_digit
from gaitdisc.ingest.columns import (
    Column,
    check_written_names,
    column_of,
    mapped_label,
    split_unit,
)
from gaitdisc.ingest.raw_file import RawFile, read_raw
from gaitdisc.ingest.streams import sorted_trial
from gaitdisc.recording import Finding, Recording, Trial
from gaitdisc.spreadsheet import quoted, unquoted
from gaitdisc.units import convert, parsed_unit
from gaitdisc.whole_file import write_whole

LEADING = 50  # lines above the header: who, when, which software
_TIME_UNIT = {"time": "s", "time_s": "s", "time_ms": "ms"}


def read_table(path: Path | str, channels: Mapping[str, str] | None = None) -> Trial:
    """Trial of one plain table.

    Commas, semicolons or tabs separate; with the latter two a comma may be the decimal sign. Lines at the top that
    begin with `#`, and up to 50 others above the line that names the column of times, are passed over. Names of the
    vocabulary have their unit by definition; every other name must state one. A column of times of another name is
    named by the study: `"Frame time" = "time [s]"`. A line of units below the header counts as part of it.

    Parameters
    ----------
    channels : mapping of str to str, optional
        The study's `[channels]`: label -> `name` or `name [unit]`.

    Examples
    --------
    >>> read_table("walk.csv").streams["kinematics"]["knee_angle_r"]  # doctest: +SKIP
    array([...])
    """
    raw = read_raw(path)
    of_parquet = raw.name.lower().endswith(".parquet")
    labels, values, digit, lines = _parquet(raw, channels) if of_parquet else _text(raw, channels)
    at = next(i for i, label in enumerate(labels) if _time_unit(label, channels))
    unit = _time_unit(labels[at], channels) or "s"
    clock, digit = np.asarray(convert(values[:, at], unit, "s"), float), digit * (1e-3 if unit == "ms" else 1.0)
    time = even_time(clock, digit, raw.name, lines)
    others = [i for i in range(len(labels)) if i != at]
    columns = [column_of(labels[i], raw.name, channels) for i in others]
    findings = checked_angles(columns, time, values[:, others], raw.name)
    inside = np.column_stack([column.converted(values[:, i]) for i, column in zip(others, columns, strict=True)])
    reader = "parquet" if of_parquet else "csv"
    return sorted_trial(raw.source(reader), time, inside, [column.channel for column in columns], findings)


def write_table(recording: Recording, path: Path | str) -> Path:
    """Write a recording as a plain table, whole or not at all; every column states its unit.

    Parameters
    ----------
    recording : Recording
        Any channels; marks of suspect samples, subject and condition are not written.

    Examples
    --------
    >>> write_table(recording, "walk.csv")  # doctest: +SKIP
    PosixPath('walk.csv')
    """
    path = Path(path)
    check_written_names(recording.names, path.name)
    labels = ["time [s]", *(f"{channel.name} [{channel.unit}]" for channel in recording.channels)]
    table = np.column_stack([recording.time, recording.values])
    if path.suffix.lower() == ".parquet":
        import pyarrow as pa
        import pyarrow.parquet as pq

        buffer = io.BytesIO()
        pq.write_table(pa.table({label: table[:, i] for i, label in enumerate(labels)}), buffer)
        return write_whole(path, buffer.getvalue())
    text = io.StringIO()
    writer = csv.writer(text, lineterminator="\n")
    writer.writerow(map(quoted, labels))
    writer.writerows([["" if math.isnan(cell) else repr(cell) for cell in row] for row in table.tolist()])
    return write_whole(path, text.getvalue())


def _time_unit(label: str, channels: Mapping[str, str] | None = None) -> str | None:
    plain, unit = split_unit(label)
    said = mapped_label(label, channels) or mapped_label(plain, channels)
    name, said_unit = split_unit(said) if said else (plain, None)
    unit = said_unit or unit
    if name.lower() not in _TIME_UNIT:
        return None
    return _TIME_UNIT[name.lower()] if unit is None else unit if unit in ("s", "ms") else None


def _text(
    raw: RawFile, channels: Mapping[str, str] | None
) -> tuple[list[str], NDArray[np.float64], float, NDArray[np.intp] | None]:
    lines = raw.lines()
    top = next((i for i, line in enumerate(lines) if line.strip() and not line.startswith("#")), None)
    if top is None:
        raise _no_time(raw.name, "it holds comments only")
    named = (i for i in range(top, min(len(lines), top + LEADING)) if _header(lines[i], channels))
    top = next(named, top)
    separator, labels = _header(lines[top], channels) or (",", [])
    if not labels:
        raise _no_time(raw.name, f"line {top + 1} is {lines[top][:60]!r}")
    _check_labels(labels, f"{raw.name}, line {top + 1}")
    units = _units_below(lines[top + 1 : top + 2], labels, separator)
    labels, top = (units, top + 1) if units else (labels, top)
    comma = separator != "," and any("," in line for line in lines[top + 1 : top + 50])
    cells = parsed_cells(lines[top + 1 :], labels, top + 2, Form(raw.name, separator, "," if comma else "."))
    at = next(i for i, label in enumerate(labels) if _time_unit(label, channels))
    digit = printed_digit(lines[number - 1].split(separator)[at] for number in cells.lines.tolist())
    return labels, cells.values, digit, cells.lines


def _header(line: str, channels: Mapping[str, str] | None) -> tuple[str, list[str]] | None:
    """Separator and labels of a line that names a column of times; None of any other."""
    for separator in ",;\t":
        labels = [unquoted(label.strip()) for label in next(csv.reader([line], delimiter=separator), [])]
        if any(_time_unit(label, channels) for label in labels):
            return separator, labels
    return None


def _units_below(below: Sequence[str], labels: Sequence[str], separator: str) -> list[str]:
    """Labels with the units of a line below them, where that line holds units and blanks alone; else nothing."""
    cells = [cell.strip().strip("()[]") for line in below for cell in next(csv.reader([line], delimiter=separator), [])]
    if len(cells) != len(labels) or not any(cells) or any(cell and _known_unit(cell) is None for cell in cells):
        return []
    return [
        f"{label} [{cell}]" if cell and split_unit(label)[1] is None else label
        for label, cell in zip(labels, cells, strict=True)
    ]


def _known_unit(cell: str) -> str | None:
    return "ms" if cell == "ms" else parsed_unit(re.sub(r"/s2?$", "", cell)) if not cell[0].isdigit() else None


def _check_labels(labels: Sequence[str], where: str) -> None:
    names = [split_unit(label)[0] for label in labels]
    if "" in names:
        raise ReadError(
            f"{where}: every column needs a name", f"column {names.index('') + 1} has none", "Name it in the header."
        )
    if len(labels) < 2:
        raise ReadError(f"{where}: a table needs channels beside time", "there is time alone", "Export the channels.")


def _no_time(file: str, found: str) -> ReadError:
    return ReadError(
        f"{file} needs a column 'time [s]' (or time, time_s, time [ms])",
        found,
        'Name the column of times so, or in the study\'s [channels]: "Frame time" = "time [s]".',
    )


def _parquet(
    raw: RawFile, channels: Mapping[str, str] | None
) -> tuple[list[str], NDArray[np.float64], float, NDArray[np.intp] | None]:
    import pyarrow as pa
    import pyarrow.parquet as pq

    try:
        table = pq.read_table(io.BytesIO(raw.content))
        names = [str(name) for name in table.column_names]
        columns = [(name, table.column(i)) for i, name in enumerate(names)]
        words = next(
            (name for name, c in columns if not (pa.types.is_integer(c.type) or pa.types.is_floating(c.type))), None
        )
        arrays = [] if words else [np.asarray(c.to_numpy(zero_copy_only=False), float) for _, c in columns]
    except (pa.ArrowException, OSError, ValueError, TypeError, KeyError) as error:
        raise ReadError(
            f"{raw.name} should be a Parquet table",
            f"it cannot be read as one: {str(error).splitlines()[0][:120] if str(error) else type(error).__name__}",
            "Write it again, or give it its true ending.",
        ) from error
    if words is not None:
        raise ReadError(f"{raw.name}: columns need numbers", f"column {words!r} holds others", "Leave that column out.")
    if not any(_time_unit(name, channels) for name in names):
        raise _no_time(raw.name, f"its columns are {', '.join(names[:6])}")
    _check_labels(names, raw.name)
    values = np.column_stack(arrays)
    if not len(values) or np.isinf(values).any():
        where = (
            f"column {names[int(np.argmax(np.isinf(values).any(axis=0)))]!r} is infinite" if len(values) else "no row"
        )
        raise ReadError(f"{raw.name} needs rows of finite numbers", f"found {where}", "Write it again.")
    return names, values, 0.0, None


def checked_angles(
    columns: Sequence[Column], time: NDArray[np.float64], values: NDArray[np.float64], file: str
) -> list[Finding]:
    """Whether the numbers of angles contradict their unit; a UnitError where they do.

    Parameters
    ----------
    time : ndarray (time,) [s]
        Of the samples.
    values : ndarray (time, column)
        In the file's units.
    """
    findings = []
    for unit in ("deg", "rad"):
        which = [i for i, c in enumerate(columns) if c.channel.quantity == "angle" and c.unit == unit]
        if which:
            names = [columns[i].channel.name for i in which]
            findings.append(judged_unit(time, values[:, which], names, unit, file)[1])
    return [finding for finding in findings if finding]
