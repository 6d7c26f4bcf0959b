"""Strides, plateaus and EMG channels found in real treadmill recordings.

    python studies/real_strides.py [DATA]

DATA holds the folders exotendon_run, treadmill_walk_ik and treadmill_c3d_emg. Each row is a promise and what was found.
"""

from __future__ import annotations

from command_line import GAIT, command_line

GIVEN = command_line(__name__, __doc__, GAIT)  # before the slow imports

from pathlib import Path

import numpy as np
import pandas as pd
from markdown_table import markdown_table

import gaitdisc as gd
from gaitdisc.signals.channel_quality import plateaus
from gaitdisc.signals.strides import verify_walking

Row = tuple[str, str, str]
RUNNING_STRIDES = {"natural2": 83, "exotendon3": 88, "manual_ik": 90}
WALKING_STRIDES, HIP_LIMIT_DEG = 221, -29.9


def run(data: Path) -> list[Row]:
    """Every row."""
    angles = treadmill_angles(data / "treadmill_walk_ik")
    return [*exotendon(data / "exotendon_run"), *angles, *treadmill_c3d(data / "treadmill_c3d_emg")]


def exotendon(folder: Path) -> list[Row]:
    """Strides of the running trials, from joint angles alone, right side."""
    rows = []
    for word, count in RUNNING_STRIDES.items():
        [file] = [path for path in folder.rglob("*.mot") if word in path.name]
        strides = right_strides(gd.read(file).stream("kinematics"))
        found = f"{len(strides)}, {len(strides.dropped)} dropped"
        rows.append((f"exotendon_run/{word}", f"{count} strides, +-1", found))
    return rows


def treadmill_angles(folder: Path) -> list[Row]:
    """Strides and hip plateaus of twelve walks; two range-of-motion trials are no walks."""
    stored = np.load(folder / "addbio_expert3_ik.npz")
    names = [str(name) for name in stored["columns"]]
    kept = dropped = with_plateau = 0
    limits, refused, walks = [], [], {"S01DN603": gd.read(folder / "S01DN603_ik.mot").stream("kinematics")}
    for trial in sorted(key for key in stored.files if key.startswith("S01DE")):
        table = pd.DataFrame(np.asarray(stored[trial], float), columns=pd.Index(names))
        walks[trial] = gd.read(table.assign(time=np.arange(len(table)) / 100.0)).stream("kinematics")
    for trial, kinematics in sorted(walks.items()):
        try:
            strides = right_strides(kinematics)
            verify_walking(kinematics, strides)
        except gd.GaitdiscError as error:
            refused.append(f"{trial}: {error.found.split(': ', 1)[-1]}")
            continue
        kept, dropped = kept + len(strides), dropped + len(strides.dropped)
        found = [p for p in plateaus(kinematics) if p.channel in ("hip_flexion_r", "hip_flexion_l")]
        with_plateau += len(found) > 0
        limits += [p.limit for p in found]
    walks, strides = "treadmill_walk_ik, 12 walks", f"{kept} kept + {dropped} dropped = {kept + dropped}"
    plateau = f"in {with_plateau} walks, at {min(limits):.1f} to {max(limits):.1f} deg"
    return [
        (walks, f"{WALKING_STRIDES} strides, +-1 %", strides),
        (walks, f"hip plateau at {HIP_LIMIT_DEG} deg", plateau),
        ("treadmill_walk_ik, 2 calibrations", "refused as walking", "; ".join(refused)),
    ]


def treadmill_c3d(folder: Path) -> list[Row]:
    """EMG channels kept apart; strides from belts whose force chatters."""
    trial = gd.read(folder / "walking_1.c3d")
    emg, strides = trial.stream("emg"), {side: len(gd.cycles(trial, side, "force")) for side in "rl"}
    peaks = 1e3 * np.nanmax(gd.envelope(emg).values, axis=0)
    return [
        ("treadmill_c3d_emg", "16 EMG channels apart", f"{len(set(emg.names))}: {emg.names[0]} to {emg.names[-1]}"),
        ("treadmill_c3d_emg", "envelopes", f"{len(peaks)}, peaks from {peaks.min():.1f} to {peaks.max():.1f} mV"),
        ("treadmill_c3d_emg", "6-7 strides a leg", f"right {strides['r']}, left {strides['l']}"),
    ]


def right_strides(kinematics: gd.Recording) -> gd.Strides:
    """Strides of the right side, from joint angles alone."""
    return gd.cycles(kinematics, "r", "angles", kinematics)


if __name__ == "__main__":
    print(markdown_table("recordings | promise | found", run(GIVEN.data)))
