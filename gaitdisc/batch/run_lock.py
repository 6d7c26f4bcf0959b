"""One run at a time in a folder."""

from __future__ import annotations

import json
import os
import socket
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path

from gaitdisc.errors import WriteError


@contextmanager
def run_lock(folder: Path) -> Iterator[None]:
    """Hold a run folder for this process; a lock that a killed run left behind is taken over.

    Parameters
    ----------
    folder : Path
        Folder of the run; made where it is missing.

    Raises
    ------
    WriteError
        If another living process works in the folder, or the folder cannot be written.

    Examples
    --------
    >>> import tempfile
    >>> with run_lock(Path(tempfile.mkdtemp())):
    ...     pass
    """
    path = folder / ".lock"
    try:
        folder.mkdir(parents=True, exist_ok=True)
        _take(path)
    except OSError as error:
        raise WriteError(
            "a run needs a folder that it can write",
            f"{folder}: the system says: {error.strerror or error}",
            "Choose another with --out.",
        ) from error
    try:
        yield
    finally:
        path.unlink(missing_ok=True)


def _take(path: Path) -> None:
    for _ in range(2):
        try:
            handle = os.open(path, os.O_CREAT | os.O_EXCL | os.O_WRONLY)
        except FileExistsError:
            _refuse_living_holder(path)
            path.unlink(missing_ok=True)
            continue
        with os.fdopen(handle, "w") as file:
            json.dump({"pid": os.getpid(), "host": socket.gethostname()}, file)
        return
    _refuse(path, "another run that started at the same moment")


def _refuse_living_holder(path: Path) -> None:
    try:
        holder = json.loads(path.read_text())
    except (OSError, ValueError):
        return  # killed while it took the lock
    here = holder.get("host") == socket.gethostname()
    if not here:
        _refuse(path, f"process {holder.get('pid')} on {holder.get('host')}")
    if _alive(int(holder.get("pid", -1))):
        _refuse(path, f"process {holder['pid']} on this machine")


def _alive(pid: int) -> bool:
    if pid == os.getpid():
        return True
    try:
        os.kill(pid, 0)
    except ProcessLookupError:
        return False
    except OSError:
        return True
    return True


def _refuse(path: Path, holder: str) -> None:
    raise WriteError(
        "one run at a time may write into a folder",
        f"{path.parent} is held by {holder}",
        f"Wait for it, or choose another folder with --out; if that process is gone, delete {path.name}.",
    )
