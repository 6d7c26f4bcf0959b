"""Halves of one real walk compared, with the marks of initial contact of one half moved on purpose.

    python studies/compare_halves.py [DATA] [--quick]

DATA holds the folders treadmill_walk_ik and exotendon_run; by default ../shared/data/gait, or GAITDISC_DATA/gait. Both
halves are cut by contacts from hip and knee; in the second half every contact is moved by 0, 3, 7 or 10 % of its
stride. Nothing differs but the marks, the noise, and what the person changed over a minute.
"""

from __future__ import annotations

from command_line import GAIT, QUICK, command_line

GIVEN = command_line(__name__, __doc__, GAIT, QUICK)  # before the slow imports

import re
from collections.abc import Iterator
from dataclasses import replace
from pathlib import Path
from typing import NamedTuple

import numpy as np
from markdown_table import markdown_table

import gaitdisc as gd

SHIFTS, QUICK_SHIFTS = (0, 3, 7, 10), (0, 7)  # % of the stride
CALIBRATION = "S01DE503"  # holds no walking
POSITION = ("pelvis_tx", "pelvis_ty", "pelvis_tz")
JOINTS = tuple(f"{joint}_{side}" for joint in ("hip_flexion", "knee_angle") for side in "rl")


class Halves(NamedTuple):
    """Second half, its contacts moved [% stride], against the first of one walk."""

    walk: str
    shift: int
    mismatch: gd.Mismatch

    def largest(self) -> float:
        """Largest gap of a named channel [deg]; 0 where none is."""
        gaps = [abs(self.mismatch.summary_of(name)["largest_gap"]) for name in self.mismatch.ordered()]
        return float(max(gaps, default=0.0))


def run(data: Path, quick: bool = False) -> list[Halves]:
    """Every walk and shift; quick: the three running trials, not moved and moved by 7 %."""
    running = [gd.read(file) for file in sorted((data / "exotendon_run").rglob("*.mot"))]
    chosen = running if quick else [*walking(data), *running]
    return [halves(walk, shift) for shift in (QUICK_SHIFTS if quick else SHIFTS) for walk in chosen]


def walking(data: Path) -> Iterator[gd.Trial]:
    """Twelve treadmill walks, angles at 100 Hz."""
    stored = np.load(data / "treadmill_walk_ik" / "addbio_expert3_ik.npz")
    columns = [str(name) for name in stored["columns"]]
    kept = [i for i, name in enumerate(columns) if not name.startswith(POSITION)]
    sides = [next((side for side in "rl" if re.search(f"_{side}(_beta)?$", columns[i])), "") for i in kept]
    channels = tuple(gd.Channel(columns[i], "angle", "deg", side) for i, side in zip(kept, sides, strict=True))
    for name in sorted(key for key in stored.files if key.startswith("S01") and key != CALIBRATION):
        values = np.asarray(stored[name], float)[:, kept]
        yield gd.Trial(name, {"kinematics": gd.Recording(np.arange(len(values)) / 100.0, values, channels)})


def halves(walk: gd.Trial, shift: int) -> Halves:
    """The second half, its contacts moved, minus the first."""
    angles = walk.stream("kinematics")
    middle, end = angles.time[len(angles.time) // 2], angles.time[-1] + 1.0
    first = with_contacts(walk, "first half", angles.between(angles.time[0], middle), 0)
    second = with_contacts(walk, "second half", angles.between(middle, end), shift)
    return Halves(walk.name, shift, gd.compare(first, second, detector="events"))


def with_contacts(walk: gd.Trial, name: str, part: gd.Recording, shift: int) -> gd.Trial:
    """Part of a walk with contacts from hip and knee as its events, each moved by a share of its stride [%]."""
    events = []
    for side, found in gd.contacts(gd.Trial(name, {"kinematics": part.selected(JOINTS)}), "angles").items():
        moved = found.time[:-1] + shift / 100 * np.diff(found.time) if shift else found.time
        events += [gd.Event("initial contact", side, float(time)) for time in moved]
    return replace(walk, name=name, condition=name, streams={"kinematics": part}, events=tuple(events))


def table(found: list[Halves]) -> list[tuple[str, ...]]:
    """A row a shift."""
    rows = []
    for shift in sorted({one.shift for one in found}):
        of_shift = [one for one in found if one.shift == shift]
        said = [one.mismatch.alignment.percent for one in of_shift]
        channels = sum(len(one.mismatch.channels) for one in of_shift)
        named = sum(len(one.mismatch.ordered()) for one in of_shift)
        silent = sum(one.largest() == 0 for one in of_shift)
        largest, off = max(one.largest() for one in of_shift), f"{min(said):.1f} to {max(said):.1f}"
        counts = (f"{silent} of {len(of_shift)}", f"{named} of {channels}")
        rows.append((str(shift), *counts, f"{largest:.1f}", off))
    return rows


if __name__ == "__main__":
    found = run(GIVEN.data, GIVEN.quick)
    head = "contacts moved [% stride] | pairs with nothing named | channels named | largest [deg] | shift found [%]"
    print(markdown_table(head, table(found)))
    named = []
    for one in (one for one in found if one.largest() > 0):
        gaps = {name: one.mismatch.summary_of(name)["largest_gap"] for name in one.mismatch.ordered()}
        named.append((one.walk, one.shift, ", ".join(f"{name} {gap:+.1f}" for name, gap in gaps.items())))
    print("\n" + markdown_table("walk | contacts moved [% stride] | named: largest gap [deg]", named))
