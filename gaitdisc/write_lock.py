"""One process at a time writes into a folder, or a file."""

import errno
import json
import os
import socket
from collections.abc import Iterator
from contextlib import ExitStack, contextmanager, suppress
from contextvars import ContextVar
from pathlib import Path
from typing import Any, NoReturn

from gaitdisc.errors import WriteError

PART = ".part-"  # files begin with it until they are whole
# How long a lock is tried [s]: a lock file that its last holder deletes under our hand is made anew at once.
PATIENCE_S = 0.2
_HELD: ContextVar[frozenset[Path]] = ContextVar("held", default=frozenset())


@contextmanager
def write_lock(folder: Path, name: str = ".lock", run: bool = False) -> Iterator[None]:
    """Hold a folder, or under another name a file in it, for this process; within itself it is held once.

    The system itself frees the lock of a process that ends, however it ends; that a number of a process is given to
    another afterwards, as in a container that is started again, does no harm. Between machines that share a disk such
    locks are not to be relied on: what another machine wrote into .lock is believed.

    run: whether files are cleared away that a killed run never finished, in and below the folder, and a disk without
        locks is refused; all else is written there without one

    >>> import tempfile
    >>> with write_lock(Path(tempfile.mkdtemp())):
    ...     pass
    """
    says = folder.resolve() / name  # who holds the folder; Windows lets nobody else read the locked file itself
    if says in _HELD.get():
        _sweep(folder, run)
        yield
        return
    locked = says.with_name(f"{name}-held")
    with ExitStack() as held:
        try:
            folder.mkdir(parents=True, exist_ok=True)
            lock = _take_lock(locked, says)
            held.callback(_free, locked, lock)
            if lock is None and run:
                raise OSError("this disk does not support file locks")
            holder = _holder(says)
            if holder.get("host", socket.gethostname()) != socket.gethostname():
                _refuse(says, f"Process {holder.get('pid')} on {holder['host']}")
            says.write_text(json.dumps({"pid": os.getpid(), "host": socket.gethostname()}))
            _sweep(folder, run)
        except OSError as error:
            raise WriteError(
                "the output folder must be writable and support file locks",
                f"for {folder}, the operating system reports: {error.strerror or error}",
                "Free some space, correct the permissions, or choose another folder with --out.",
            ) from error
        held.callback(says.unlink, missing_ok=True)
        held.callback(_sweep, folder, run)
        held.callback(_HELD.reset, _HELD.set(_HELD.get() | {says}))
        yield


def _free(locked: Path, lock: Any) -> None:
    with suppress(OSError):  # Windows keeps a file that is open
        locked.unlink()
    if lock is not None:
        lock.release()


def _sweep(folder: Path, run: bool) -> None:
    for part in folder.rglob(f"{PART}*") if run else ():
        part.unlink(missing_ok=True)


def _take_lock(path: Path, says: Path) -> Any:
    """Lock that the system keeps on the file; None where the disk has no locks."""
    from filelock import FileLock, Timeout

    lock = FileLock(path, fallback_to_soft=False)  # a mere file in place of the lock would outlive a killed run
    try:
        lock.acquire(timeout=PATIENCE_S, poll_interval=PATIENCE_S / 10)
    except Timeout:
        _refuse(says, f"Another process (pid {_holder(says).get('pid', 'unknown')})")
    except OSError as error:
        if error.errno != errno.ENOSYS:
            raise
        return None
    return lock


def _holder(path: Path) -> dict[str, Any]:
    """Who says to hold the folder; nothing where a process was killed before it could say."""
    try:
        holder = json.loads(path.read_text())
    except (OSError, ValueError, RecursionError):
        return {}
    return holder if isinstance(holder, dict) else {}


def _refuse(path: Path, holder: str) -> NoReturn:
    what = path.parent / path.name.removeprefix(".lock-") if path.name != ".lock" else f"{path.parent}/"
    raise WriteError(
        "",
        f"{holder} is writing to {what}",
        f"Wait for it or choose another --out. If that process has ended, delete {path.name}.",
    )
