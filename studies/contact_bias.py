"""Initial contacts from markers and joint angles against those of plates and of the files' own events.

    python studies/contact_bias.py [DATA] [--quick]

DATA holds the folder young_straight_and_turn (events and plates) and further walks as C3D files. Differences are
markers' or angles' contact minus the other's [ms], before the program corrects them by a plate; contacts farther apart
than 250 ms are no pair.
"""

from __future__ import annotations

from command_line import GAIT, QUICK, command_line

GIVEN = command_line(__name__, __doc__, GAIT, QUICK)  # before the slow imports

from collections.abc import Mapping
from contextlib import suppress
from pathlib import Path
from typing import NamedTuple

import numpy as np
from markdown_table import markdown_table

import gaitdisc as gd

Row = tuple[str, ...]
Detected = Mapping[str, Mapping[str, gd.Contacts]]  # detector, side
Walks = dict[Path, Detected]
BELT, YOUNG_PERSON = "treadmill_c3d_emg", "young_straight_and_turn/HC033A"
REPEATED = "type-4a.c3d"  # the walk of type-2a.c3d, with its forces stored in another way


def walks(data: Path, quick: bool = False) -> Walks:
    """Contacts of every C3D walk under the folder, by detector and side."""
    files = sorted((data / YOUNG_PERSON if quick else data).rglob("*.c3d"))
    found: Walks = {}
    with gd.C3DReader() as reader:
        for file in (file for file in files if file.name != REPEATED):
            with suppress(gd.GaitdiscError):  # three of the files are damaged on purpose
                found[file] = gd.contacts_by_detector(gd.read(file, reader=reader))
    return found


class Matched(NamedTuple):
    """Both feet of several walks together, second minus first [ms], and the contacts that only one has [s]."""

    apart_ms: np.ndarray
    missed: np.ndarray
    extra: np.ndarray


def matched(walks: list[Detected], first: str, second: str) -> Matched:
    """Contacts of two detectors, paired."""
    sides = [(walk.get(first, {}), walk.get(second, {}), side) for walk in walks for side in "rl"]
    found = [one[side].compared(other[side]) for one, other, side in sides if side in one and side in other]
    parts = zip(*((1e3 * one.difference_s, one.missed, one.extra) for one in found), strict=True)
    return Matched(*map(np.concatenate, parts)) if found else Matched(*(np.empty(0) for _ in range(3)))


def against_events(found: Walks) -> list[Row]:
    """Straight walks and turns: offset, scatter, and contacts that only one has."""
    rows = []
    for kind in ("straight", "turn"):
        walked = [walk for file, walk in found.items() if file.parent.name == kind and "events" in walk]
        contacts = sum(len(one) for walk in walked for one in walk["events"].values())
        for detector in ("markers", "angles"):
            pairs = matched(walked, "events", detector)
            apart, middle = pairs.apart_ms, np.median(pairs.apart_ms)
            counts = (f"{kind}, {len(walked)}", detector, f"{len(apart)} of {contacts}")
            sizes = (f"{middle:+.0f}", f"{np.percentile(np.abs(apart - middle), 95):.0f}")
            rows.append((*counts, *sizes, str(len(pairs.missed)), str(len(pairs.extra))))
    return rows


def against_plates(found: Walks) -> tuple[list[Row], list[Row]]:
    """Offsets by trial; and what is left of them where another step of the trial corrects a step."""
    offsets, corrections = [], []
    for detector in ("markers", "angles"):
        steps = {file: matched([walk], "force", detector).apart_ms for file, walk in found.items()}
        seen = {file: apart for file, apart in steps.items() if len(apart)}
        medians = [float(np.median(apart)) for apart in seen.values()]
        middle, span = f"{np.median(medians):+.0f}", f"{min(medians):+.0f} to {max(medians):+.0f}"
        offsets.append((detector, str(len(seen)), str(sum(map(len, seen.values()))), middle, span))
        for plate in ("floor", "belt"):
            several = [a for file, a in seen.items() if len(a) > 1 and (BELT in file.parts) == (plate == "belt")]
            if several:
                left = np.concatenate([apart[i] - np.delete(apart, i) for apart in several for i in range(len(apart))])
                placed = np.concatenate(several)
                sizes = [f"{np.percentile(np.abs(size), q):.0f}" for size in (placed, left) for q in (50, 95)]
                corrections.append((detector, plate, str(len(placed)), str(len(left)), *sizes))
    return offsets, corrections


TABLES = (
    "walks, n|contacts from|pairs, of events|minus event, median [ms]|95 % within [ms]|missed|extra",
    "contacts from|walks, n|steps, n|minus plate, median of the walks' medians [ms]|their range [ms]",
    "contacts from|plate|steps, n|pairs of steps, n|error as placed, median [ms]|95 % [ms]"
    "|corrected by one other step, median [ms]|95 % [ms]",
)


if __name__ == "__main__":
    found = walks(GIVEN.data, GIVEN.quick)
    for head, rows in zip(TABLES, (against_events(found), *against_plates(found)), strict=True):
        print(markdown_table(head, rows), end="\n\n")
