"""Faults of meaning in a C3D file: labels, units and numbers of points and of analog channels."""

from __future__ import annotations

import re
from collections.abc import Callable, Sequence


def point_labels(change: Callable[[str], str]) -> Callable[[object], None]:
    """Rename the points of a C3D file."""

    def turn(c3d) -> None:
        points = c3d["parameters"]["POINT"]
        for key in [key for key in points if re.fullmatch(r"LABELS\d*", key)]:
            points[key]["value"] = [change(label) for label in points[key]["value"]]

    return turn


def points_times(factor: float, pattern: str = "", axis: int | None = None) -> Callable[[object], None]:
    """Multiply the points whose labels match."""

    def turn(c3d) -> None:
        points = c3d["parameters"]["POINT"]
        keys = sorted((key for key in points if re.fullmatch(r"LABELS\d*", key)), key=lambda key: (len(key), key))
        labels = [label for key in keys for label in points[key]["value"]]
        chosen = [i for i, label in enumerate(labels) if re.search(pattern, label)]
        where = slice(0, 3) if axis is None else slice(axis, axis + 1)
        for i in chosen:
            c3d["data"]["points"][where, i] *= factor

    return turn


def analog(pattern: str, factor: float = 1.0, unit: str = "") -> Callable[[object], None]:
    """Multiply analog channels whose label or unit matches, or state another unit for them."""

    def turn(c3d) -> None:
        group = c3d["parameters"]["ANALOG"]
        for i, label in enumerate(group["LABELS"]["value"]):
            if re.search(pattern, label):
                c3d["data"]["analogs"][0, i] *= factor
                if unit:
                    group["UNITS"]["value"][i] = unit

    return turn


def analog_exchanged(firsts: Sequence[int], seconds: Sequence[int]) -> Callable[[object], None]:
    """Exchange the numbers of analog channels and leave their labels."""

    def turn(c3d) -> None:
        rows = c3d["data"]["analogs"]
        rows[0, [*firsts, *seconds]] = rows[0, [*seconds, *firsts]]

    return turn
