"""The hash of a file, computed once: a run needs it to know what is done, and again to say what a result rests on."""

from __future__ import annotations

import hashlib
import os
import time
from pathlib import Path

from gaitdisc.regular_file import check_regular

SETTLED_S = 2.0  # a file younger than this may be written again within the clock of its folder
_known: dict[tuple[int, ...], str] = {}


def file_sha256(path: Path) -> str:
    """SHA-256 of a file's bytes; a file that did not change since it was last hashed is not read again.

    Unchanged means: same file number, size, and times of writing and of change, to the nanosecond.

    >>> import tempfile
    >>> file = Path(tempfile.mkdtemp()) / "a"
    >>> _ = file.write_bytes(b"abc")
    >>> file_sha256(file)[:8]
    'ba7816bf'
    """
    known = known_sha256(path)
    if known:
        return known
    check_regular(path)
    with path.open("rb") as file:
        before = os.fstat(file.fileno())
        found = hashlib.file_digest(file, "sha256").hexdigest()
        if time.time() - before.st_mtime > SETTLED_S and _state(os.fstat(file.fileno())) == _state(before):
            _known[_state(before)] = found
    return found


def known_sha256(path: Path) -> str:
    """Hash of a file if it was computed and the file is as it was; empty otherwise."""
    try:
        return _known.get(_state(path.stat()), "")
    except OSError:
        return ""


def _state(found: os.stat_result) -> tuple[int, ...]:
    return (found.st_dev, found.st_ino, found.st_size, found.st_mtime_ns, found.st_ctime_ns)
