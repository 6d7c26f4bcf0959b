"""One run at a time in a folder."""

from __future__ import annotations

import errno
import json
import os
import socket
from collections.abc import Iterator
from contextlib import contextmanager, suppress
from pathlib import Path
from typing import Any, NoReturn

from filelock import BaseFileLock, FileLock, SoftFileLock, Timeout

from gaitdisc.errors import WriteError
from gaitdisc.whole_file import sweep_parts

# How long a folder is tried [s]: a lock file that its last holder deletes under our hand is made anew at once.
PATIENCE_S = 0.2


@contextmanager
def run_lock(folder: Path) -> Iterator[None]:
    """Hold a run folder for this process, and clear away what a killed run left unfinished in it.

    The system itself frees the lock of a process that ends, however it ends; that a number of a process is given to
    another afterwards, as in a container that is started again, does no harm. Between machines that share a disk such
    locks are not to be relied on: what another machine wrote into .lock is believed.

    >>> import tempfile
    >>> with run_lock(Path(tempfile.mkdtemp())):
    ...     pass
    """
    says = folder / ".lock"  # who holds the folder; Windows lets nobody else read the locked file itself
    locked = folder / ".lock-held"
    try:
        folder.mkdir(parents=True, exist_ok=True)
        lock = _taken(locked, says)
    except OSError as error:
        raise _unwritable(folder, error) from error
    try:
        _refuse_other_machine(says)
        try:
            says.write_text(json.dumps({"pid": os.getpid(), "host": socket.gethostname()}))
            sweep_parts(folder)
        except OSError as error:
            raise _unwritable(folder, error) from error
        try:
            yield
        finally:
            says.unlink(missing_ok=True)
    finally:
        with suppress(OSError):  # Windows keeps a file that is open
            locked.unlink()
        lock.release()


def _taken(path: Path, says: Path) -> BaseFileLock:
    """Lock that the system keeps on the file, or the refusal that names who holds it."""
    lock = FileLock(path)
    try:
        lock.acquire(timeout=PATIENCE_S, poll_interval=PATIENCE_S / 10)
    except Timeout:
        _refuse(says, f"process {_holder(says).get('pid', 'unknown')} on this machine")
    except NotImplementedError as error:  # filelock before 3.24, where the disk has no locks
        raise OSError(errno.ENOSYS, os.strerror(errno.ENOSYS)) from error
    if isinstance(lock, SoftFileLock):  # a mere file in place of the lock would outlive a killed run
        lock.release()
        raise OSError(errno.ENOSYS, "this disk keeps no file locks")
    return lock


def _unwritable(folder: Path, error: OSError) -> WriteError:
    return WriteError(
        "a run needs a folder that it can write and lock",
        f"{folder}: the system says: {error.strerror or error}",
        "Make room, mend the right to write, or choose another folder with --out.",
    )


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


def _refuse(path: Path, holder: str) -> NoReturn:
    raise WriteError(
        "one run at a time may write into a folder",
        f"{path.parent} is held by {holder}",
        f"Wait for it, or choose another folder with --out; if that process is gone, delete {path.name}.",
    )
