"""Saving and loading of pooled cycles: the folder `cycles/<person>-<session and condition>/` of a run."""

from __future__ import annotations

from dataclasses import asdict
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from gaitdisc.channel import Channel
from gaitdisc.results.on_disk import Arrays
from gaitdisc.results.pooled_cycles import CYCLE_COLUMNS, PooledCycles
from gaitdisc.results.provenance import Refusal
from gaitdisc.results.unit_folder import NO_KEY, Keyed, load_unit, save_unit, stored_finding, with_words
from gaitdisc.results.walk_store import unit_name

WORDS = ("reason", "foot_off_by")


def save_cycles(pooled: PooledCycles, folder: Path, key: str) -> None:
    """Save the cycles of one person, session and condition: `cycles.json`, `cycles.csv`, `arrays.npz`.

    key: what they were computed from: a hash of files and settings
    """
    save_unit(
        folder,
        "cycles.json",
        {
            "key": key,
            "subject": pooled.subject,
            "group": pooled.group,
            "session": pooled.session,
            "condition": pooled.condition,
            "trials": pooled.trials,
            "detectors": dict(pooled.detectors),
            "contact_offset_s": pooled.contact_offset_s,
            "foot_off_offset_s": pooled.foot_off_offset_s,
            "offset_steps": pooled.offset_steps,
            "over_ground": pooled.over_ground,
            "channels": [asdict(channel) for channel in pooled.channels],
            "findings": [asdict(finding) for finding in pooled.findings],
            "refusals": [asdict(refusal) for refusal in pooled.refusals],
            "files": dict(pooled.files),
            "leg_m": pooled.leg_m,
            "age_years": pooled.age_years,
        },
        {"cycles.csv": pooled.cycles},
        {"curves": pooled.curves},
    )


def load_cycles(folder: Path) -> Keyed[PooledCycles]:
    """Load pooled cycles, and the key they were computed from."""
    data, tables, arrays = load_unit(folder, "cycles.json", {"cycles.csv": CYCLE_COLUMNS})
    cycles = tables["cycles.csv"]
    for column in WORDS:
        with_words(cycles, column)
    for column in ("kinetic", "kept"):
        cycles[column] = cycles[column].astype(bool)
    pooled = PooledCycles(
        data["subject"],
        data["group"],
        data["session"],
        data["condition"],
        data["trials"],
        data["detectors"],
        data["contact_offset_s"],
        data["foot_off_offset_s"],
        data["offset_steps"],
        data["over_ground"],
        tuple(Channel(**channel) for channel in data["channels"]),
        arrays.later(_curves),
        cycles,
        tuple(map(stored_finding, data["findings"])),
        tuple(Refusal(**refusal) for refusal in data["refusals"]),
        data["files"],
        data.get("leg_m"),
        data.get("age_years"),
    )
    return Keyed(pooled, data["key"])


def save_pooled_cycles(pooled: PooledCycles, folder: Path) -> None:
    """Save pooled cycles that stand alone, of no run."""
    save_cycles(pooled, folder, NO_KEY)


def load_pooled_cycles(folder: Path) -> PooledCycles:
    """Load pooled cycles, of a run or alone."""
    return load_cycles(folder).result


def cycles_name(subject: str, session: str, condition: str) -> str:
    """Folder name of pooled cycles, another one for every person, session and condition.

    >>> cycles_name("P01", "", "turn"), cycles_name("P01", "after", "turn")
    ('P01-turn', 'P01-after___turn-c681ddd0')
    """
    return unit_name(subject, f"{session} / {condition}" if session else condition)


def _curves(arrays: Arrays) -> NDArray[np.float64]:
    return arrays["curves"]
