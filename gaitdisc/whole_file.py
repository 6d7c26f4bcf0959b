"""Whole files only: written beside their place, flushed to disk, then renamed into it."""

import os
from collections.abc import Iterator
from contextlib import contextmanager, suppress
from contextvars import ContextVar
from pathlib import Path
from uuid import uuid4

from gaitdisc.errors import WriteError
from gaitdisc.own_files import claim_file, record_output
from gaitdisc.regular_file import refuse_nul
from gaitdisc.write_lock import PART

_TOGETHER: ContextVar[list[tuple[Path, Path]] | None] = ContextVar("together", default=None)


@contextmanager
def whole_file(path: Path) -> Iterator[Path]:
    """Path beside it to write to; it takes the place of `path` when the block ends well, and vanishes when it does not.

    >>> import tempfile
    >>> folder = Path(tempfile.mkdtemp())
    >>> with whole_file(folder / "r2.csv") as part:
    ...     _ = part.write_text("r2")
    >>> [file.name for file in folder.iterdir()]
    ['r2.csv']
    """
    refuse_nul(path)
    claim_file(path)
    part = path.with_name(f"{PART}{path.stem}-{uuid4().hex[:8]}{path.suffix}")
    try:
        path.parent.mkdir(parents=True, exist_ok=True)
        os.close(os.open(part, os.O_CREAT | os.O_EXCL | os.O_WRONLY, 0o666))  # less what the system takes off
    except OSError as error:
        raise _refusal(path, error) from error
    with write_together() as files:
        try:
            yield part
            with part.open("rb+") as file:
                os.fsync(file.fileno())
            files.append((path, part))
        except OSError as error:
            raise _refusal(path, error) from error
        finally:
            if (path, part) not in files:
                part.unlink(missing_ok=True)


@contextmanager
def write_together() -> Iterator[list[tuple[Path, Path]]]:
    """Let the files of one result take their places when all of them are written, or none; the last written is last.

    returns: each file's place, and where it stands until then
    """
    files = _TOGETHER.get()
    if files is not None:
        yield files
        return
    files = []
    token = _TOGETHER.set(files)
    try:
        yield files
        for take_place in (record_output, lambda path, part: part.replace(path)):  # a list needs room, a place none
            for path, part in files:
                try:
                    take_place(path, part)
                except OSError as error:
                    raise _refusal(path, error) from error
        for folder in {path.parent for path, _ in files}:
            _flush(folder)
    finally:
        _TOGETHER.reset(token)
        for _, part in files:
            part.unlink(missing_ok=True)


def find_written(path: Path) -> Path:
    """Where a file stands that has not taken its place yet; its place where it has."""
    return next((part for place, part in reversed(_TOGETHER.get() or []) if place == path), path)


def write_whole(path: Path | str, content: bytes | str) -> Path:
    """Write a file of known content, text as UTF-8, whole or not at all.

    >>> import tempfile
    >>> write_whole(Path(tempfile.mkdtemp()) / "note.txt", "done").read_text()
    'done'
    """
    path = Path(path)
    with whole_file(path) as part:
        part.write_bytes(content.encode("utf-8") if isinstance(content, str) else content)
    return path


def remove_file(path: Path) -> None:
    """Delete a file, if it may be replaced."""
    claim_file(path)
    path.unlink(missing_ok=True)


def _flush(folder: Path) -> None:
    """Let a rename outlast a power cut, on systems that can open a folder."""
    with suppress(OSError):
        handle = os.open(folder, os.O_RDONLY)
        try:
            os.fsync(handle)
        finally:
            os.close(handle)


def _refusal(path: Path, error: OSError) -> WriteError:
    return WriteError(
        f"{path.name} cannot be written to {path.parent}",
        f"the operating system reports: {error.strerror or error}",
        "Free some space or choose another folder. The earlier file, if there was one, is unchanged.",
    )
