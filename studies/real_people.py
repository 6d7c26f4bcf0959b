"""Every real person whose joint angles are here, on one convention: ten angles of both legs at 100 Hz."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from pathlib import Path

import numpy as np
from ch5_gait import DATA, RUNS, TREADMILL

import gaitdisc as gd

JOINTS = ("hip_flexion", "hip_adduction", "hip_rotation", "knee_angle", "ankle_angle")
ANGLES = tuple(f"{joint}_{side}" for side in "rl" for joint in JOINTS)
CUTOFF_HZ, RATE_HZ = 6.0, 100
MOST_WINDOWS = 600  # of one person: as many as a long walk has would outweigh everybody else


@dataclass(frozen=True, eq=False)
class Person:
    """One person's walks, low-passed; `group` is what was walked."""

    name: str
    group: str
    recordings: tuple[gd.Recording, ...]

    def windows(self, windows_of: Callable[[gd.Recording, np.ndarray], gd.Samples]) -> list[gd.Samples]:
        """Windows of every walk, thinned evenly to as many as a person may have."""
        every = [windows_of(one, np.zeros(len(one.time))) for one in self.recordings]
        step = max(1, -(-sum(len(each) for each in every) // MOST_WINDOWS))
        return [each.rows(slice(None, None, step)) for each in every]


def angles(path: Path) -> gd.Recording:
    """Ten angles of a file, low-passed, at 100 Hz."""
    read = gd.read(path).stream("kinematics").selected(ANGLES)
    low = gd.lowpass(read, CUTOFF_HZ)
    every = round(low.rate_hz / RATE_HZ)
    return gd.Recording(low.time[::every], low.values[::every], low.channels)


def turning() -> list[Person]:
    """Six children, each a straight walk and a turn of one or two strides."""
    folder = DATA / "young_straight_and_turn"
    people = sorted(path for path in folder.iterdir() if path.is_dir())
    both = [[next((person / way).glob("*.c3d")) for way in ("straight", "turn")] for person in people]
    return [Person(p.name, "straight", tuple(map(angles, files))) for p, files in zip(people, both, strict=True)]


def real_people() -> list[Person]:
    """Eight who walk (six children, straight on) and two who run."""
    children = [Person(each.name, "walking, children", each.recordings[:1]) for each in turning()]
    with np.load(DATA / "treadmill_walk_ik" / "addbio_expert3_ik.npz") as packed:
        names = [str(name) for name in packed["columns"]]
        kept = [names.index(name) for name in ANGLES]
        channels = tuple(children[0].recordings[0].channels)
        walks = [np.asarray(packed[f"S01DE{number}"], float)[:, kept] for number in TREADMILL]
    belt = tuple(gd.lowpass(gd.Recording(np.arange(len(v)) / RATE_HZ, v, channels), CUTOFF_HZ) for v in walks)
    moco = angles(DATA / "opensim_walks" / "moco_3dwalking" / "coordinates.sto")
    runs = DATA / "exotendon_run"
    first = angles(runs / RUNS["welk007"]["natural"]), angles(runs / "welk002" / "manual_ik.mot")
    adults = [Person("S01", "walking, adults", belt), Person("moco", "walking, adults", (moco,))]
    return [*children, *adults, *(Person(n, "running", (one,)) for n, one in zip(RUNS, first, strict=True))]
