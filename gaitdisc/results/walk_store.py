"""Saving and loading of a walk: the folder `walks/<person>-<condition>/` of a run."""

from __future__ import annotations

import hashlib
from dataclasses import asdict
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from gaitdisc.channel import Channel
from gaitdisc.results.on_disk import Arrays
from gaitdisc.results.unit_folder import Keyed, load_unit, save_unit, stored_finding, with_words
from gaitdisc.results.walk_summary import STRIDE_COLUMNS, WalkSummary


def save_walk(walk: WalkSummary, folder: Path, key: str) -> None:
    """Save one walk.

    key: what the walk was computed from: a hash of files and settings
    """
    save_unit(
        folder,
        "walk.json",
        {
            "key": key,
            "subject": walk.subject,
            "condition": walk.condition,
            "duration_s": walk.duration_s,
            "rate_hz": walk.rate_hz,
            "detector": walk.detector,
            "channels": [asdict(channel) for channel in walk.channels],
            "findings": [asdict(finding) for finding in walk.findings],
            "files": dict(walk.files),
        },
        {"strides.csv": walk.strides},
        {"curves": walk.curves},
    )


def load_walk(folder: Path) -> Keyed[WalkSummary]:
    """Load one walk, and the key it was computed from."""
    data, tables, arrays = load_unit(folder, "walk.json", {"strides.csv": STRIDE_COLUMNS})
    strides = with_words(tables["strides.csv"], "reason")
    walk = WalkSummary(
        data["subject"],
        data["condition"],
        data["duration_s"],
        data["rate_hz"],
        data["detector"],
        tuple(Channel(**channel) for channel in data["channels"]),
        arrays.later(_curves),
        strides,
        tuple(map(stored_finding, data["findings"])),
        data["files"],
    )
    return Keyed(walk, data["key"])


def unit_name(subject: str, condition: str) -> str:
    """Folder name of a walk: letters, digits, `-` and `_` only, another one for every person and condition.

    >>> unit_name("P01", "exo"), unit_name("P01", "no spring"), unit_name("P01", "no_spring")
    ('P01-exo', 'P01-no_spring-e4cfa24e', 'P01-no_spring')
    """
    who = "".join(letter if letter.isalnum() or letter in "-_" else "_" for letter in subject)
    plain = "".join(letter if letter.isalnum() or letter == "_" else "_" for letter in condition)
    if (who, plain) == (subject, condition):
        return f"{subject}-{condition}"
    told_apart = hashlib.sha256(" ".join((subject, condition)).encode()).hexdigest()[:8]
    return f"{who}-{plain}-{told_apart}"


def _curves(arrays: Arrays) -> NDArray[np.float64]:
    return arrays["curves"]
