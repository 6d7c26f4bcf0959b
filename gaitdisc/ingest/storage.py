"""OpenSim storage files (`.mot`, `.sto`): coordinates, ground forces, joint moments and EMG, read and written."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import replace
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from gaitdisc.channel import vocabulary
from gaitdisc.errors import ReadError
from gaitdisc.ingest.angle_unit import copied_coordinate_unit, plausible_unit
from gaitdisc.ingest.cells import Cells, Form, parsed_cells
from gaitdisc.ingest.clock import even_time, printed_digit
from gaitdisc.ingest.columns import Column, check_written_names
from gaitdisc.ingest.raw_file import read_raw
from gaitdisc.ingest.storage_columns import naming_findings, storage_columns
from gaitdisc.ingest.storage_header import StorageHeader, parsed_header
from gaitdisc.ingest.streams import sorted_trial
from gaitdisc.recording import Finding, Recording, Trial
from gaitdisc.whole_file import write_whole


def read_storage(path: Path | str, channels: Mapping[str, str] | None = None) -> Trial:
    """Trial of one OpenSim storage file.

    Both header styles are read, and both at once. What the header states about degrees is obeyed and checked against
    how far hips and knees move; translations are in m whatever it states. Wrong counts in a header are reported where
    the rows agree among themselves; fewer rows than it claims are refused, since the file was cut.

    channels: the study's `[channels]`: label -> `name` or `name [unit]`
    returns: streams `kinematics`, `emg`, `forces`, `moments`, `signals`, as far as the file has them
    Source: OpenSim documentation, "Storage (.sto) Files" and "Motion (.mot) Files".
    """
    raw = read_raw(path)
    lines = raw.lines()
    header = parsed_header(lines, raw.name)
    columns = storage_columns(header, raw.name, channels)
    form = Form(raw.name, header.separator)
    cells = parsed_cells(lines[header.body_line - 1 :], header.labels, header.body_line, form)
    findings = [*_check_counts(header, cells, raw.name), *naming_findings(columns, raw.name)]
    _check_last_cell(lines, cells, raw.name)
    time = even_time(cells.values[:, 0], printed_digit(cells.first_column), raw.name, cells.lines)
    columns, more = _in_true_unit(columns, header.degrees, time, cells.values[:, 1:], raw.name)
    values = np.column_stack([c.converted(cells.values[:, i]) for i, c in enumerate(columns, 1)])
    reader = raw.name.rpartition(".")[2].lower()
    return sorted_trial(raw.source(reader), time, values, [c.channel for c in columns], [*findings, *more])


def write_storage(recording: Recording, path: Path | str) -> Path:
    """Write a recording as an OpenSim storage file, whole or not at all.

    `inDegrees` is always stated. Channels that their names alone do not determine are described by lines such as
    `column 3=emg [V] r` in the header, which OpenSim passes over. Marks of suspect samples, subject and
    condition are not written.
    """
    path = Path(path)
    check_written_names(recording.names, path.name)
    angles = any(channel.quantity in ("angle", "translation") for channel in recording.channels)
    known = {channel.name: channel for channel in vocabulary().channels}
    header = [
        "Coordinates" if angles else "gaitdisc",
        "version=1",
        f"nRows={len(recording.time)}",
        f"nColumns={len(recording.channels) + 1}",
        "inDegrees=yes",
        *(
            f"column {number}={channel.quantity} [{channel.unit}] {channel.side}".rstrip()
            for number, channel in enumerate(recording.channels, 1)
            if known.get(channel.name) != channel or channel.quantity == "emg"
        ),
        "endheader",
        "\t".join(["time", *recording.names]),
    ]
    table = np.column_stack([recording.time, recording.values])
    rows = ("\t".join(map(repr, row)) for row in table.tolist())
    return write_whole(path, "\n".join([*header, *rows]) + "\n")


def _check_counts(header: StorageHeader, cells: Cells, file: str) -> list[Finding]:
    rows = len(cells.values)
    if header.rows and rows < max(header.rows):
        raise ReadError(
            f"{file} should have {max(header.rows)} rows of numbers, as its header says",
            f"it ends after {rows}, at line {cells.lines[-1]}",
            "The file was cut: copy or export it again.",
        )
    findings = []
    for kind, claimed, there in (("rows", header.rows, rows), ("columns", header.columns, len(header.labels))):
        wrong = sorted({count for count in claimed if count != there})
        if wrong:
            what = f"the header claims {' and '.join(map(str, wrong))} {kind}, {there} are there"
            findings.append(Finding("warning", "wrong count", file, what, "nothing here; other programs may refuse it"))
    return findings


def _check_last_cell(lines: Sequence[str], cells: Cells, file: str) -> None:
    """Refuse a last number that was cut: no line end, and shorter than all others of a column of one width."""
    if not lines[-1].strip() or len(cells.lines) < 3:
        return
    before = {len(str(lines[number - 1]).rstrip()) for number in cells.lines[:-1].tolist()}
    width = max(before)
    if len(before) == 1 and len(lines[-1]) < width:
        raise ReadError(
            f"{file}: every line has {width} characters",
            f"the last one, line {cells.lines[-1]}, stops after {len(lines[-1])}",
            "The file was cut: copy or export it again.",
        )


def _in_true_unit(
    columns: list[Column],
    degrees: bool | None,
    time: NDArray[np.float64],
    values: NDArray[np.float64],
    file: str,
) -> tuple[list[Column], list[Finding]]:
    """Columns of angles (and of their rates) in the unit that the file really has."""
    turning = [i for i, c in enumerate(columns) if c.unit.startswith("deg") and "[" not in c.label]
    angles = [i for i in turning if columns[i].channel.quantity == "angle"]
    if not turning:
        return columns, []
    stated = None if degrees is None else "deg" if degrees else "rad"
    findings = []
    unit = stated or "rad"  # speeds alone: OpenSim keeps states in radians
    if angles:
        names = [columns[i].channel.name for i in angles]
        unit, finding = plausible_unit(time, values[:, angles], names, stated, file)
        findings += [finding] if finding else []
    columns = [replace(c, unit=c.unit.replace("deg", unit)) if i in turning else c for i, c in enumerate(columns)]
    in_degrees = {columns[i].channel.name: columns[i].converted(values[:, i]) for i in angles}
    copies = []
    for i in angles:
        own = copied_coordinate_unit(columns[i].channel.name, values[:, i], in_degrees)
        if own and own != unit:
            columns[i] = replace(columns[i], unit=own)
            copies.append(columns[i].channel.name)
    if copies:
        what = f"{', '.join(copies)} in {'deg' if unit == 'rad' else 'rad'}, all other angles in {unit}; converted"
        findings.append(Finding("note", "mixed units", file, what, ""))
    return columns, findings
