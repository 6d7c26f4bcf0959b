"""Whole files only: written beside their place, flushed to disk, then renamed into it."""

from __future__ import annotations

import os
import tempfile
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path

from gaitdisc.errors import WriteError
from gaitdisc.regular_file import refuse_nul

PART = ".part-"  # files begin with it until they are whole


@contextmanager
def whole_file(path: Path) -> Iterator[Path]:
    """Path to write to; it takes the place of `path` when the block ends well, and vanishes when it does not.

    returns: a file of the same ending in the same folder

    >>> import tempfile
    >>> folder = Path(tempfile.mkdtemp())
    >>> with whole_file(folder / "r2.csv") as part:
    ...     _ = part.write_text("r2")
    >>> [file.name for file in folder.iterdir()]
    ['r2.csv']
    """
    refuse_nul(path)
    try:
        path.parent.mkdir(parents=True, exist_ok=True)
        handle, name = tempfile.mkstemp(prefix=f"{PART}{path.stem}-", suffix=path.suffix, dir=path.parent)
        os.close(handle)
    except OSError as error:
        raise _refusal(path, error) from error
    part = Path(name)
    try:
        yield part
        with part.open("rb+") as file:
            os.fsync(file.fileno())
        part.chmod(_ordinary_mode())
        part.replace(path)
    except OSError as error:
        raise _refusal(path, error) from error
    finally:
        part.unlink(missing_ok=True)


def write_whole(path: Path | str, content: bytes | str) -> Path:
    """Write a file of known content, whole or not at all.

    content: everything that the file shall hold; text is written as UTF-8

    >>> import tempfile
    >>> write_whole(Path(tempfile.mkdtemp()) / "note.txt", "done").read_text()
    'done'
    """
    path = Path(path)
    with whole_file(path) as part:
        part.write_bytes(content.encode("utf-8") if isinstance(content, str) else content)
    return path


def sweep_parts(folder: Path) -> None:
    """Delete what a killed program left of files that it never finished.

    folder: folder in which, and below which, nobody else writes now

    >>> import tempfile
    >>> folder = Path(tempfile.mkdtemp())
    >>> (folder / ".part-r2-x.csv").touch()
    >>> sweep_parts(folder)
    >>> list(folder.iterdir())
    []
    """
    for part in folder.rglob(f"{PART}*"):
        part.unlink(missing_ok=True)


def _ordinary_mode() -> int:
    """Permissions of a file that any program would make; a temporary file's own are for its owner alone."""
    mask = os.umask(0)
    os.umask(mask)
    return 0o666 & ~mask


def _refusal(path: Path, error: OSError) -> WriteError:
    return WriteError(
        f"{path.name} is to be written whole into {path.parent}",
        f"the system says: {error.strerror or error}",
        "Make room or choose another folder; what stood there before is unchanged.",
    )
