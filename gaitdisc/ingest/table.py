"""Plain tables (`.csv`, `.tsv`, `.parquet`): a column `time [s]`, then a column a channel, `name [unit]`; or events."""

from __future__ import annotations

import csv
import io
import re
from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import TYPE_CHECKING

import numpy as np

from gaitdisc.errors import ReadError
from gaitdisc.ingest.c3d_labels import FOOT_OFF, INITIAL_CONTACT, event_kind
from gaitdisc.ingest.cells import Cells, Form, even_time, parse_cells, printed_digit
from gaitdisc.ingest.columns import IGNORE, Column, check_written_names, find_column, read_label, sort_trial, split_unit
from gaitdisc.ingest.raw_file import RawFile, read_raw
from gaitdisc.ingest.stated_units import plausible_unit
from gaitdisc.recording import Finding, Recording, Source, Trial
from gaitdisc.recording.arrays import Values
from gaitdisc.recording.trial import Event
from gaitdisc.spreadsheet import quote, unquote
from gaitdisc.units import convert, parse_unit
from gaitdisc.whole_file import write_whole

if TYPE_CHECKING:
    import pandas as pd

# even times [s], labels, and columns (time, column) in their own units
TimedColumns = tuple[Values, list[str], Values]
FRAME = "the table"  # a DataFrame has no name
LEADING = 50  # lines above the header: who, when, which software
LEADING_EVENTS = 10  # above that of a table of events
STEPS = (INITIAL_CONTACT, FOOT_OFF)
_KIND = ("name", "event", "label", "type", "event name", "event type")
_SIDE = ("context", "side", "foot", "leg")
_TIME = re.compile(r"(?:event )?times?(?:_| )?[\[(]?(s|ms|sec|seconds)?[\])]?")
_TIME_UNIT = {"time": "s", "time_s": "s", "time_ms": "ms"}


def read_table(path: Path | str, channels: Mapping[str, str] | None = None) -> Trial:
    """Trial of one plain table.

    Commas, semicolons or tabs separate; with the latter two a comma may be the decimal sign. Lines at the top that
    begin with `#`, and up to 50 others above the line that names the column of times, are passed over. Names of the
    vocabulary have their unit by definition; every other name must state one. A column of times of another name is
    named by the study: `"Frame time" = "time [s]"`. A line of units below the header counts as part of it. A table of
    events (`read_events`) gives a trial of events alone.
    """
    raw = read_raw(path)
    if raw.name.lower().endswith(".parquet"):
        import pyarrow as pa
        import pyarrow.parquet as pq

        try:
            frame = pq.read_table(io.BytesIO(raw.content)).to_pandas(ignore_metadata=True)
        except (pa.ArrowException, OSError, ValueError, TypeError, KeyError) as error:
            reason = str(error).splitlines()[0][:120] if str(error) else type(error).__name__
            raise ReadError(
                f"{raw.name} must be a Parquet table",
                f"it cannot be read as one: {reason}",
                "Write it again, or correct its ending.",
            ) from error
        labels, values = _of_frame(frame, raw.name, channels)
        return _trial(raw.source("parquet"), _split_time(labels, values, channels, raw.name), channels)
    if events := read_events(raw.lines(), raw.name):
        return Trial(Path(raw.name).stem, {}, events)
    labels, cells = _text(raw, channels)
    return _trial(raw.source("csv"), _split_time(labels, cells.values, channels, raw.name, cells), channels)


def read_frame(frame: pd.DataFrame, channels: Mapping[str, str] | None = None) -> Trial:
    """Trial of a DataFrame with the columns of a plain table; times may stand in its index.

    >>> import pandas as pd
    >>> table = pd.DataFrame({"time": [0.0, 0.01, 0.02], "knee_angle_r": [5.0, 6.0, 7.0]})
    >>> read_frame(table).streams["kinematics"]["knee_angle_r"].tolist()
    [5.0, 6.0, 7.0]
    """
    return _trial(Source(FRAME, reader="DataFrame"), frame_columns(frame, channels), channels)


def has_times(frame: pd.DataFrame) -> bool:
    """Whether times stand in a column of a DataFrame, or in its index."""
    return any(_time_unit(str(name)) for name in (frame.index.name, *frame.columns))


def frame_columns(frame: pd.DataFrame, channels: Mapping[str, str] | None = None) -> TimedColumns:
    """Columns of a DataFrame whose times stand in a column, or in its index."""
    if _time_unit(str(frame.index.name), channels):
        frame = frame.reset_index()
    elif not any(_time_unit(str(name), channels) for name in frame.columns):
        raise ReadError(
            f"{FRAME} must have times [s] in a column 'time' (or time_s, time [ms]), or in an index of that name",
            f"its columns are {', '.join(map(str, frame.columns[:6]))}, its index is {frame.index.name or 'unnamed'}",
            'Rename the column, frame.rename(columns={"t": "time"}), or the index, frame.rename_axis("time").',
        )
    labels, values = _of_frame(frame, FRAME, channels)
    return _split_time(labels, values, channels, FRAME)


def _split_time(
    labels: list[str], values: Values, channels: Mapping[str, str] | None, file: str, cells: Cells | None = None
) -> TimedColumns:
    """Times apart from the other columns (row, column); cells of a text show how many digits its times have."""
    at, unit = next((i, unit) for i, label in enumerate(labels) if (unit := _time_unit(label, channels)))
    clock = np.asarray(convert(values[:, at], unit, "s"), float)
    digit = 0.0
    if cells is not None:
        digit = cells.printed_digit(at)
    elif file == FRAME:
        digit = printed_digit(map(repr, values[:, at].tolist()))
    time = even_time(clock, digit * (1e-3 if unit == "ms" else 1.0), file, None if cells is None else cells.lines)
    others = [label for i, label in enumerate(labels) if i != at]
    return time, others, np.delete(values, at, axis=1)


def _trial(source: Source, table: TimedColumns, channels: Mapping[str, str] | None) -> Trial:
    time, labels, values = table
    return check_trial(source, time, values, [find_column(label, source.file, channels) for label in labels])


def write_table(recording: Recording, path: Path | str) -> Path:
    """Write a recording as a plain table with units, whole or not at all, without suspect marks, subject, condition."""
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
    import pandas as pd

    text = pd.DataFrame(table, columns=list(map(quote, labels))).to_csv(index=False, lineterminator="\n")
    return write_whole(path, text)


def _time_unit(label: str, channels: Mapping[str, str] | None = None) -> str | None:
    name, unit, _ = read_label(label, channels)
    if name.lower() not in _TIME_UNIT:
        return None
    return _TIME_UNIT[name.lower()] if unit is None else unit if unit in ("s", "ms") else None


def _text(raw: RawFile, channels: Mapping[str, str] | None) -> tuple[list[str], Cells]:
    lines = raw.lines()
    top = next((i for i, line in enumerate(lines) if line.strip() and not line.startswith("#")), None)
    if top is None:
        raise _no_time(raw.name, "it contains only comments")
    named = (i for i in range(top, min(len(lines), top + LEADING)) if _header(lines[i], channels))
    top = next(named, top)
    separator, labels = _header(lines[top], channels) or (",", [])
    if not labels:
        raise _no_time(raw.name, f"line {top + 1} is {lines[top][:60]!r}")
    _check_labels(labels, f"{raw.name}, line {top + 1}")
    units = _units_below(lines[top + 1 : top + 2], labels, separator)
    labels, top = (units, top + 1) if units else (labels, top)
    comma = separator != "," and any("," in line for line in lines[top + 1 : top + 50])
    ignored = frozenset(label for label in labels if read_label(label, channels)[0] == IGNORE)
    form = Form(raw.name, separator, "," if comma else ".", ignored)
    return labels, parse_cells(lines[top + 1 :], labels, top + 2, form)


def _header(line: str, channels: Mapping[str, str] | None) -> tuple[str, list[str]] | None:
    """Separator and labels of a line that names a column of times; None of any other."""
    for separator in ",;\t":
        labels = [unquote(label.strip()) for label in next(csv.reader([line], delimiter=separator), [])]
        if any(_time_unit(label, channels) for label in labels):
            return separator, labels
    return None


def _units_below(below: Sequence[str], labels: Sequence[str], separator: str) -> list[str]:
    """Labels with the units of a line below them, where that line holds units and blanks alone; else nothing."""
    cells = [cell.strip().strip("()[]") for line in below for cell in next(csv.reader([line], delimiter=separator), [])]
    units = [re.sub(r"/s2?$", "", cell) for cell in cells if cell and cell != "ms"]
    unknown = any(unit[:1].isdigit() or parse_unit(unit) is None for unit in units)
    if len(cells) != len(labels) or not any(cells) or unknown:
        return []
    return [
        f"{label} [{cell}]" if cell and split_unit(label)[1] is None else label
        for label, cell in zip(labels, cells, strict=True)
    ]


def _check_labels(labels: Sequence[str], where: str) -> None:
    names = [split_unit(label)[0] for label in labels]
    if "" in names:
        raise ReadError(f"{where}: every column must have a name", f"column {names.index('') + 1} has none", "Name it.")
    if len(labels) < 2:
        raise ReadError(f"{where}: a table must have channels", "time is its only column", "Export the channels.")


def _no_time(file: str, fault: str) -> ReadError:
    return ReadError(
        f"{file} must have a column 'time [s]' (or time, time_s, time [ms])",
        fault,
        'Rename the column, or map it in the study\'s [channels]: "Frame time" = "time [s]".',
    )


def _of_frame(frame: pd.DataFrame, name: str, channels: Mapping[str, str] | None) -> tuple[list[str], Values]:
    """Labels and numbers (row, column) of a table in memory."""
    from pandas.api.types import is_bool_dtype, is_numeric_dtype

    frame = frame.loc[:, [read_label(str(label), channels)[0] != IGNORE for label in frame.columns]]
    labels = [str(label) for label in frame.columns]
    for label, dtype in zip(labels, frame.dtypes, strict=True):
        if not is_numeric_dtype(dtype) or is_bool_dtype(dtype) or dtype.kind == "c":
            remedy = "Give times as numbers of seconds." if _time_unit(label, channels) else "Remove that column."
            raise ReadError(f"{name}: columns must contain numbers", f"column {label!r} has type {dtype}", remedy)
    if not any(_time_unit(label, channels) for label in labels):
        raise _no_time(name, f"its columns are {', '.join(labels[:6])}")
    _check_labels(labels, name)
    values = frame.to_numpy(float, na_value=np.nan)
    if not len(values) or np.isinf(values).any():
        where = "it has no rows"
        if len(values):
            where = f"column {labels[int(np.argmax(np.isinf(values).any(axis=0)))]!r} contains infinite values"
        raise ReadError(f"{name} must have rows of finite numbers", where, "Export the table again.")
    return labels, values


def check_trial(source: Source, time: Values, values: Values, columns: Sequence[Column]) -> Trial:
    """Trial of columns (time, channel) in the file's units; a UnitError where angles contradict theirs."""
    findings: list[Finding] = []
    for unit in ("deg", "rad"):
        which = [i for i, c in enumerate(columns) if c.channel.quantity == "angle" and c.unit == unit]
        if which:
            names = [columns[i].channel.name for i in which]
            finding = plausible_unit(time, values[:, which], names, unit, source.file)[1]
            findings += [finding] if finding else []
    return sort_trial(source, time, values, columns, findings)


def read_events(lines: Sequence[str], file: str) -> tuple[Event, ...]:
    r"""Contacts and foot offs of a table; none of a table that is not one of events.

    A row an event: columns `time` [s] (or ms), `event` and, where the event's own name does not say it, `side`, in any
    order and under the names that laboratories and exports give them. A column a kind: `LHS`, `RTO` or `Left Foot
    Strike` above times [s].

    >>> read_events(["Subject,Context,Name,Time (s)", "A,Left,Foot Strike,0.52", "A,Left,Foot Off,1.21"], "a.csv")[0]
    Event(label='initial contact', side='l', time=0.52)
    >>> read_events(["LHS\tRTO", "0.52\t0.64"], "a.tsv")[1]
    Event(label='foot off', side='r', time=0.64)
    """
    for top, line in enumerate(lines[:LEADING_EVENTS]):
        for separator in ",;\t" if line.strip() else "":
            header = next(csv.reader([line], delimiter=separator))
            labels = [re.sub(r"\s+", " ", cell).strip().lower() for cell in header]
            rows = enumerate(csv.reader(lines[top + 1 :], delimiter=separator), top + 2)
            kinds = [event_kind(label, "") for label in labels]
            named, aside = (next((i for i, text in enumerate(labels) if text in words), -1) for words in (_KIND, _SIDE))
            timed = next((i for i, label in enumerate(labels) if _TIME.fullmatch(label)), -1)
            cells: list[tuple[int, str, str, str]] = []  # line, kind, side and time of each event
            if all(kind in STEPS for kind, _ in kinds):
                cells = [(n, *kind, cell) for n, row in rows for kind, cell in zip(kinds, row, strict=False)]
            elif min(named, timed) >= 0:
                full = ((n, row) for n, row in rows if len(row) >= len(labels))
                cells = [(n, *event_kind(row[named], row[aside] if aside >= 0 else ""), row[timed]) for n, row in full]
            if named >= 0 > timed and any(label.startswith("frame") for label in labels):
                needed = f"{file}: events must have a column of times, such as 'time [s]'"
                remedy = "Write times [s]: the frame minus the file's first frame, divided by the frame rate."
                raise ReadError(needed, f"line {top + 1} is {line.strip()[:60]!r}", remedy)
            if any(kind in STEPS for _, kind, _, _ in cells):
                unit_s = 1e-3 if timed >= 0 and "ms" in labels[timed] else 1.0
                steps = (cell for cell in cells if cell[1] in STEPS and cell[3].strip())
                return tuple(_event(*cell, unit_s, file) for cell in steps)
    return ()


def _event(line: int, kind: str, side: str, text: str, unit_s: float, file: str) -> Event:
    where = f"{file}, line {line}"
    if not side:
        remedy = "Write l or r in a column 'side', or 'Left' or 'Right' before the event."
        raise ReadError(f"{where}: each {kind} must have a side", "this line has none", remedy)
    try:
        return Event(kind, side, unit_s * float(text.replace(",", ".")))
    except ValueError as error:
        needed = f"{where}: the time of an event must be a number"
        raise ReadError(needed, f"found {text[:40]!r}", "Write a number in the column's unit, such as 1.23.") from error
