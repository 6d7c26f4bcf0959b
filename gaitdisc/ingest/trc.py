"""Marker files of OpenSim (`.trc`): positions in m, blank cells and exact zeros are gaps."""

import re
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path

import numpy as np

from gaitdisc.channel import Channel
from gaitdisc.errors import ReadError, SamplingError, UnitError
from gaitdisc.ingest.c3d_labels import find_equal_labels, make_unique
from gaitdisc.ingest.cells import Form, check_counts, even_time, parse_cells
from gaitdisc.ingest.columns import Column, map_label, sort_trial, split_unit
from gaitdisc.ingest.raw_file import read_raw
from gaitdisc.ingest.stated_units import distance_from_origin, refuse_other_unit
from gaitdisc.recording import Finding, Trial
from gaitdisc.recording.arrays import mean_step
from gaitdisc.units import inner_unit, parse_unit

_KEYS = ("DataRate", "NumFrames", "NumMarkers", "Units")
RATE_TOLERANCE = 2e-3  # between the header's rate and the time column; 59.94 Hz may be called 60


@dataclass(frozen=True)
class TrcHeader:
    """What stands above the positions."""

    rate_hz: float
    frames: int
    markers: int
    unit: str
    labels: tuple[str, ...]
    body_line: int  # line in which the frames start, counted from 1


def read_trc(path: Path | str, channels: Mapping[str, str] | None = None) -> Trial:
    """Trial of one marker file.

    Labels are taken in their order, whatever column they stand over, since exporters shift that line by one tab. What
    stands before a colon in a label is the subject's name and is dropped. A marker at exactly (0, 0, 0) was not seen.

    returns: one stream, `markers`: `<marker>.x`, `.y`, `.z` [m], NaN in gaps
    """
    raw = read_raw(path)
    lines = raw.lines()
    header = parse_trc_header(lines, raw.name)
    coordinates = [f"{label}.{axis}" for label in header.labels for axis in "xyz"]
    cells = parse_cells(
        lines[header.body_line - 1 :], ["Frame#", "Time", *coordinates], header.body_line, Form(raw.name)
    )
    claims = ("frames", [header.frames], len(cells.values)), ("markers", [header.markers], len(header.labels))
    findings = check_counts(cells, lines, raw.name, *claims)
    digit = cells.printed_digit(1)
    time = even_time(cells.values[:, 1], digit, raw.name, cells.lines)
    step = mean_step(time)
    allowed = RATE_TOLERANCE / header.rate_hz + digit / (len(time) - 1)
    if abs(step - 1 / header.rate_hz) > allowed:
        raise SamplingError(
            f"{raw.name}: the header's DataRate and the time column must agree",
            f"DataRate states {header.rate_hz:g} Hz, but the times step by {step:.6g} s ({1 / step:.6g} Hz)",
            "Find out which one is correct and export the file again.",
        )
    positions = cells.values[:, 2:]
    far = distance_from_origin(np.where(positions == 0, np.nan, positions))
    refuse_other_unit(header.unit, far, raw.name, "Units in line 3")
    places = positions.reshape(len(positions), -1, 3).copy()
    places[(places == 0).all(axis=2)] = np.nan
    plain = [label.rpartition(":")[2].strip() or label for label in header.labels]
    findings += find_equal_labels(plain, raw.name)
    unlike = make_unique(plain, "marker")
    pairs = zip(header.labels, unlike, strict=True)
    mapped = [map_label(label, channels) or map_label(short, channels) for label, short in pairs]
    names = [split_unit(name)[0] if name else short for name, short in zip(mapped, unlike, strict=True)]
    if plain != list(header.labels):
        findings.append(Finding("note", "identifier", raw.name, "the part of the labels before ':' was removed", ""))
    columns = [Column(name, Channel(f"{name}.{axis}", "marker", "m"), header.unit) for name in names for axis in "xyz"]
    return sort_trial(raw.source("trc"), time, places.reshape(positions.shape), columns, findings)


def parse_trc_header(lines: Sequence[str], file: str) -> TrcHeader:
    """Header of a marker file."""
    if len(lines) < 4 or not lines[0].lstrip().startswith("PathFileType"):
        raise ReadError(
            f"{file} must be a marker file, whose first line begins with 'PathFileType'",
            f"it begins with {lines[0][:40]!r}",
            "Export it again as TRC, or correct its ending.",
        )
    fields = dict(zip(lines[1].split(), lines[2].split(), strict=False))
    absent = [key for key in _KEYS if key not in fields]
    if absent:
        raise ReadError(
            f"{file} must have {', '.join(_KEYS)} in line 2 and their values in line 3",
            f"{absent[0]} is missing or has no value",
            "Export the file again.",
        )
    rate, frames, markers = (_number(fields, key, file) for key in _KEYS[:3])
    unit = parse_unit(fields["Units"])
    if unit is None or inner_unit(unit) != "m":
        raise UnitError(
            f"{file}: markers must have a unit of length in line 3",
            f"Units is {fields['Units']!r}",
            "Write m, cm or mm.",
        )
    labels = tuple(label.strip() for label in lines[3].split("\t")[2:] if label.strip())
    if not labels:
        raise ReadError(f"{file} must name its markers in line 4", "the line has no names", "Export it again.")
    body = 4
    while body < len(lines) and (not lines[body].strip() or re.match(r"\s*X\d", lines[body], re.IGNORECASE)):
        body += 1
    return TrcHeader(rate, int(frames), int(markers), unit, labels, body + 1)


def _number(fields: Mapping[str, str], key: str, file: str) -> float:
    try:
        number = float(fields[key])
    except ValueError:
        number = 0.0
    if not 0 < number < 1e9:
        raise ReadError(f"{file}: {key} in line 3 must be above 0", f"found {fields[key]!r}", "Export it again.")
    return number
