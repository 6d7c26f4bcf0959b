"""Write whole files only: a reader never meets half of one, and what stood there before survives a failure."""

from __future__ import annotations

import contextlib
import os
import tempfile
from pathlib import Path

from gaitdisc.errors import WriteError


def write_whole(path: Path | str, content: bytes | str) -> Path:
    """Write a file by way of a temporary one beside it, which then takes its name.

    Parameters
    ----------
    path : Path or str
        File to write; its folder must be there.
    content : bytes or str
        Everything that the file shall hold; text is written as UTF-8.

    Returns
    -------
    Path
        The file.

    Raises
    ------
    WriteError
        If the folder is absent or read-only, or the disk is full; the old file is untouched then.

    Examples
    --------
    >>> import tempfile
    >>> with tempfile.TemporaryDirectory() as folder:
    ...     write_whole(Path(folder) / "note.txt", "done").read_text()
    'done'
    """
    path = Path(path)
    data = content.encode("utf-8") if isinstance(content, str) else content
    temporary = ""
    try:
        handle, temporary = tempfile.mkstemp(prefix=f".{path.name[:40]}.", suffix=".part", dir=path.parent)
        with os.fdopen(handle, "wb") as file:
            file.write(data)
            file.flush()
            os.fsync(file.fileno())
        Path(temporary).chmod(_ordinary_mode())
        Path(temporary).replace(path)
    except OSError as error:
        if temporary:
            with contextlib.suppress(OSError):
                Path(temporary).unlink()
        raise WriteError(
            f"{path.name} is to be written ({len(data)} bytes)",
            f"the system says: {error.strerror or error}",
            "Choose a folder that exists, can be written to and has space; nothing was changed.",
        ) from error
    return path


def _ordinary_mode() -> int:
    mask = os.umask(0)
    os.umask(mask)
    return 0o666 & ~mask
