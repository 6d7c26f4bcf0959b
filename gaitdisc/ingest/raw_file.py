"""A file as it lies on the disk: its name and its bytes."""

import hashlib
from dataclasses import dataclass
from pathlib import Path

from gaitdisc.channel import hint_nearest
from gaitdisc.errors import MissingFileError, ReadError
from gaitdisc.recording import Source
from gaitdisc.regular_file import LARGEST_TEXT_BYTES, check_regular, recall_sha256


@dataclass(frozen=True)
class RawFile:
    """Bytes of one file, read once."""

    name: str  # name without the folder; the folder may show who the person is and goes no further
    content: bytes
    sha256: str = ""  # of these bytes, where it is known; otherwise it is computed when it is needed

    def source(self, reader: str) -> Source:
        """Return where a recording comes from."""
        return Source(self.name, self.sha256 or hashlib.sha256(self.content).hexdigest(), reader)

    def lines(self) -> list[str]:
        """Return the lines of a text file, without their ends."""
        if b"\0" in self.content:
            raise ReadError(
                f"{self.name} must be a plain text file",
                f"it contains binary data (a zero byte at offset {self.content.index(0)})",
                "Export it again as plain text (UTF-8, not UTF-16), or correct the file name's ending.",
            )
        try:
            text = self.content.decode("utf-8-sig")
        except UnicodeDecodeError:
            text = self.content.decode("latin-1")  # old Windows exports; the numbers are plain ASCII either way
        return text.replace("\r\n", "\n").replace("\r", "\n").split("\n")


def read_raw(path: Path | str, largest_bytes: int = LARGEST_TEXT_BYTES) -> RawFile:
    """Read a file's bytes.

    >>> read_raw("walk.mot")
    Traceback (most recent call last):
    ...
    gaitdisc.errors.MissingFileError: walk.mot cannot be read; there is no such file. Check the name and the folder.
    """
    path = Path(path)
    needed = f"{path.name or path} cannot be read"
    try:
        if not path.is_dir():
            check_regular(path, largest_bytes)
        content = path.read_bytes()
    except FileNotFoundError as error:
        raise MissingFileError(
            needed, "there is no such file" + _near(path), "Check the name and the folder."
        ) from error
    except IsADirectoryError as error:
        raise ReadError(needed, "it is a folder", "Name a file inside it.") from error
    except ReadError:
        raise
    except (OSError, ValueError) as error:
        words = error.strerror if isinstance(error, OSError) else str(error)
        raise ReadError(needed, f"the operating system reports: {words}", "Check name and permissions.") from error
    if not content.strip():
        raise ReadError(needed, f"it is empty ({len(content)} bytes)", "Export or copy it again.")
    return RawFile(path.name, content, recall_sha256(path))


def _near(path: Path) -> str:
    try:
        names = [entry.name for entry in path.parent.iterdir()]
    except OSError:
        return ", and its folder does not exist"
    return hint_nearest(path.name, names)
