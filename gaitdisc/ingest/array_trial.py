"""Trials in `.mat` and `.npz` files: the study says which variable is which channel, its unit and its rate."""

from __future__ import annotations

from collections.abc import Mapping
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from gaitdisc.errors import ReadError, SamplingError, UnitError
from gaitdisc.ingest.array_file import ArrayFile, open_arrays
from gaitdisc.ingest.clock import even_time
from gaitdisc.ingest.columns import Column, column_in_unit, column_of, named_channel, said_clock, split_unit
from gaitdisc.ingest.reader_process import ReaderProcess
from gaitdisc.ingest.streams import sorted_trial
from gaitdisc.ingest.table import checked_angles
from gaitdisc.recording import Finding, Recording, Trial

ENDINGS = (".mat", ".npz")


def read_arrays(
    path: Path | str, channels: Mapping[str, str] | None = None, part: str = "", process: ReaderProcess | None = None
) -> Trial:
    """Trial of variables in a `.mat` or `.npz` file.

    channels: the study's `[channels]`: path of a variable -> `name [unit] @ 100 Hz`, or `name [unit] @ variable` of a
        rate [Hz] or of times [s]. A marker's three columns are one entry. Entries without a rate are of other files
    part: which trial of a file that holds several: its number in cell arrays from 1, or what `*` stands for in paths
    process: reads the file, where one is running
    returns: streams as far as the study names their channels, each on its own clock
    """
    file = open_arrays(path, process)
    wanted = {label: said for label, said in (channels or {}).items() if said_clock(said)}
    if not wanted:
        raise ReadError(
            f"{file.raw.name} needs the study's [channels] to say which variable is which channel, its unit and rate",
            f"none says so; {file.overview()}",
            'Write for example "knee(:,1)" = "knee_angle_r [deg] @ 100 Hz"; see docs/sessions.md.',
        )
    bases: list[tuple[NDArray[np.float64], list[NDArray[np.float64]], list[Column]]] = []
    for label, said in wanted.items():
        columns, values = _columns(file, label, said, part)
        time = _time(file, label, said_clock(said), len(values), part)
        base = next((b for b in bases if len(b[0]) == len(time) and np.allclose(b[0], time, rtol=0, atol=1e-9)), None)
        if base is None:
            base = (time, [], [])
            bases.append(base)
        base[1].append(values)
        base[2].extend(columns)
    return _joined(file, [_trial(file, *base) for base in bases])


def _trial(
    file: ArrayFile, time: NDArray[np.float64], parts: list[NDArray[np.float64]], columns: list[Column]
) -> Trial:
    values = np.hstack(parts)
    findings = checked_angles(columns, time, values, file.raw.name)
    inside = np.column_stack([column.converted(values[:, i]) for i, column in enumerate(columns)])
    reader = file.raw.name.rpartition(".")[2].lower()
    return sorted_trial(file.raw.source(reader), time, inside, [column.channel for column in columns], findings)


def _joined(file: ArrayFile, trials: list[Trial]) -> Trial:
    streams: dict[str, Recording] = {}
    findings: list[Finding] = []
    for trial in trials:
        for key, recording in trial.streams.items():
            if key in streams:
                other = streams[key]
                raise SamplingError(
                    f"{file.raw.name}: all {key} must share one time base",
                    f"{other.names[0]} has {len(other.time)} samples at {other.rate_hz:g} Hz, {recording.names[0]} "
                    f"{len(recording.time)} at {recording.rate_hz:g} Hz",
                    "Correct the rates in [channels], or leave one out.",
                )
            streams[key] = recording
        findings += trial.findings
    return Trial(trials[0].name, streams, findings=tuple(findings))


def _columns(file: ArrayFile, label: str, said: str, part: str) -> tuple[list[Column], NDArray[np.float64]]:
    """Channel of one column, or the three of a marker."""
    values = file.numbers(label, part)
    flat = values.squeeze()
    if flat.ndim <= 1:
        return [column_of(label, file.raw.name, {label: said})], flat.reshape(-1, 1)
    name, unit = split_unit(said)
    if flat.ndim == 2 and flat.shape[1] in (3, 4) and named_channel(name).quantity == "signal":  # 4: with a residual
        if unit is None:
            needed = f"{file.raw.name}: the marker {name!r} of {label!r} needs a unit"
            raise UnitError(needed, "the study states none", f'Write "{label}" = "{name} [mm] @ 100 Hz".')
        return [column_in_unit(label, named_channel(f"{name}.{axis}"), unit, file.raw.name) for axis in "xyz"], flat[
            :, :3
        ]
    raise ReadError(
        f"{file.raw.name}: {label!r} needs one column for {name!r}, or three for a marker",
        f"it is {' x '.join(map(str, values.shape))}",
        f"Name one column, from 1: {label}(:,1).",
    )


def _time(file: ArrayFile, label: str, clock: str, samples: int, part: str) -> NDArray[np.float64]:
    """Even times of a variable [s], from a number of Hz, or a variable that holds a rate or times."""
    text, unit = split_unit(clock)
    number = text.lower().removesuffix("hz").strip()
    try:
        rate_hz = float(number)
    except ValueError:
        found = file.numbers(text, part).squeeze()
        if found.ndim == 1 and found.size > 1:
            if found.size != samples:
                raise SamplingError(
                    f"{file.raw.name}: {label!r} needs a time for each of its samples",
                    f"it has {samples} samples, {text!r} has {found.size} times",
                    "Name other times, or another column.",
                ) from None
            return even_time(found * (1e-3 if unit == "ms" else 1.0), 0.0, file.raw.name)
        rate_hz = float(found.ravel()[0])
    if not 0.01 < rate_hz < 1e6 or samples < 2:
        raise SamplingError(
            f"{file.raw.name}: {label!r} needs a rate between 0.01 Hz and 1 MHz, and two samples or more",
            f"{clock!r} gives {rate_hz:g} Hz, and there are {samples} samples",
            "Correct the rate in [channels].",
        )
    return np.arange(samples) / rate_hz
