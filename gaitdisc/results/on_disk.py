"""Arrays that stay on the disk until they are looked at: a run of many participants holds a few at a time."""

from __future__ import annotations

import hashlib
import io
import zipfile
from collections.abc import Callable, Iterator, Mapping
from dataclasses import dataclass
from functools import lru_cache
from pathlib import Path
from typing import Any, Generic, TypeVar

import numpy as np
from numpy.typing import NDArray

from gaitdisc._version import __version__
from gaitdisc.errors import SchemaError

T = TypeVar("T")
Kind = TypeVar("Kind")
Arrays = Mapping[str, NDArray[np.float64]]
KEPT_FILES = 2  # of which the arrays stay in memory: both walks of one participant
AGAIN = "Run the command that wrote it again; `gaitdisc run` keeps what is whole and computes the rest anew."
CHANGED = "changed since it was saved (SHA-256 differs)"


class DamagedError(SchemaError):
    """A file of results that is not as it was saved."""

    path: Path
    what: str


@dataclass(frozen=True)
class OnDisk(Generic[T]):
    """Something made of the arrays of one file each time it is used."""

    path: Path
    sha256: str  # hash it had when it was saved
    made: Callable[[Arrays], T]

    def __call__(self) -> T:
        """Read the file, or take what was just read of it."""
        return self.made(_arrays(self.path, self.sha256))


@dataclass(frozen=True)
class StoredArrays(Mapping[str, NDArray[np.float64]]):
    """Arrays of one file by name, read when one of them is used."""

    path: Path
    sha256: str  # hash it had when it was saved; empty where there is no file, and no array

    def __getitem__(self, name: str) -> NDArray[np.float64]:
        return self._read()[name]

    def __iter__(self) -> Iterator[str]:
        return iter(self._read())

    def __len__(self) -> int:
        return len(self._read())

    def later(self, made: Callable[[Arrays], T]) -> Any:
        """Return what shall be made of the arrays when it is looked at, for a field that `may_lie_on_disk`."""
        return OnDisk(self.path, self.sha256, made)

    def _read(self) -> Arrays:
        return _arrays(self.path, self.sha256) if self.sha256 else {}


def may_lie_on_disk(*fields: str) -> Callable[[type[Kind]], type[Kind]]:
    """Let fields of a dataclass be given as `OnDisk`; who reads such a field gets its value, which is not kept.

    >>> @may_lie_on_disk("curves")
    ... @dataclass(frozen=True)
    ... class Kept:
    ...     curves: list[int]
    >>> Kept([1, 2]).curves
    [1, 2]
    """

    def marked(kind: type[Kind]) -> type[Kind]:
        for name in fields:
            setattr(kind, name, _Field(name))
        return kind

    return marked


def lies_on_disk(thing: object, field: str) -> bool:
    """Whether a field was given as `OnDisk`."""
    return isinstance(vars(thing)[field], OnDisk)


def damaged(path: Path, what: str, do: str = AGAIN) -> DamagedError:
    """Return the refusal of a file that is not as it was saved."""
    error = DamagedError(
        "results need every file of their folder as it was saved", f"{path.parent.name}/{path.name} is {what}", do
    )
    error.path, error.what = path, what
    return error


def of_another_format(path: Path, found: object, ours: int) -> DamagedError:
    """Return the refusal of a file that another version of gaitdisc wrote."""
    do = f"Another version wrote it: install that one to read it, or compute it again with {__version__}."
    return damaged(path, f"of format {str(found)[:20]}, not {ours}", do)


class _Field:
    """Descriptor that reads `OnDisk` when it is looked at; a dataclass sets it as any other field."""

    def __init__(self, name: str) -> None:
        self._name = name

    def __get__(self, thing: object, kind: type | None = None) -> Any:
        if thing is None:
            raise AttributeError(self._name)
        value = vars(thing)[self._name]
        return value() if isinstance(value, OnDisk) else value

    def __set__(self, thing: object, value: object) -> None:
        vars(thing)[self._name] = value


@lru_cache(maxsize=KEPT_FILES)
def _arrays(path: Path, sha256: str) -> Arrays:
    try:
        content = path.read_bytes()
        if hashlib.sha256(content).hexdigest() != sha256:
            raise damaged(path, CHANGED)
        with np.load(io.BytesIO(content), allow_pickle=False) as stored:
            return {key: stored[key] for key in stored.files}
    except FileNotFoundError:
        raise damaged(path, "missing") from None
    except (OSError, ValueError, EOFError, zipfile.BadZipFile) as error:
        raise damaged(path, f"not readable ({error})") from error
