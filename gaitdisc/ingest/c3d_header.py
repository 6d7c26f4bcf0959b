"""The first blocks of a C3D file in pure Python: is it one, in which byte order, and what does it say it holds."""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from gaitdisc.errors import ReadError
from gaitdisc.regular_file import check_regular

BLOCK = 512  # bytes; a C3D file counts in blocks from 1
PROCESSORS = {84: "Intel", 85: "DEC", 86: "MIPS"}
_MAGIC = (
    (b"PK\x03\x04", "a ZIP archive", "Unpack it and give the .c3d file inside."),
    (b"\x89PNG", "a PNG picture", "Give the .c3d file."),
    (b"%PDF", "a PDF document", "Give the .c3d file."),
    (b"\x1f\x8b", "a gzip archive", "Unpack it and give the .c3d file inside."),
    (b"version https://git-lfs", "a Git LFS pointer, not the file itself", "Fetch it with `git lfs pull`."),
)


@dataclass(frozen=True)
class C3DHeader:
    """What the header block of a C3D file says.

    >>> C3DHeader("walk.c3d", 2048, "Intel", 2, 4, 3, 0, 0, 1, 100, -1.0, 100.0).frames
    100
    """

    file: str  # name of the file without its folder
    size: int  # length of the file [bytes]
    processor: str  # `Intel`, `DEC` or `MIPS`: the order of bytes and the kind of float
    parameter_block: int  # where the parameter section and the data begin [blocks of 512 bytes, from 1]
    data_block: int  # where the parameter section and the data begin [blocks of 512 bytes, from 1]
    points: int
    analog_values: int  # analog values in a frame: channels times samples a frame
    samples_per_frame: int  # analog samples of one channel in a frame
    first_frame: int
    last_frame: int
    scale: float  # factor of integer points; negative where points are stored as floats
    rate_hz: float

    @property
    def frames(self) -> int:
        """Frames from the first to the last, 0 where they are not in order."""
        return max(self.last_frame - self.first_frame + 1, 0)


def read_c3d_header(path: str | Path) -> C3DHeader:
    """Header of a C3D file, or a refusal that says what the file is instead.

    Source: The C3D file format, c3d.org: header words 1 to 12 and the processor byte of the parameter section.
    """
    path = Path(path)
    head, size = _first_bytes(path)
    for magic, kind, remedy in _MAGIC:
        if head.startswith(magic):
            raise ReadError("a C3D file is needed", f"{path.name} is {kind}", remedy)
    parameter_block = head[0]
    start = (parameter_block - 1) * BLOCK
    if head[1] != 0x50 or parameter_block < 2 or start + 4 > len(head):
        text = all(byte in b"\t\n\r" or byte > 31 for byte in head[:64])
        raise ReadError(
            "a C3D file is needed (its second byte is 80)",
            f"{path.name} begins with bytes {head[0]} and {head[1]}{', it looks like text' if text else ''}",
            "Give the .c3d file that the motion capture system exported.",
        )
    processor = PROCESSORS.get(head[start + 3])
    if processor is None:
        raise ReadError(
            "a C3D file needs processor type 84 (Intel), 85 (DEC) or 86 (MIPS)",
            f"{path.name} has {head[start + 3]}",
            "Export the trial again; this copy is damaged.",
        )
    words = decoded(head[:24], 2, processor).astype(int) & 0xFFFF
    scale, rate_hz = (float(decoded(head[at : at + 4], 4, processor)[0]) for at in (12, 20))
    return C3DHeader(
        file=path.name,
        size=size,
        processor=processor,
        parameter_block=parameter_block,
        data_block=int(words[8]),
        points=int(words[1]),
        analog_values=int(words[2]),
        samples_per_frame=int(words[9]),
        first_frame=int(words[3]),
        last_frame=int(words[4]),
        scale=scale,
        rate_hz=rate_hz,
    )


def decoded(raw: bytes, width: int, processor: str) -> NDArray[np.generic]:
    """Numbers that bytes of a C3D file stand for.

    width: 1 for bytes, 2 for 16-bit integers, 4 for floats

    >>> decoded(bytes([0x00, 0x00, 0x80, 0x3F]), 4, "Intel"), decoded(bytes([0x80, 0x40, 0, 0]), 4, "DEC")
    (array([1.], dtype=float32), array([1.], dtype=float32))
    """
    if width == 1:
        return np.frombuffer(raw, np.uint8)
    end = ">" if processor == "MIPS" else "<"
    if width == 2:
        return np.frombuffer(raw, f"{end}i2")
    if processor != "DEC":
        return np.frombuffer(raw, f"{end}f4")
    # A VAX F float is an IEEE one with its two halves exchanged and an exponent that is larger by two.
    halves = np.frombuffer(raw, "<u2").astype(np.uint32)
    with np.errstate(all="ignore"):
        return ((halves[0::2] << 16) | halves[1::2]).view(np.float32) / np.float32(4)


def _first_bytes(path: Path) -> tuple[bytes, int]:
    """Up to 256 blocks, enough to reach the parameter section wherever the header may place it."""
    if path.is_dir():
        raise ReadError("a C3D file is needed", f"{path.name} is a folder", "Give one of the files in it.")
    try:
        size = check_regular(path)
        with path.open("rb") as file:
            head = file.read(256 * BLOCK)
    except FileNotFoundError:
        raise ReadError("a C3D file is needed", f"{path.name} is not there", "Check the path.") from None
    except OSError as error:
        raise ReadError(
            "a C3D file is needed", f"{path.name} cannot be opened ({error.strerror})", "Check its permissions."
        ) from None
    if not head:
        raise ReadError("a C3D file is needed", f"{path.name} is empty (0 bytes)", "Copy or export it again.")
    if len(head) < BLOCK:
        raise ReadError(
            "a C3D file is needed (its header alone has 512 bytes)",
            f"{path.name} has {len(head)} bytes",
            "Copy or export it again.",
        )
    return head, size
