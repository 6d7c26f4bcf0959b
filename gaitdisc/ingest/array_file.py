"""Variables of `.mat` (v4 to v7.3) and `.npz` files, found by a path through structs and cell arrays."""

from __future__ import annotations

import re
from collections.abc import Callable, Mapping
from dataclasses import dataclass, replace
from functools import cache
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from gaitdisc.channel import nearest_word
from gaitdisc.errors import GaitdiscError, ReadError
from gaitdisc.ingest.hdf5 import SIGNATURE, attributes, data_set, hdf5_file
from gaitdisc.ingest.raw_file import RawFile, read_raw
from gaitdisc.ingest.reader_process import MEBIBYTE, Arrays, ReaderProcess, ReadRequest
from gaitdisc.regular_file import LARGEST_BYTES, size_in_words

_STEP = re.compile(r"\.([^.(){}]+)|\{(\d{1,9})\}|\((\d{1,9})\)")
_COLUMN = re.compile(r"\(\s*((?::|\d{1,9})(?:\s*,\s*(?::|\d{1,9}))+)\s*\)$")
_SHOWN = 12  # variables that a message names
_UNPACKED = (
    64 * MEBIBYTE,
    100,
)  # bytes, and times the file: measured values deflate up to 12 times, a bomb 1,000 times
_REMEDY = "See docs/sessions.md, recordings in .mat and .npz, for how a path is written."


@dataclass(frozen=True, eq=False)
class Cells:
    """Elements of a cell array or of an array of structs, in MATLAB's order."""

    held: tuple[Any, ...]  # nodes: mappings, `Cells`, arrays of numbers, or words that say what else there is


@dataclass(frozen=True, eq=False)
class ArrayFile:
    """A file of named variables; only those that are used are read."""

    raw: RawFile
    names: tuple[str, ...]
    opened: Callable[[str], Any]  # gives the node of one of them

    def numbers(self, path: str, part: str = "") -> NDArray[np.float64]:
        """Numbers at a path.

        path: `name`, `struct.field`, `cells{2}`, `structs(3).field`, and at the end columns counted from 1: `x(:,2)`
        part: stands for `*` in the path; a number also chooses among the elements of a cell array, or of structs, that
            the path does not choose from
        returns: as stored, or one column
        """
        whole = path.replace("*", part) if part else path
        columns = _COLUMN.search(whole)
        steps = whole[: columns.start()] if columns else whole
        top = max((n for n in self.names if steps == n or steps.startswith((f"{n}.", f"{n}{{", f"{n}("))), key=len,
                  default="")  # fmt: skip
        if not top:
            near = nearest_word(re.split(r"[.({]", steps)[0], self.names)
            hint = f", the nearest is {near!r}" if near else ""
            raise self._refused(whole, f"it has {_some(self.names)}{hint}", "Correct the path in [channels].")
        rest = steps[len(top) :]
        if "".join(found[0] for found in _STEP.finditer(rest)) != rest:
            raise self._refused(whole, f"{rest!r} is no path", _REMEDY)
        node = self.opened(top)
        for field, cell, place in _STEP.findall(rest):
            node = self._field(node, field, whole, part) if field else self._element(node, int(cell or place), whole)
        return self._column(self._checked(self._chosen(node, whole, part), whole), columns, whole)

    def _refused(self, path: str, found: str, remedy: str) -> ReadError:
        return ReadError(f"{self.raw.name}: a variable of numbers is needed at {path!r}", found, remedy)

    def _field(self, node: Any, field: str, path: str, part: str) -> Any:
        node = self._chosen(node, path, part)
        if not isinstance(node, Mapping):
            raise self._refused(path, f"{field!r} follows {_what(node)}, which is no struct", _REMEDY)
        if field not in node:
            near = nearest_word(field, node)
            hint = f", the nearest is {near!r}" if near else ""
            raise self._refused(path, f"the struct has {_some(tuple(node))}{hint}", "Correct the path in [channels].")
        return node[field]

    def _element(self, node: Any, number: int, path: str) -> Any:
        if isinstance(node, Mapping) and number == 1:
            return node
        if not isinstance(node, Cells):
            raise self._refused(path, f"element {number} follows {_what(node)}", _REMEDY)
        if not 1 <= number <= len(node.held):
            raise self._refused(path, f"it has {len(node.held)} elements and no element {number}", "They count from 1.")
        return node.held[number - 1]

    def _chosen(self, node: Any, path: str, part: str) -> Any:
        """The only element, or the one that `part` says."""
        if not isinstance(node, Cells):
            return node
        if part.isdecimal():
            return self._element(node, int(part), path)
        if len(node.held) == 1:
            return node.held[0]
        remedy = f'Write part = "1" to "{len(node.held)}" beside the trial\'s files, or path{{1}}.'
        raise self._refused(path, f"it holds {len(node.held)} elements", remedy)

    def _checked(self, node: Any, path: str) -> NDArray[np.float64]:
        if not isinstance(node, np.ndarray):
            raise self._refused(path, f"it is {_what(node)}", "Name another variable, or save it as plain numbers.")
        values = np.array(node, float)
        if not values.size or np.isinf(values).any():
            found = "it is empty" if not values.size else f"{int(np.isinf(values).sum())} numbers in it are infinite"
            raise self._refused(path, found, "Save it again, with NaN where nothing was measured.")
        return values

    def _column(self, values: NDArray[np.float64], columns: re.Match[str] | None, path: str) -> NDArray[np.float64]:
        if columns is None:
            return values
        wanted = [one.strip() for one in columns[1].split(",")]
        fits = len(wanted) == values.ndim and wanted.count(":") == 1
        fits = fits and all(w == ":" or 1 <= int(w) <= n for w, n in zip(wanted, values.shape, strict=True))
        if not fits:
            remedy = "Columns count from 1, and one ':' stands for time: (:,2)."
            raise self._refused(path, f"it is {_shape(values)}", remedy)
        return values[tuple(slice(None) if one == ":" else int(one) - 1 for one in wanted)]

    def overview(self) -> str:
        """Variables at the top of the file, in words."""
        return f"{self.raw.name} holds {_some(self.names)}"


def open_arrays(path: Path | str, process: ReaderProcess | None = None) -> ArrayFile:
    """File of variables, opened; nothing in it is ever unpickled.

    process: reads all but `.mat` of v7.3, which HDF5 reads here; without it one is started
    """
    path = Path(path)
    raw = read_raw(path, LARGEST_BYTES)
    is_npz = path.suffix.lower() == ".npz"
    if not is_npz and SIGNATURE in (raw.content[: len(SIGNATURE)], raw.content[512 : 512 + len(SIGNATURE)]):
        with hdf5_file(path) as file:
            names = tuple(name for name in map(str, file) if not name.startswith("#"))
        return ArrayFile(raw, names, lambda name: _of_hdf5(path, name))
    return _in_process(raw, path, process or ReaderProcess())


def _in_process(raw: RawFile, path: Path, process: ReaderProcess) -> ArrayFile:
    most = min(_UNPACKED[0] + _UNPACKED[1] * len(raw.content), LARGEST_BYTES)

    def answered(name: str) -> tuple[dict[str, Any], Arrays]:
        wanted = ReadRequest.of_size(str(path), "arrays", (name,), len(raw.content))
        answer, arrays = process.read(replace(wanted, cap_bytes=wanted.cap_bytes + 3 * most))  # packed, read, as float
        said = answer.get("said", "").replace(str(path), path.name)
        if "allow_pickle" in said:
            raise ReadError(
                f"{raw.name}: {name!r} is to be an array of numbers",
                "it holds Python objects, which are never unpickled, since that may run any program",
                "Save it as plain arrays: numpy.savez without objects.",
            )
        if said:
            needed = f"{raw.name} is to be read as {'an .npz' if path.suffix.lower() == '.npz' else 'a .mat'} file"
            found = f"it cannot be: its reader says: {' '.join(said.split())[:160].rstrip('.')}"
            raise ReadError(needed, found, "Save it again; it may be cut short, or no such file.")
        return answer, arrays

    claims = answered("")[0]["claims"]

    @cache
    def opened(name: str) -> Any:
        if claims[name] > most:
            raise ReadError(
                f"{raw.name}: a variable of at most {size_in_words(most)} is unpacked from a file of its size",
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
        return Cells(tuple(_node(one, arrays) for one in tree["cells"]))
    return {name: _node(one, arrays) for name, one in tree["fields"].items()}


def _of_hdf5(path: Path, name: str) -> Any:
    """Node of a variable of a v7.3 file; structs are groups, cells are references, arrays stand transposed."""
    with hdf5_file(path) as file:
        return _hdf5_node(file, name, path)


class _Group(Mapping[str, Any]):
    """Struct of a v7.3 file; each field is read when it is used. With a number: that element of all fields."""

    def __init__(self, path: Path, name: str, number: int | None = None) -> None:
        self._path, self._name, self._number = path, name, number

    def __getitem__(self, field: str) -> Any:
        found = _of_hdf5(self._path, f"{self._name}/{field}")
        return found.held[self._number] if self._number is not None and isinstance(found, Cells) else found

    def __contains__(self, field: object) -> bool:
        return field in tuple(iter(self))

    def __iter__(self):
        with hdf5_file(self._path) as file:
            names = tuple(map(str, file[self._name]))
        return iter(names)

    def __len__(self) -> int:
        return len(tuple(iter(self)))


def _hdf5_node(file: Any, name: str, path: Path) -> Any:
    import h5py

    try:
        held = file[name]
        if isinstance(held, h5py.Group):
            return _structs(file, name, path)
        if h5py.check_ref_dtype(held.dtype) is not None:
            if held.size > 10**6:
                return f"a cell array of {held.size} elements"
            return Cells(tuple(_hdf5_node(file, file[one].name, path) for one in held[()].ravel()))
    except GaitdiscError:
        raise
    except Exception as error:  # its errors have no common ancestor
        said = " ".join(str(error).split())[:160] or type(error).__name__
        raise ReadError(f"{path.name} is to be read as a .mat file", f"{name!r}: {said}", "Save it again.") from error
    marks = attributes(file, name, path, ("MATLAB_class", "MATLAB_empty"))
    kind = marks.get("MATLAB_class", b"")
    word = kind.decode("ascii", "replace") if isinstance(kind, bytes) else str(kind)
    if marks.get("MATLAB_empty"):
        return np.empty(0)
    if word in ("char", "function_handle", "string") or getattr(held.dtype, "names", None):
        return "text" if word == "char" else "complex numbers, which no recording has" if held.dtype.names else word
    return data_set(file, name, path).T


def _structs(file: Any, name: str, path: Path) -> Any:
    """One struct, or as many as each of its fields has references that are no cell array's."""
    import h5py

    counts = set()
    for field in file[name].values():
        is_refs = isinstance(field, h5py.Dataset) and h5py.check_ref_dtype(field.dtype) is not None
        counts.add(field.size if is_refs and "MATLAB_class" not in field.attrs else None)
    (count,) = counts if len(counts) == 1 else (None,)
    if count is None:
        return _Group(path, name)
    return Cells(tuple(_Group(path, name, number) for number in range(min(count, 10**6))))


def _what(node: Any) -> str:
    if isinstance(node, Mapping):
        return f"a struct of {_some(tuple(node))}"
    if isinstance(node, Cells):
        return f"{len(node.held)} elements"
    if isinstance(node, np.ndarray):
        return f"an array of {_shape(node)}"
    return str(node)


def _shape(values: NDArray[Any]) -> str:
    return " x ".join(map(str, values.shape)) or "one number"


def _some(names: tuple[str, ...]) -> str:
    more = f" and {len(names) - _SHOWN} more" if len(names) > _SHOWN else ""
    return ", ".join(names[:_SHOWN]) + more if names else "nothing"
