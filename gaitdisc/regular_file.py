"""Only regular files of a bounded size are opened: a pipe waits for ever, a device never ends. Their hash is kept."""

import hashlib
import os
import stat
import time
from pathlib import Path

from gaitdisc.errors import ReadError
from gaitdisc.own_files import note_inputs

GIBIBYTE = 2**30
LARGEST_BYTES = 4 * GIBIBYTE  # a binary recording: twenty hours of 50 markers and 40 analog channels
LARGEST_TEXT_BYTES = GIBIBYTE  # a text takes about ten times its size of memory while it is parsed
SETTLED_S = 2.0  # a file younger than this may be written again within the clock of its folder
_KINDS = (
    (stat.S_ISDIR, "a folder"),
    (stat.S_ISFIFO, "a named pipe"),
    (stat.S_ISSOCK, "a socket"),
    (stat.S_ISCHR, "a device"),
    (stat.S_ISBLK, "a device"),
)
_known: dict[tuple[int, ...], str] = {}


def check_regular(path: Path, largest_bytes: int = LARGEST_BYTES) -> int:
    """Size [bytes] of a file that may be opened: a regular one, or a link to one, that is not too large.

    >>> check_regular(Path("/"))
    Traceback (most recent call last):
    ...
    gaitdisc.errors.ReadError: the input must be a file; / is a folder. Give the path of a file.
    """
    refuse_nul(path)
    status = path.stat()
    name = path.name or str(path)
    if not stat.S_ISREG(status.st_mode):
        kind = next((word for is_one, word in _KINDS if is_one(status.st_mode)), "not a regular file")
        raise ReadError("the input must be a file", f"{name} is {kind}", "Give the path of a file.")
    if status.st_size > largest_bytes:
        raise ReadError(
            f"a file may have at most {size_in_words(largest_bytes)}",
            f"{name} has {size_in_words(status.st_size)}",
            "Export the recording in parts, or export only the channels that you need.",
        )
    note_inputs([path])
    return status.st_size


def refuse_nul(path: Path) -> None:
    """Refuse a name that no system can have."""
    if "\0" in str(path):
        raise ReadError("a file name must not contain a NUL character", f"found {path.name!r}", "Correct the name.")


def size_in_words(count: int) -> str:
    """Bytes as GiB or MiB."""
    return f"{count / GIBIBYTE:.3g} GiB" if count >= GIBIBYTE else f"{count / 2**20:.3g} MiB"


def file_sha256(path: Path) -> str:
    """SHA-256 of a file's bytes; a file that did not change since it was last hashed is not read again.

    Unchanged means: same file number, size, and times of writing and of change, to the nanosecond.
    """
    if known := recall_sha256(path):
        return known
    check_regular(path)
    with path.open("rb") as file:
        before = os.fstat(file.fileno())
        digest = hashlib.file_digest(file, "sha256").hexdigest()
        if time.time() - before.st_mtime > SETTLED_S and _state(os.fstat(file.fileno())) == _state(before):
            _known[_state(before)] = digest
    return digest


def recall_sha256(path: Path) -> str:
    """Hash of a file if it was computed and the file is as it was; empty otherwise."""
    try:
        return _known.get(_state(path.stat()), "")
    except OSError:
        return ""


def _state(status: os.stat_result) -> tuple[int, ...]:
    return (status.st_dev, status.st_ino, status.st_size, status.st_mtime_ns, status.st_ctime_ns)
