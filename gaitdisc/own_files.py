"""Which files a command may replace: those that it wrote itself and that nobody has changed since; never its inputs.

Each folder that is written to holds a list: SHA-256, command and path of every file. A line is added before its file
takes its place, so a command that was killed knows its files again.
"""

import hashlib
import json
import os
from collections.abc import Callable, Iterable, Iterator, Mapping
from contextlib import ExitStack, contextmanager, suppress
from contextvars import ContextVar
from dataclasses import dataclass, field, replace
from functools import partial
from pathlib import Path
from typing import Any, NamedTuple, TypeVar

from gaitdisc.errors import WriteError
from gaitdisc.write_lock import write_lock

LIST = ".written-by-gaitdisc"
KINDS = (  # JSON files of results: a folder holds one of them
    *("run.json", "variant_run.json", "discovery.json", "mismatch.json", "reconstruction.json", "model.json"),
    "cycles.json",
)
PAGE = {"report.html", "figures", "tables", "report"}
REDRAWS = "gaitdisc report"  # draws pages that other commands drew before, and they draw them again
Lines = set[tuple[str, str, str]]  # SHA-256, command, path within the folder
Result = TypeVar("Result")


class Place(NamedTuple):
    """A folder that a command writes to."""

    folder: Path
    command: str
    lines: Lines
    known: bool = False  # whether the command has written there before
    mended: tuple[str, ...] = ()  # parts of the folder in which the command itself finds and mends what was changed

    def mends(self, path: Path) -> bool:
        """Whether the command itself finds changes in this file."""
        parts = path.relative_to(self.folder).parts
        return parts[0] in self.mended and not PAGE.intersection(parts)

    def wrote(self, path: Path, sha256: str = "") -> bool:
        """Whether the command, or one that shares its pages, wrote this file, or this very content of it."""
        name = path.relative_to(self.folder).as_posix()
        commands = {command for hashed, command, file in self.lines if file == name and hashed.startswith(sha256)}
        return bool(commands if self.command == REDRAWS else commands & {self.command, REDRAWS})

    def add(self, lines: Lines) -> None:
        """Add files to the list."""
        with (self.folder / LIST).open("a", encoding="utf-8", errors="surrogateescape") as file:
            file.writelines("  ".join(line) + "\n" for line in sorted(lines - self.lines))
        self.lines.update(lines)


@dataclass(frozen=True)
class Guard:
    """A command at work: what it reads, and where it writes."""

    command: str
    overwrite: bool
    inputs: list[os.stat_result] = field(default_factory=list)
    places: list[Place] = field(default_factory=list)
    held: ExitStack = field(default_factory=ExitStack)

    def take(self, place: Place, names: Iterable[str], lock: str = ".lock") -> None:
        """Refuse names that may not be written, then lock the folder, which is made where it is missing."""
        self.places.append(place)
        for name in (*place.mended, *names):
            self.find_place(place.folder / name)
        self.places[self.places.index(place)] = place._replace(known=True)
        made = [folder for folder in (place.folder, *place.folder.parents) if not folder.exists()]
        self.held.callback(_leave_no_empty_folder, place.folder, made)
        self.held.enter_context(write_lock(place.folder, lock))

    def find_place(self, path: Path) -> Place:
        """Place of a file that may be written; all others are refused. path: as `_resolve` gives it."""
        inside = [place for place in self.places if place.folder in path.parents]
        if not inside:
            inside = [Place(path.parent, self.command, _list_paths(path.parent))]
            self.take(inside[0], [path.name], f".lock-{path.name}")
        place = max(inside, key=lambda place: len(place.folder.parts))
        other = [name for name in KINDS if name != path.name and (path.parent / name).is_file()]
        if path.name in KINDS and other:
            raise _refusal(path.parent, f"already contains another kind of result ({other[0]})")
        if not os.path.lexists(path) or (place.known and place.mends(path)):
            return place
        if os.path.exists(path):  # noqa: PTH110 never raises
            state, same = path.stat(), os.path.samestat
            # of a file that was replaced, the number may be given to a new one
            if any(same(state, read) and state.st_mtime_ns == read.st_mtime_ns for read in self.inputs):
                raise _refusal(path, f"is an input of {self.command}")
        mended = path.is_dir() or place.mends(path)
        ours = place.known if mended else path.is_file() and place.wrote(path, file_sha256(path))
        if not ours and not self.overwrite:
            edited = not mended and place.wrote(path)
            what = f"was changed after {place.command} wrote it" if edited else f"was not written by {place.command}"
            way = "--overwrite" if self.command.startswith("gaitdisc") else "overwrite=True"
            raise _refusal(path, f"already exists and {what}", f", or use {way}")
        return place


_GUARD: ContextVar[Guard | None] = ContextVar("guard", default=None)


@contextmanager
def guard(command: str, inputs: Iterable[Path] = (), overwrite: bool = False) -> Iterator[None]:
    """Let all that is written within be a command's output; within another command it is that one's."""
    if _GUARD.get() is not None:
        yield
        return
    with _at_work(Guard(command, overwrite)):
        note_inputs(file for path in inputs for file in (path, *(path / name for name in KINDS)))
        yield


@contextmanager
def _at_work(guard: Guard) -> Iterator[None]:
    token = _GUARD.set(guard)
    try:
        with guard.held:
            yield
    finally:
        _GUARD.reset(token)


def note_inputs(paths: Iterable[Path]) -> None:
    """Say that a command reads these files."""
    guard = _GUARD.get()
    if guard is not None:
        guard.inputs.extend(path.stat() for path in paths if os.path.exists(path))  # noqa: PTH110 never raises


def claim_folder(folder: Path, *names: str, command: str = "", mended: tuple[str, ...] = ()) -> bool:
    """Refuse a folder before any work is done, or hold it until the command ends; return whether all there is replaced.

    names: what will be written there, as far as it is known now
    command: whose files these are, where it is another than the one at work
    """
    guard = _GUARD.get()
    if guard is not None:
        root, command = folder.resolve(), command or guard.command
        listed = (root / LIST).exists()
        earlier = set() if listed else _earlier_lines(root, KINDS if command == REDRAWS else names, command)
        guard.take(Place(root, command, _list_paths(root) | earlier, listed or bool(earlier), mended), names)
        if earlier or mended:  # a run's units, which it finds by themselves, stand on no list
            Place(root, command, set()).add(earlier)
    return guard is not None and guard.overwrite


def claim_file(path: Path) -> None:
    """Refuse a file before any work is done, or hold it until the command ends."""
    guard = _GUARD.get()
    if guard is not None:
        guard.find_place(_resolve(path))


def record_output(path: Path, written: Path) -> None:
    """Add a file to the list of its folder, before it takes its place; written: where it stands by now."""
    guard = _GUARD.get()
    if guard is not None:
        path = _resolve(path)
        place = guard.find_place(path)
        if not place.mends(path):
            place.add({(file_sha256(written), place.command, path.relative_to(place.folder).as_posix())})


def under_this_guard(work: Callable[..., Result]) -> Callable[..., Result]:
    """The same work for another process, which then writes as this command does."""
    guard = _GUARD.get()
    return work if guard is None else partial(_work_under, replace(guard, held=ExitStack()), work)


def note_outputs() -> None:
    """Take note of the files that other processes of this command have written."""
    guard = _GUARD.get()
    for place in guard.places if guard is not None else ():
        place.lines.update(_list_paths(place.folder))


def _work_under(guard: Guard, work: Callable[..., Result], *given: Any) -> Result:
    with _at_work(guard):
        return work(*given)


def file_sha256(path: Path) -> str:
    """SHA-256 of a file's bytes."""
    with path.open("rb") as file:
        return hashlib.file_digest(file, "sha256").hexdigest()


def content_sha256(data: Mapping[str, Any]) -> str:
    """SHA-256 of what is named, not of the bytes: another editor's line ends change no number."""
    return hashlib.sha256(json.dumps(data, sort_keys=True).encode()).hexdigest()


def _earlier_lines(folder: Path, names: Iterable[str], command: str) -> Lines:
    """Lines of a result that was saved before there were lists: pages, without hashes then, and all that is sealed."""
    saved = [folder / name for name in names if name.endswith(".json") and (folder / name).is_file()]
    if not any(b'"own_sha256"' in path.read_bytes() for path in saved):
        return set()
    files = [path for path in folder.rglob("*") if path.is_file()]
    hashes = {path: file_sha256(path) for path in files if PAGE.intersection(path.relative_to(folder).parts)}
    for path in (file for file in files if file.suffix == ".json"):
        with suppress(OSError, ValueError, LookupError, TypeError, AttributeError, RecursionError):
            data = json.loads(path.read_text(encoding="utf-8"))
            if data.pop("own_sha256") == content_sha256(data):
                named = {path.parent / name: sha256 for name, sha256 in data.get("sha256", {}).items()}
                hashes |= {path: file_sha256(path), **named}
    return {(sha256, command, path.relative_to(folder).as_posix()) for path, sha256 in hashes.items()}


def _list_paths(folder: Path) -> Lines:
    if not (folder / LIST).is_file():
        return set()
    text = (folder / LIST).read_text(encoding="utf-8", errors="surrogateescape")
    cells = (line.split("  ", 2) for line in text.split("\n"))
    return {(row[0], row[1], row[2]) for row in cells if len(row) == 3}


def _leave_no_empty_folder(folder: Path, made: list[Path]) -> None:
    with suppress(OSError):
        if [entry.name for entry in folder.iterdir()] == [LIST]:
            (folder / LIST).unlink()
        for parent in made:
            parent.rmdir()


def _refusal(path: Path, what: str, way: str = "") -> WriteError:
    here = Path.cwd()
    shown = path.relative_to(here) if path.is_relative_to(here) else path
    return WriteError("", f"{shown} {what}", f"Choose another output{way}.")


def _resolve(path: Path) -> Path:
    """Path without links or `..`, but for a link of its own name."""
    return Path(os.path.realpath(path.parent)) / path.name
