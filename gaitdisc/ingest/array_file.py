"""Trials in `.mat` (v4 to v7.3) and `.npz` files: variables at a path through structs and cell arrays.

The study says which variable is which channel, its unit and its rate.
"""

import re
from collections.abc import Callable, Mapping
from dataclasses import dataclass
from functools import cache, partial
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from gaitdisc.channel import hint_nearest, list_names
from gaitdisc.errors import GaitdiscError, ReadError, SamplingError, UnitError
from gaitdisc.ingest.cells import even_time
from gaitdisc.ingest.columns import Column, column_in_unit, find_clock, find_column, name_channel, split_unit
from gaitdisc.ingest.hdf5 import SIGNATURE, attributes, data_set, hdf5_file
from gaitdisc.ingest.raw_file import RawFile, read_raw
from gaitdisc.ingest.reader_process import MEBIBYTE, Arrays, ReaderProcess, find_limits
from gaitdisc.ingest.table import check_trial
from gaitdisc.recording import Finding, Recording, Trial
from gaitdisc.recording.arrays import Values
from gaitdisc.regular_file import LARGEST_BYTES, size_in_words

_STEP = re.compile(r"\.([^.(){}]+)|\{(\d{1,9})\}|\((\d{1,9})\)")
_COLUMN = re.compile(r"\(\s*((?::|\d{1,9})(?:\s*,\s*(?::|\d{1,9}))+)\s*\)$")
_SHOWN = 12  # variables that a message names
_UNPACKED = (64 * MEBIBYTE, 100)  # bytes, and times the file: values deflate up to 12 times, a bomb 1,000 times
_REMEDY = "See docs/sessions.md, section on recordings in .mat and .npz, for the form of a path."
_COMPLEX = "an array of complex numbers, which a recording cannot contain"


@dataclass(frozen=True, eq=False)
class ArrayFile:
    """A file of named variables; only those that are used are read."""

    raw: RawFile
    names: tuple[str, ...]
    # gives the node of one of them: a struct is a mapping; a cell array or an array of structs a tuple, in MATLAB's
    # order; numbers are an array; words say what else there is
    opened: Callable[[str], Any]

    def numbers(self, path: str, part: str = "") -> Values:
        """Numbers at a path.

        path: `name`, `struct.field`, `cells{2}`, `structs(3).field`, and at the end columns counted from 1: `x(:,2)`
        part: stands for `*` in the path; a number also chooses among the elements of a cell array, or of structs, that
            the path does not choose from
        returns: as stored, or one column
        """
        full = path.replace("*", part) if part else path
        columns = _COLUMN.search(full)
        steps = full[: columns.start()] if columns else full
        top = max((n for n in self.names if steps == n or steps.startswith((f"{n}.", f"{n}{{", f"{n}("))), key=len,
                  default="")  # fmt: skip
        if not top:
            hint = hint_nearest(re.split(r"[.({]", steps)[0], self.names)
            fault = f"it has {list_names(self.names, _SHOWN)}{hint}"
            raise self._refuse(full, fault, "Correct the path in [channels].")
        rest = steps[len(top) :]
        if "".join(step[0] for step in _STEP.finditer(rest)) != rest:
            raise self._refuse(full, f"{rest!r} is not a path", _REMEDY)
        node = self.opened(top)
        for field, cell, place in _STEP.findall(rest):
            node = self._field(node, field, full, part) if field else self._element(node, int(cell or place), full)
        return self._column(self._chosen(node, full, part), columns, full)

    def _refuse(self, path: str, fault: str, remedy: str) -> ReadError:
        return ReadError(f"{self.raw.name}: {path!r} must name a variable of numbers", fault, remedy)

    def _field(self, node: Any, field: str, path: str, part: str) -> Any:
        node = self._chosen(node, path, part)
        if not isinstance(node, Mapping):
            raise self._refuse(path, f"{field!r} follows {_what(node)}, which is not a struct", _REMEDY)
        if field not in node:
            fault = f"the struct has {list_names(tuple(node), _SHOWN)}{hint_nearest(field, node)}"
            raise self._refuse(path, fault, "Correct the path in [channels].")
        held = node[field]
        return held() if callable(held) else held

    def _element(self, node: Any, number: int, path: str) -> Any:
        if isinstance(node, Mapping) and number == 1:
            return node
        if not isinstance(node, tuple):
            raise self._refuse(path, f"element {number} follows {_what(node)}", _REMEDY)
        if not 1 <= number <= len(node):
            fault = f"there is no element {number} (number of elements: {len(node)})"
            raise self._refuse(path, fault, f"Give a number from 1 to {len(node)}.")
        return node[number - 1]

    def _chosen(self, node: Any, path: str, part: str) -> Any:
        """The only element, or the one that `part` says."""
        if not isinstance(node, tuple):
            return node
        if part.isdecimal():
            return self._element(node, int(part), path)
        if len(node) == 1:
            return node[0]
        remedy = f'Write part = "1" (up to "{len(node)}") in the trial, or name an element: path{{1}}.'
        raise self._refuse(path, f"it holds {len(node)} elements", remedy)

    def _column(self, node: Any, columns: re.Match[str] | None, path: str) -> Values:
        if not isinstance(node, np.ndarray):
            raise self._refuse(path, f"it is {_what(node)}", "Name another variable, or save it as a numeric array.")
        values = np.array(node, float)
        if not values.size or np.isinf(values).any():
            fault = "it is empty" if not values.size else f"it contains {int(np.isinf(values).sum())} infinite numbers"
            raise self._refuse(path, fault, "Save it again, with NaN for missing values.")
        if columns is None:
            return values
        indices = [index.strip() for index in columns[1].split(",")]
        fits = len(indices) == values.ndim and indices.count(":") == 1
        fits = fits and all(w == ":" or 1 <= int(w) <= n for w, n in zip(indices, values.shape, strict=True))
        if not fits:
            remedy = "Give a column, counted from 1, and ':' for the time, as in (:,2)."
            raise self._refuse(path, f"it is {_shape(values)}", remedy)
        return values[tuple(slice(None) if index == ":" else int(index) - 1 for index in indices)]


def open_arrays(path: Path | str, process: ReaderProcess | None = None) -> ArrayFile:
    """File of variables, opened, nothing unpickled; a process reads all but `.mat` of v7.3, which HDF5 reads here."""
    path = Path(path)
    raw = read_raw(path, LARGEST_BYTES)
    is_npz = path.suffix.lower() == ".npz"
    if not is_npz and SIGNATURE in (raw.content[: len(SIGNATURE)], raw.content[512 : 512 + len(SIGNATURE)]):
        with hdf5_file(path) as file:
            names = tuple(name for name in map(str, file) if not name.startswith("#"))
        return ArrayFile(raw, names, lambda name: _of_hdf5(path, name))
    process = process or ReaderProcess()
    most = min(_UNPACKED[0] + _UNPACKED[1] * len(raw.content), LARGEST_BYTES)
    limits = find_limits(len(raw.content))
    limits["cap_bytes"] += 3 * most  # packed, read, floats

    def answered(name: str) -> tuple[dict[str, Any], Arrays]:
        answer, arrays = process.read(path, "arrays", (name,), **limits)
        reason = answer.get("said", "").replace(str(path), path.name)
        if "allow_pickle" in reason:
            raise ReadError(
                f"{raw.name}: {name!r} must be an array of numbers",
                "it contains Python objects, which are never unpickled, because unpickling can run any program",
                "Save it as numeric arrays: numpy.savez without objects.",
            )
        if reason:
            needed = f"{raw.name} cannot be read as {'an .npz' if is_npz else 'a .mat'} file"
            fault = f"the reader reports: {' '.join(reason.split())[:160].rstrip('.')}"
            raise ReadError(needed, fault, "Save it again. It may be incomplete or of another type.")
        return answer, arrays

    claims = answered("")[0]["claims"]

    @cache
    def opened(name: str) -> Any:
        if claims[name] > most:
            raise ReadError(
                f"{raw.name}: a variable in a file of this size may unpack to at most {size_in_words(most)}",
                f"{name!r} claims {size_in_words(claims[name])}",
                "Save it again in parts, or without compression.",
            )
        answer, arrays = answered(name)
        return _node(answer["tree"], arrays)

    return ArrayFile(raw, tuple(claims), opened)


def _node(tree: Any, arrays: Arrays) -> Any:
    """Node of what the process handed back: see `_tree` in reader_worker.py."""
    if isinstance(tree, int):
        return arrays[tree]
    if not isinstance(tree, dict):
        return tree
    if "cells" in tree:
        return tuple(_node(cell, arrays) for cell in tree["cells"])
    return {name: _node(member, arrays) for name, member in tree["fields"].items()}


def _of_hdf5(path: Path, name: str, number: int | None = None) -> Any:
    """Node of a v7.3 file, or an element of it: structs are groups, cells references, arrays stand transposed."""
    with hdf5_file(path) as file:
        node = _hdf5_node(file, name, path)
    return node[number] if number is not None and isinstance(node, tuple) else node


def _hdf5_node(file: Any, name: str, path: Path) -> Any:
    import h5py

    try:
        held = file[name]
        if isinstance(held, h5py.Group):
            return _structs(file, name, path)
        if h5py.check_ref_dtype(held.dtype) is not None:
            if held.size > 10**6:
                return f"a cell array of {held.size} elements"
            return tuple(_hdf5_node(file, file[reference].name, path) for reference in held[()].ravel())
    except GaitdiscError:
        raise
    except Exception as error:  # its errors have no common ancestor
        reason = " ".join(str(error).split())[:160] or type(error).__name__
        raise ReadError(f"{path.name} must be a .mat file", f"at {name!r}: {reason}", "Save it again.") from error
    marks = attributes(file, name, path, ("MATLAB_class", "MATLAB_empty"))
    kind = marks.get("MATLAB_class", b"")
    word = kind.decode("ascii", "replace") if isinstance(kind, bytes) else str(kind)
    if marks.get("MATLAB_empty"):
        return np.empty(0)
    if held.dtype.names or word in ("char", "function_handle", "string"):
        return "text" if word == "char" else _COMPLEX if held.dtype.names else word
    return data_set(file, name, path).T


def _structs(file: Any, name: str, path: Path) -> Any:
    """One struct, or as many as each field has references that are no cell array's; fields are read when used."""
    import h5py

    counts = set()
    for field in file[name].values():
        is_refs = isinstance(field, h5py.Dataset) and h5py.check_ref_dtype(field.dtype) is not None
        counts.add(field.size if is_refs and "MATLAB_class" not in field.attrs else None)
    (count,) = counts if len(counts) == 1 else (None,)
    names = tuple(map(str, file[name]))
    structs = (
        {field: partial(_of_hdf5, path, f"{name}/{field}", number) for field in names}
        for number in ((None,) if count is None else range(min(count, 10**6)))
    )
    return next(structs) if count is None else tuple(structs)


def _what(node: Any) -> str:
    if isinstance(node, Mapping):
        return f"a struct of {list_names(tuple(node), _SHOWN)}"
    if isinstance(node, tuple):
        return f"{len(node)} elements"
    if isinstance(node, np.ndarray):
        return f"an array of {_shape(node)}"
    return str(node)


def _shape(values: NDArray[Any]) -> str:
    return " x ".join(map(str, values.shape)) or "one number"


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
    mapped = {label: entry for label, entry in (channels or {}).items() if find_clock(entry)}
    if not mapped:
        raise ReadError(
            f"the study's [channels] must state the channel, unit and rate of each variable of {file.raw.name}",
            f"no variable is mapped (the file contains {list_names(file.names, _SHOWN)})",
            'Write for example "knee(:,1)" = "knee_angle_r [deg] @ 100 Hz"; see docs/sessions.md.',
        )
    bases: list[tuple[Values, list[Values], list[Column]]] = []
    for label, entry in mapped.items():
        columns, values = _columns(file, label, entry, part)
        time = _time(file, label, find_clock(entry), len(values), part)
        base = next((b for b in bases if len(b[0]) == len(time) and np.allclose(b[0], time, rtol=0, atol=1e-9)), None)
        if base is None:
            base = (time, [], [])
            bases.append(base)
        base[1].append(values)
        base[2].extend(columns)
    source = file.raw.source(file.raw.name.rpartition(".")[2].lower())
    trials = [check_trial(source, time, np.hstack(arrays), columns) for time, arrays, columns in bases]
    streams: dict[str, Recording] = {}
    findings: list[Finding] = []
    for trial in trials:
        for key, recording in trial.streams.items():
            if key in streams:
                other = streams[key]
                raise SamplingError(
                    f"{file.raw.name}: all {key} must have one time base",
                    f"{other.names[0]} has {len(other.time)} samples at {other.rate_hz:g} Hz, {recording.names[0]} "
                    f"{len(recording.time)} at {recording.rate_hz:g} Hz",
                    "Correct the rates in [channels], or remove one channel.",
                )
            streams[key] = recording
        findings += trial.findings
    return Trial(trials[0].name, streams, findings=tuple(findings))


def _columns(file: ArrayFile, label: str, entry: str, part: str) -> tuple[list[Column], Values]:
    """Channel of one column, or the three of a marker."""
    values = file.numbers(label, part)
    flat = values.squeeze()
    if flat.ndim <= 1:
        return [find_column(label, file.raw.name, {label: entry})], flat.reshape(-1, 1)
    name, unit = split_unit(entry)
    if flat.ndim == 2 and flat.shape[1] in (3, 4) and name_channel(name).quantity == "signal":  # 4: with a residual
        if unit is None:
            needed = f"{file.raw.name}: the marker {name!r} of {label!r} must have a unit"
            raise UnitError(needed, "the study states none", f'Write "{label}" = "{name} [mm] @ 100 Hz".')
        columns = [column_in_unit(label, name_channel(f"{name}.{axis}"), unit, file.raw.name) for axis in "xyz"]
        return columns, flat[:, :3]
    raise ReadError(
        f"{file.raw.name}: {label!r} must have one column for {name!r}, or three for a marker",
        f"its shape is {' x '.join(map(str, values.shape))}",
        f"Name one column, counted from 1: {label}(:,1).",
    )


def _time(file: ArrayFile, label: str, clock: str, samples: int, part: str) -> Values:
    """Even times of a variable [s], from a number of Hz, or a variable that holds a rate or times."""
    text, unit = split_unit(clock)
    number = text.lower().removesuffix("hz").strip()
    try:
        rate_hz = float(number)
    except ValueError:
        stated = file.numbers(text, part).squeeze()
        if stated.ndim == 1 and stated.size > 1:
            if stated.size != samples:
                raise SamplingError(
                    f"{file.raw.name}: {label!r} must have one time for each sample",
                    f"{label!r} has {samples} samples, but {text!r} has {stated.size} times",
                    f"Name a variable of {samples} times, or another column.",
                ) from None
            return even_time(stated * (1e-3 if unit == "ms" else 1.0), 0.0, file.raw.name)
        rate_hz = float(stated.ravel()[0])
    if not 0.01 < rate_hz < 1e6 or samples < 2:
        raise SamplingError(
            f"{file.raw.name}: {label!r} must have a rate between 0.01 Hz and 1 MHz, and at least two samples",
            f"{clock!r} gives {rate_hz:g} Hz, and there are {samples} samples",
            "Correct the rate or the variable in [channels].",
        )
    return np.arange(samples) / rate_hz
