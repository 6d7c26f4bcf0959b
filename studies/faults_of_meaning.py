"""Faults of meaning, planted into copies of real files: what stands in them is turned, no byte of their form is."""

from __future__ import annotations

import re
from collections.abc import Callable, Mapping, Sequence
from pathlib import Path
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

Rows = NDArray[np.float64]
Turn = Callable[[list[str], Rows], None]
Plant = Callable[[Path], None]


class Case(NamedTuple):
    """One fault in one walk: its files by the name they get, what is done to the copies, what must be said."""

    fault: str
    name: str
    files: Mapping[str, Path]
    plant: Plant
    words: str
    crop_s: tuple[float, float] | None = None


def in_storage(file: str, turn: Turn, header: tuple[str, str] = ("", "")) -> Plant:
    """Turn the numbers or labels of a .mot or .sto, or a word of its header."""

    def plant(folder: Path) -> None:
        text = (folder / file).read_text()
        head, _, body = text.partition("endheader\n") if "endheader\n" in text else text.partition("endheader\t")
        lines = [line for line in body.splitlines() if line.strip()]
        labels = [label.strip() for label in lines[0].split("\t") if label.strip()]
        rows = np.array([[float(cell) for cell in line.split()] for line in lines[1:]])
        turn(labels, rows)
        said = ["\t".join(labels), *("\t".join(map(repr, row)) for row in rows.tolist() if np.isfinite(row[0]))]
        head = re.sub(r"(?i)nrows=\d+", f"nRows={len(said) - 1}", re.sub(r"\t+\n", "\n", head))
        (folder / file).write_text(head.replace(*header) + "endheader\n" + "\n".join(said) + "\n")

    return plant


def in_trc(file: str, factor: float, unit: str) -> Plant:
    """Write the markers of a .trc in another unit than its header states, or state another."""

    def plant(folder: Path) -> None:
        lines = (folder / file).read_text().splitlines()
        lines[2] = re.sub(r"\b(mm|m)\b", unit, lines[2])
        start = next(i for i, line in enumerate(lines) if re.match(r"\s*1\s+[\d.]+\s", line) and i > 3)
        for i in range(start, len(lines)):
            cells = lines[i].split("\t")
            cells[2:] = [repr(float(cell) * factor) if cell.strip() else cell for cell in cells[2:]]
            lines[i] = "\t".join(cells)
        (folder / file).write_text("\n".join(lines) + "\n")

    return plant


def scaled(pattern: str, factor: float) -> Turn:
    """Multiply the columns whose labels match."""

    def turn(labels: list[str], rows: Rows) -> None:
        rows[:, [i for i, label in enumerate(labels) if re.search(pattern, label)]] *= factor

    return turn


def renamed(change: Callable[[str], str]) -> Turn:
    """Change the labels, and leave the numbers."""

    def turn(labels: list[str], _: Rows) -> None:
        labels[:] = map(change, labels)

    return turn


def mirrored(pattern: str) -> Turn:
    """Exchange r and l where the pattern has them as its group."""
    return renamed(lambda label: re.sub(pattern, lambda found: "l" if found[0] == "r" else "r", label))


def point_labels(c3d: Any, change: Callable[[str], str]) -> None:
    """Rename the points of a C3D file."""
    points = c3d["parameters"]["POINT"]
    for key in [key for key in points if re.fullmatch(r"LABELS\d*", key)]:
        points[key]["value"] = [change(label) for label in points[key]["value"]]


def points_times(c3d: Any, factor: float, pattern: str = "", axes: slice = slice(0, 3)) -> None:
    """Multiply the points whose labels match."""
    points = c3d["parameters"]["POINT"]
    keys = sorted((key for key in points if re.fullmatch(r"LABELS\d*", key)), key=lambda key: (len(key), key))
    for i, label in enumerate(label for key in keys for label in points[key]["value"]):
        if re.search(pattern, label):
            c3d["data"]["points"][axes, i] *= factor


def analog(c3d: Any, pattern: str, factor: float = 1.0, unit: str = "") -> None:
    """Multiply analog channels whose label or unit matches, or state another unit for them."""
    group = c3d["parameters"]["ANALOG"]
    for i, label in enumerate(group["LABELS"]["value"]):
        if re.search(pattern, label):
            c3d["data"]["analogs"][0, i] *= factor
            group["UNITS"]["value"][i] = unit or group["UNITS"]["value"][i]


def analog_exchanged(c3d: Any, firsts: Sequence[int], seconds: Sequence[int]) -> None:
    """Exchange the numbers of analog channels and leave their labels."""
    rows = c3d["data"]["analogs"]
    rows[0, [*firsts, *seconds]] = rows[0, [*seconds, *firsts]]
