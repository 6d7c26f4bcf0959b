"""C3D files broken in a thousand ways: what a test and benchmarks/hostile.py give to the reader."""

from __future__ import annotations

from collections.abc import Iterator
from typing import NamedTuple

import numpy as np

BLOCK = 512  # bytes
EXTREMES = (0, 1, 127, 128, 255)


class Counts(NamedTuple):
    """How many of each kind, beside truncations at every border of a part."""

    truncated: int = 80
    header: int = 24 * len(EXTREMES)
    parameters: int = 250


def damaged(content: bytes, rng: np.random.Generator, counts: Counts | None = None) -> Iterator[tuple[str, bytes]]:
    """Kind and bytes of a file cut short, with one byte of its header changed, or one to four of its parameters."""
    counts = counts or Counts()
    data = min((content[16] + 256 * content[17] - 1) * BLOCK, len(content))
    borders = {size for size in (0, 1, 100, BLOCK, BLOCK + 1, data - 1, data, data + 1) if 0 <= size < len(content)}
    cut = rng.integers(2, max(len(content) - 400, 3), counts.truncated).tolist()
    for size in sorted({*borders, *cut}):
        yield "truncated", content[:size]
    every = [(place, value) for place in range(24) for value in EXTREMES]
    for k in rng.choice(len(every), min(counts.header, len(every)), replace=False):
        place, value = every[k]
        yield "header", content[:place] + bytes([value]) + content[place + 1 :]
    for _ in range(counts.parameters):
        broken = bytearray(content)
        for place in rng.integers(BLOCK, max(data, BLOCK + 1), rng.integers(1, 5)):
            broken[place] = rng.choice([*EXTREMES, *rng.integers(0, 256, 3)])
        yield "parameters", bytes(broken)
