"""Eight people under nine settings of an ankle exoskeleton: their median strides, and electrodes with a fault."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from pathlib import Path

import numpy as np
import pandas as pd
from numpy.typing import NDArray

PEOPLE = tuple(f"S{number:02d}" for number in range(1, 9))
SETTINGS = tuple(f"C{number}" for number in range(1, 10))
MUSCLES = {
    "gastrocnemius": ("MGAS", "LGAS"),
    "soleus": ("MSOL", "LSOL"),
    "tibialis anterior": ("TA",),
    "vastus medialis": ("VASM",),
    "rectus femoris": ("RF",),
    "biceps femoris": ("BF",),
}
PARTS = ("early stance", "late stance", "swing")
LOADED = 0.05  # of the largest vertical force: a foot is on the ground
LARGEST_CHANGE = 2.5  # of an electrode's mean over the stride against its median over the settings: beyond it, a fault
LEAST_BURST = 1.5  # largest over smallest value of the curve: below it, nothing but noise


@dataclass(frozen=True, eq=False)
class Walks:
    """Median stride of every person and setting."""

    curves: Mapping[tuple[str, str], pd.DataFrame]  # (bin, signal) [N; EMG: unknown], from right initial contact on
    energy_w: pd.DataFrame  # (person, setting) [W]
    strides: int


def read_walks(folder: Path) -> Walks:
    """Read the recordings; the median over strides is not moved by the spikes that some strides have."""
    with np.load(folder / "assisted.npz") as stored:
        names = [str(name) for name in stored["signals"]]
        strides = {(p, s): np.asarray(stored[f"x_{p}{s}"], float) for p in PEOPLE for s in SETTINGS}
        power = {s: [float(stored[f"y_{p}{s}"][0].mean()) for p in PEOPLE] for s in SETTINGS}
    curves = {key: pd.DataFrame(np.median(values, axis=0).T, columns=names) for key, values in strides.items()}
    return Walks(curves, pd.DataFrame(power, index=list(PEOPLE)), sum(len(values) for values in strides.values()))


def part_of_stride(force: NDArray[np.float64]) -> NDArray[np.str_]:
    """Part of the stride that each phase bin belongs to, from the leg's own vertical force."""
    on_ground = np.abs(force) > LOADED * np.abs(force).max()
    contacts = np.flatnonzero(on_ground & ~np.roll(on_ground, 1))
    lengths = [int(np.argmin(np.roll(on_ground, -start))) or len(force) for start in contacts]
    start, length = max(zip(contacts, lengths, strict=True), key=lambda stance: stance[1])
    parts = np.full(len(force), PARTS[2], dtype="<U12")
    stance = (start + np.arange(length)) % len(force)
    parts[stance[: length // 2]], parts[stance[length // 2 :]] = PARTS[0], PARTS[1]
    return parts


def faulty_electrodes(walks: Walks) -> dict[tuple[str, str], str]:
    """Electrodes (person, signal) that are left out in all settings, with the reason."""
    found = {}
    for person in PEOPLE:
        for name in electrodes_of():
            curves = np.column_stack([walks.curves[person, setting][name] for setting in SETTINGS])
            change = curves.mean(axis=0) / np.median(curves.mean(axis=0))
            burst = curves.max(axis=0) / np.abs(curves).min(axis=0)
            worst = int(np.argmax(np.abs(np.log(change))))
            if not 1 / LARGEST_CHANGE < change[worst] < LARGEST_CHANGE:
                found[person, name] = f"{change[worst]:.2g} times its median in {SETTINGS[worst]}"
            elif burst.min() < LEAST_BURST:
                found[person, name] = f"no burst in {SETTINGS[int(np.argmin(burst))]}"
    return found


def electrodes_of(heads: tuple[str, ...] = tuple(head for muscle in MUSCLES.values() for head in muscle)) -> list[str]:
    """Names of the electrodes over these heads, right and left."""
    return [f"{head}_{side}" for head in heads for side in "RL"]
