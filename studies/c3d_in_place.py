"""A C3D file opened as its bytes, so that a planted fault changes the samples that it names and nothing else.

Only what the recordings at hand have: Intel byte order, samples as 32-bit floats. `ezc3d` writes a whole new file.
"""

from __future__ import annotations

import re
import struct
from collections.abc import Iterator, Sequence
from contextlib import contextmanager
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

BLOCK, INTEL = 512, 84
KINDS = {1: np.dtype("i1"), 2: np.dtype("<i2"), 4: np.dtype("<f4")}


class InPlace:
    """Header, parameters and samples of a file as views of its bytes.

    points: (frame, point, 4) in the file's units; the fourth is the residual, below 0 where a point was not seen
    analog: (frame, sample, channel) as stored, before offset and scale
    """

    def __init__(self, path: Path) -> None:
        self.path, self.raw = path, bytearray(path.read_bytes())
        parameters = BLOCK * (self.raw[0] - 1)
        if self.raw[parameters + 3] != INTEL or self.header("<f", 7) > 0:
            raise ValueError(f"{path}: not Intel floats")
        self.places = self._records(parameters + 4)
        self._view()

    def header(self, form: str, word: int) -> float:
        """Word of the header, from 1."""
        return struct.unpack_from(form, self.raw, 2 * (word - 1))[0]

    def _view(self) -> None:
        count, channels = int(self.header("<H", 2)), int(self.header("<H", 3))
        frames = int(self.header("<H", 5) - self.header("<H", 4)) + 1
        start = BLOCK * (int(self.header("<H", 9)) - 1)
        width = 4 * count + channels
        samples = np.frombuffer(self.raw, "<f4", frames * width, start).reshape(frames, width)
        per_frame = int(self.header("<H", 10)) or 1
        self.points = samples[:, : 4 * count].reshape(frames, count, 4)
        self.analog = samples[:, 4 * count :].reshape(frames, per_frame, -1)
        self.points_rate = self.header("<f", 11)

    def _records(self, at: int) -> dict[str, tuple[int, tuple[int, ...], int]]:
        groups: dict[int, str] = {}
        found: list[tuple[int, str, tuple[int, tuple[int, ...], int]]] = []
        while length := abs(struct.unpack_from("b", self.raw, at)[0]):
            number = struct.unpack_from("b", self.raw, at + 1)[0]
            name = self.raw[at + 2 : at + 2 + length].decode("latin-1").upper()
            after = at + 2 + length
            if number < 0:
                groups[-number] = name
            else:
                kind, dimensions = struct.unpack_from("bB", self.raw, after + 2)
                shape = tuple(self.raw[after + 4 : after + 4 + dimensions])
                found.append((number, name, (kind, shape, after + 4 + dimensions)))
            step = struct.unpack_from("<H", self.raw, after)[0]
            if not step:
                break
            at = after + step
        return {f"{groups[number]}:{name}": place for number, name, place in found}

    def numbers(self, name: str) -> NDArray[Any]:
        """Numbers of a parameter, such as `EVENT:TIMES`, to be read or written in place; empty without it."""
        if name not in self.places:
            return np.empty(0, np.float32)
        kind, shape, at = self.places[name]
        flat = np.frombuffer(self.raw, KINDS[kind], int(np.prod(shape, dtype=int)), at)
        return flat.reshape(shape, order="F")

    def words(self, name: str) -> list[str]:
        """Text of a parameter and of those that continue it, such as `POINT:LABELS`, `POINT:LABELS2`."""
        own = sorted((key for key in self.places if re.fullmatch(rf"{name}\d*", key)), key=lambda key: (len(key), key))
        listed = []
        for key in own:
            _, shape, at = self.places[key]
            width, count = (*shape, 1)[:2]
            cells = [self.raw[at + width * k : at + width * (k + 1)].decode("latin-1") for k in range(count)]
            listed += [cell.strip() for cell in cells]
        return listed

    @property
    def labels(self) -> list[str]:
        """Labels of the points, without the subject before them."""
        return [label.rsplit(":", 1)[-1] for label in self.words("POINT:LABELS")]

    def point(self, label: str) -> int:
        """Column of a point, by its whole label or, for a model's output, with the suffix of a laboratory."""
        for pattern in (label, rf"{label}_\w"):
            for column, own in enumerate(self.labels):
                if re.fullmatch(pattern, own) and not np.all(self.points[:, column, 3] < 0):
                    return column
        raise LookupError(f"no point {label}")

    def plate_channels(self) -> list[NDArray[np.intp]]:
        """Analog columns of each plate, which the file counts from 1."""
        listed = self.numbers("FORCE_PLATFORM:CHANNEL")
        return [np.array(column[column > 0], np.intp) - 1 for column in listed.T] if listed.size else []

    def newtons(self, columns: Sequence[int] | NDArray[np.intp]) -> NDArray[np.float64]:
        """Analog channels in their units, (sample, channel)."""
        stored = self.analog.reshape(-1, self.analog.shape[2])[:, columns].astype(float)
        scale = self.numbers("ANALOG:SCALE").astype(float)[columns] * float(self.numbers("ANALOG:GEN_SCALE").flat[0])
        return (stored - self.numbers("ANALOG:OFFSET").astype(float)[columns]) * scale

    def loads(self) -> list[float]:
        """Largest change of the vertical force of each plate [N, or as its channel is scaled]."""
        if not self.analog.size:
            return []
        return [float(np.ptp(self.newtons(channels[2:3]))) for channels in self.plate_channels()]

    def resampled(self, frames: NDArray[np.float64], analog: NDArray[np.intp]) -> None:
        """Give the file other frames, each between two of those it has; of analog samples whole frames are taken."""
        low = np.clip(np.floor(frames).astype(int), 0, len(self.points) - 2)
        share = (frames - low)[:, None, None]
        points = (1 - share) * self.points[low] + share * self.points[low + 1]
        points[..., 3] = self.points[np.rint(frames).astype(int), :, 3]
        points[points[..., 3] < 0] = (0.0, 0.0, 0.0, -1.0)
        rows = np.hstack([points.reshape(len(points), -1), self.analog[analog].reshape(len(points), -1)])
        start = BLOCK * (int(self.header("<H", 9)) - 1)
        last = int(self.header("<H", 4)) + len(frames) - 1
        samples = rows.astype("<f4").tobytes()
        self.raw = bytearray(bytes(self.raw[:start]) + samples + bytes(-len(samples) % BLOCK))
        struct.pack_into("<H", self.raw, 8, last)
        for name, parts in (("POINT:FRAMES", [len(frames)]), ("TRIAL:ACTUAL_END_FIELD", [last & 0xFFFF, last >> 16])):
            place = self.numbers(name)
            if place.size:
                place.flat[: len(parts)] = parts
        self._view()


@contextmanager
def edited(path: Path) -> Iterator[InPlace]:
    """Open a file, and write it when the block ends."""
    file = InPlace(path)
    yield file
    path.write_bytes(file.raw)
