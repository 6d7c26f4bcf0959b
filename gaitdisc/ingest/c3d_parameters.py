"""The parameter section of a C3D file in pure Python: groups, numbers and texts, never beyond its bounds."""

from __future__ import annotations

import math
import re
from collections.abc import Iterator, Mapping
from dataclasses import dataclass
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from gaitdisc.errors import ReadError
from gaitdisc.ingest.c3d_header import BLOCK, C3DHeader, decoded

Value = tuple[str, ...] | NDArray[np.generic]
_DIMENSIONS_AT_MOST = 7
_WIDTHS = {-1: 1, 1: 1, 2: 2, 4: 4}


@dataclass(frozen=True)
class C3DParameters:
    """Parameters by group and name.

    >>> some = C3DParameters({("POINT", "USED"): np.array([-1]), ("POINT", "LABELS"): ("LASI",)})
    >>> some.count("POINT", "USED"), some.texts("POINT", "LABELS"), some.number("POINT", "RATE")
    (65535, ('LASI',), None)
    """

    # mapping of (str, str) to tuple of str or ndarray, texts without trailing blanks; numbers in the file's dimensions,
    # first index fastest in the file
    values: Mapping[tuple[str, str], Value]

    def texts(self, group: str, name: str) -> tuple[str, ...]:
        """Texts of a parameter, with those of `NAME2`, `NAME3`, ... that carry on where 255 are not enough."""
        found: list[str] = []
        for part in (name, *(f"{name}{number}" for number in range(2, 100))):
            value = self.values.get((group, part))
            if not isinstance(value, tuple):
                break
            found.extend(value)
        return tuple(found)

    def text(self, group: str, name: str) -> str:
        """First text of a parameter, empty where there is none."""
        texts = self.texts(group, name)
        return texts[0].strip() if texts else ""

    def numbers(self, group: str, name: str) -> NDArray[np.float64]:
        """Numbers of a parameter in the file's dimensions, empty where there is none."""
        value = self.values.get((group, name))
        if value is None or isinstance(value, tuple):
            return np.empty(0)
        with np.errstate(invalid="ignore"):  # damaged bytes may be a signalling NaN
            return np.asarray(value, float)

    def number(self, group: str, name: str) -> float | None:
        """First number of a parameter, None where there is none that is finite."""
        numbers = self.numbers(group, name).ravel()
        return float(numbers[0]) if numbers.size and np.isfinite(numbers[0]) else None

    def count(self, group: str, name: str) -> int | None:
        """First number read as a count: a negative 16-bit integer is one above 32767."""
        number = self.number(group, name)
        if number is None or abs(number) > 2**31:
            return None
        return round(number) + (2**16 if number < 0 else 0)

    def field(self, name: str) -> int | None:
        """Frame number of `TRIAL:ACTUAL_START_FIELD` or `ACTUAL_END_FIELD`, low and high word together."""
        words = self.numbers("TRIAL", name).ravel()
        if not words.size or not np.all(np.isfinite(words[:2])) or np.any(np.abs(words[:2]) > 2**31):
            return None
        return sum((round(word) & 0xFFFF) << (16 * place) for place, word in enumerate(words[:2].tolist()))


def read_c3d_parameters(path: str | Path, header: C3DHeader) -> C3DParameters:
    """Every parameter of a C3D file.

    Source: The C3D file format, c3d.org. An offset to the next parameter is read as unsigned, as long label lists need
        it.
    """
    start = (header.parameter_block - 1) * BLOCK
    with Path(path).open("rb") as file:
        file.seek(start)
        section = file.read(max(header.data_block - header.parameter_block, 1) * BLOCK)
    names: dict[int, str] = {}
    entries: list[tuple[int, str, Value]] = []
    for name, group, body in _entries(section, header):
        if group < 0:
            names[-group] = name
        else:
            entries.append((group, name, _value(name, body, header)))
    values = {(names.get(group, f"#{group}"), name): value for group, name, value in reversed(entries)}
    if not {group for group, _ in values} & {"POINT", "ANALOG"}:
        raise _broken(header, "it names neither the group POINT nor the group ANALOG")
    return C3DParameters(values)


def _entries(section: bytes, header: C3DHeader) -> Iterator[tuple[str, int, bytes]]:
    """Name, group number (negative: the group itself) and bytes after the offset of each entry."""
    at = 4
    while at + 2 <= len(section):
        length = abs(int.from_bytes(section[at : at + 1], "little", signed=True))
        group = int.from_bytes(section[at + 1 : at + 2], "little", signed=True)
        if length == 0 or group == 0:
            return
        offset_at = at + 2 + length
        if offset_at + 2 > len(section):
            raise _broken(header, f"an entry at byte {at} of it has a name of {length} letters that runs over its end")
        name = section[at + 2 : offset_at].decode("latin-1").strip().upper()
        order = "big" if header.processor == "MIPS" else "little"
        offset = int.from_bytes(section[offset_at : offset_at + 2], order)
        end = offset_at + offset if offset else len(section)
        if offset == 1 or end > len(section):
            raise _broken(header, f"the entry {_shown(name)} at byte {at} of it points {offset} bytes on, over its end")
        yield name, group, section[offset_at + 2 : end]
        if not offset:
            return
        at = end


def _value(name: str, body: bytes, header: C3DHeader) -> Value:
    width = _WIDTHS.get(int.from_bytes(body[:1], "little", signed=True))
    if len(body) < 2 or width is None or body[1] > _DIMENSIONS_AT_MOST or len(body) < 2 + body[1]:
        raise _broken(header, f"the parameter {_shown(name)} is of no known type")
    is_text = body[0] == 255
    dimensions = tuple(body[2 : 2 + body[1]])
    count = math.prod(dimensions)
    raw = body[2 + len(dimensions) :][: count * width]
    if len(raw) < count * width:
        raise _broken(
            header, f"the parameter {_shown(name)} has {len(raw)} bytes where {dimensions} need {count * width}"
        )
    if is_text:
        length = dimensions[0] if dimensions else 1
        return tuple(_text(raw[at : at + length]) for at in range(0, len(raw), length)) if length else ()
    return decoded(raw, width, header.processor).reshape(dimensions or (1,), order="F")


def _text(raw: bytes) -> str:
    try:
        text = raw.decode("utf-8")
    except UnicodeDecodeError:
        text = raw.decode("latin-1")
    return re.sub(r"[\x00-\x1f\x7f-\x9f]", " ", text).rstrip()


def _shown(name: str) -> str:
    return repr(name[:24])


def _broken(header: C3DHeader, found: str) -> ReadError:
    return ReadError(
        "a C3D file needs a parameter section that can be followed from entry to entry",
        f"{header.file}: {found}",
        "Export the trial again, or repair it in the software that wrote it.",
    )
