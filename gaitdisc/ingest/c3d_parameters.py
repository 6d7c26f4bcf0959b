"""Header and parameter section of a C3D file in pure Python: is it one, what does it hold, and of whose body."""

import math
import re
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from gaitdisc.errors import MissingFileError, ReadError
from gaitdisc.recording.arrays import Values
from gaitdisc.recording.trial import LENGTHS_M, MASS_KG, BodyMeasures
from gaitdisc.regular_file import check_regular

BLOCK = 512  # bytes; a C3D file counts in blocks from 1
PROCESSORS = {84: "Intel", 85: "DEC", 86: "MIPS"}
_MAGIC = (
    (b"PK\x03\x04", "a ZIP archive", "Unpack it and use the .c3d file inside."),
    (b"\x89PNG", "a PNG picture", "Use the .c3d file."),
    (b"%PDF", "a PDF document", "Use the .c3d file."),
    (b"\x1f\x8b", "a gzip archive", "Unpack it and use the .c3d file inside."),
    (b"version https://git-lfs", "a Git LFS pointer, not the file itself", "Fetch it with `git lfs pull`."),
)
Value = tuple[str, ...] | NDArray[np.generic]
_DIMENSIONS_AT_MOST = 7
_WIDTHS = {-1: 1, 1: 1, 2: 2, 4: 4}
BODY_GROUPS = ("PROCESSING", "SUBJECTS", "SUBJECT")
OF_THE_BODY = {
    "height_m": ("HEIGHT", "BODYHEIGHT"),
    "inter_asis_m": ("INTERASISDISTANCE", "ASISDISTANCE"),
    "marker_diameter_m": ("MARKERDIAMETER",),
}
OF_A_SIDE = {"leg_length_m": ("LEGLENGTH",), "knee_width_m": ("KNEEWIDTH",), "ankle_width_m": ("ANKLEWIDTH",)}
FACTORS = (1e-3, 1.0, 1e-2)  # mm, as Nexus writes; m; cm: the first that makes it a length of a person


@dataclass(frozen=True)
class C3DHeader:
    """What the header block of a C3D file says."""

    file: str  # name of the file without its folder
    size: int  # length of the file [bytes]
    processor: str  # `Intel`, `DEC` or `MIPS`: the order of bytes and the kind of float
    parameter_block: int  # where the parameter section begins [blocks of 512 bytes, from 1]
    data_block: int  # where the data begin [blocks, from 1]
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
            raise ReadError("the file must be in C3D format", f"{path.name} is {kind}", remedy)
    parameter_block = head[0]
    start = (parameter_block - 1) * BLOCK
    if head[1] != 0x50 or parameter_block < 2 or start + 4 > len(head):
        text = all(byte in b"\t\n\r" or byte > 31 for byte in head[:64])
        raise ReadError(
            "the second byte of a C3D file must be 80",
            f"{path.name} begins with bytes {head[0]} and {head[1]}{' and looks like text' if text else ''}",
            "Use the .c3d file that the motion capture system exported.",
        )
    processor = PROCESSORS.get(head[start + 3])
    if processor is None:
        raise ReadError(
            "a C3D file must have processor type 84 (Intel), 85 (DEC) or 86 (MIPS)",
            f"{path.name} has type {head[start + 3]}",
            "Export the trial again. This copy is damaged.",
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
    """Numbers that bytes of a C3D file stand for: width 1 for bytes, 2 for 16-bit integers, 4 for floats.

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
        raise ReadError("the path must lead to a C3D file", f"{path.name} is a folder", "Name one of the files in it.")
    try:
        size = check_regular(path)
        with path.open("rb") as file:
            head = file.read(256 * BLOCK)
    except FileNotFoundError:
        needed, fault = "the path must lead to a C3D file", f"{path.name} does not exist"
        raise MissingFileError(needed, fault, "Check the path.") from None
    except OSError as error:
        raise ReadError(
            "the path must lead to a C3D file",
            f"{path.name} cannot be opened ({error.strerror})",
            "Check its permissions.",
        ) from None
    if not head:
        raise ReadError("a C3D file must not be empty", f"{path.name} has 0 bytes", "Copy or export it again.")
    if len(head) < BLOCK:
        raise ReadError(
            "a C3D file must have at least 512 bytes, the length of its header",
            f"{path.name} has {len(head)} bytes",
            "Copy or export it again.",
        )
    return head, size


@dataclass(frozen=True)
class C3DParameters:
    """Parameters of a file by group and name.

    >>> C3DParameters({("POINT", "USED"): np.array([-1])}).count("POINT", "USED")
    65535
    """

    # mapping of (str, str) to tuple of str or ndarray, texts without trailing blanks; numbers in the file's dimensions,
    # first index fastest in the file
    values: Mapping[tuple[str, str], Value]
    file: str = ""  # name of the file without its folder

    def texts(self, group: str, name: str) -> tuple[str, ...]:
        """Texts of a parameter, with those of `NAME2`, `NAME3`, ... that carry on where 255 are not enough."""
        texts: list[str] = []
        for number in ("", *range(2, 100)):
            value = self.values.get((group, f"{name}{number}"))
            if not isinstance(value, tuple):
                break
            texts.extend(value)
        return tuple(texts)

    def text(self, group: str, name: str) -> str:
        """First text of a parameter, empty where there is none."""
        texts = self.texts(group, name)
        return texts[0].strip() if texts else ""

    def numbers(self, group: str, name: str) -> Values:
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
        raise _broken(header, "the groups POINT and ANALOG are missing")
    return C3DParameters(values, header.file)


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
            raise _broken(header, f"the name of an entry at byte {at} has {length} letters, too many for the section")
        name = section[at + 2 : offset_at].decode("latin-1").strip().upper()
        order = "big" if header.processor == "MIPS" else "little"
        offset = int.from_bytes(section[offset_at : offset_at + 2], order)
        end = offset_at + offset if offset else len(section)
        if offset == 1 or end > len(section):
            raise _broken(header, f"the entry {name[:24]!r} at byte {at} points {offset} bytes ahead, past the end")
        yield name, group, section[offset_at + 2 : end]
        if not offset:
            return
        at = end


def _value(name: str, body: bytes, header: C3DHeader) -> Value:
    width = _WIDTHS.get(int.from_bytes(body[:1], "little", signed=True))
    if len(body) < 2 or width is None or body[1] > _DIMENSIONS_AT_MOST or len(body) < 2 + body[1]:
        raise _broken(header, f"the parameter {name[:24]!r} has an unknown type")
    is_text = body[0] == 255
    dimensions = tuple(body[2 : 2 + body[1]])
    count = math.prod(dimensions)
    raw = body[2 + len(dimensions) :][: count * width]
    if len(raw) < count * width:
        raise _broken(header, f"{name[:24]!r} has {len(raw)} bytes; its dimensions {dimensions} need {count * width}")
    if is_text:
        length, texts = dimensions[0] if dimensions else 1, []
        for cell in (raw[at : at + length] for at in range(0, len(raw), length or 1)):
            try:
                text = cell.decode("utf-8")
            except UnicodeDecodeError:
                text = cell.decode("latin-1")
            texts.append(re.sub(r"[\x00-\x1f\x7f-\x9f]", " ", text).rstrip())
        return tuple(texts)
    return decoded(raw, width, header.processor).reshape(dimensions or (1,), order="F")


def _broken(header: C3DHeader, fault: str) -> ReadError:
    return ReadError(
        "the parameter section of a C3D file must be complete and consistent",
        f"{header.file}: {fault}",
        "Export the trial again, or repair it in the software that wrote it.",
    )


def body_mass(parameters: C3DParameters) -> float | None:
    """Body mass that the file states [kg], or None."""
    for group, name in (("PROCESSING", "BODYMASS"), ("SUBJECTS", "BODYMASS"), ("SUBJECT", "WEIGHT")):
        mass = parameters.number(group, name)
        if mass is not None and MASS_KG.hold(mass):
            return mass
    return None


def read_body_measures(path: Path | str) -> BodyMeasures:
    """Measures of the person in a file; none in another than a C3D, or where absent, zero, or not in mm, m or cm."""
    if Path(path).suffix.lower() != ".c3d":
        return BodyMeasures()
    return find_body_measures(read_c3d_parameters(path, read_c3d_header(path)))


def find_body_measures(parameters: C3DParameters) -> BodyMeasures:
    """Measures in PROCESSING, SUBJECTS or SUBJECT."""
    unsided = {name: _length(parameters, name, keys) for name, keys in OF_THE_BODY.items()}
    sided = {}
    for name, keys in OF_A_SIDE.items():
        lengths = {side: _length(parameters, name, [f"{side.upper()}{key}" for key in keys]) for side in "lr"}
        sided[name] = {side: length for side, length in lengths.items() if length is not None}
    return BodyMeasures(body_mass(parameters), **unsided, **sided)


def _length(parameters: C3DParameters, name: str, keys: Sequence[str]) -> float | None:
    for group in BODY_GROUPS:
        for key in keys:
            number = parameters.number(group, key)
            for factor in FACTORS:
                if number is not None and LENGTHS_M[name].hold(number * factor):
                    return round(number * factor, 9)
    return None
