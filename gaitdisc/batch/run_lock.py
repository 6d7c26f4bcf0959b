"""One run at a time in a folder."""

from __future__ import annotations

import json
import os
import socket
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import Any

from gaitdisc.errors import WriteError
from gaitdisc.whole_file import sweep_parts


@contextmanager
def run_lock(folder: Path) -> Iterator[None]:
    """Hold a run folder for this process, and clear away what a killed run left unfinished in it.

    The system itself frees the lock of a process that ends, however it ends; that a number of a process is given to
    another afterwards, as in a container that is started again, does no harm. Between machines that share a disk such
    locks are not to be relied on: a lock file of another machine is believed. POSIX only: Windows has no such lock.

    >>> import tempfile
    >>> with run_lock(Path(tempfile.mkdtemp())):
    ...     pass
    """
    path = folder / ".lock"
    try:
        folder.mkdir(parents=True, exist_ok=True)
        handle = _taken(path)
        sweep_parts(folder)
    except OSError as error:
        raise WriteError(
            "a run needs a folder that it can write",
            f"{folder}: the system says: {error.strerror or error}",
            "Make room, mend the right to write, or choose another folder with --out.",
        ) from error
    try:
        yield
    finally:
        path.unlink(missing_ok=True)
        os.close(handle)


def _taken(path: Path) -> int:
    """Open and locked lock file, which says who holds it."""
    try:
        import fcntl
    except ImportError:
        raise WriteError(
            "a run needs the file locks of a POSIX system, which go when their process goes",
            f"this system is {os.name!r}",
            "Use Linux, macOS or the Windows Subsystem for Linux; check, compare, discover and export take no lock.",
        ) from None
    while True:
        handle = os.open(path, os.O_CREAT | os.O_RDWR)
        try:
            fcntl.flock(handle, fcntl.LOCK_EX | fcntl.LOCK_NB)
            if path.is_file() and path.stat().st_ino == os.fstat(handle).st_ino:
                _refuse_other_machine(path)
                os.truncate(handle, 0)
                os.write(handle, json.dumps({"pid": os.getpid(), "host": socket.gethostname()}).encode())
                return handle
        except BlockingIOError:
            os.close(handle)
            _refuse(path, f"process {_holder(path).get('pid', 'unknown')} on this machine")
        except BaseException:
            os.close(handle)
            raise
        os.close(handle)  # its last holder deleted it between our opening and our locking


def _refuse_other_machine(path: Path) -> None:
    holder = _holder(path)
    if holder.get("host", socket.gethostname()) != socket.gethostname():
        _refuse(path, f"process {holder.get('pid')} on {holder['host']}")


def _holder(path: Path) -> dict[str, Any]:
    """Who says to hold the folder; nothing where a process was killed before it could say."""
    try:
        holder = json.loads(path.read_text())
    except (OSError, ValueError, RecursionError):
        return {}
    return holder if isinstance(holder, dict) else {}


def _refuse(path: Path, holder: str) -> None:
    raise WriteError(
        "one run at a time may write into a folder",
        f"{path.parent} is held by {holder}",
        f"Wait for it, or choose another folder with --out; if that process is gone, delete {path.name}.",
    )
