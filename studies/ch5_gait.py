"""What the two gait studies of chapter 5 have in common: the sensor sets of Table 5.2, the walks, a table cell."""

from __future__ import annotations

import tomllib
from dataclasses import dataclass
from pathlib import Path

import numpy as np
import pandas as pd
from command_line import SHARED

import gaitdisc as gd
from gaitdisc.batch.demonstration import write_demonstration
from gaitdisc.batch.reconstruct_study import ReconstructionSettings, reconstruct_study
from gaitdisc.channel import vocabulary
from gaitdisc.ingest.study import Conditions, Participant, PlannedTrial, Quality, Study
from gaitdisc.ingest.study_file import load_study
from gaitdisc.report.reconstruction_page import write_reconstruction_report

SENSORS = {
    "3 random": ("pelvis_rotation", "pelvis_tz", "hip_adduction_r"),
    "3 sagittal": ("hip_flexion_r", "knee_angle_r", "ankle_angle_r"),
    "1 random": ("pelvis_tz",),
    "1 sagittal": ("ankle_angle_r",),
}  # of Table 5.2: "randomly" and "non-randomly chosen"
PRINTED = ["sensors", "model", "mean", "sd"]
NOTHING_PRINTED = pd.DataFrame(columns=pd.Index(PRINTED))
PELVIS = ("3 random", "1 random")  # the embedded cohort has no pelvis, and cannot have these
WALK_S, PEOPLE = 60.0, 12
DATA = SHARED / "gait"
TREADMILL = range(504, 516)
RUNS = {
    "welk007": {
        "natural": "c3d_Trimmed_running_natural2_manual_scaling_ik.mot",
        "exotendon": "c3d_Trimmed_running_exotendon3_manual_scaling_ik.mot",
    },
    "welk002": {"natural": "welk002"},
}


@dataclass(frozen=True, eq=False)
class Result:
    """One of the two studies."""

    table: pd.DataFrame
    page: Path


def printed(kind: str) -> pd.DataFrame:
    """Values of Table 5.2: sensors, model, mean, sd."""
    rows = tomllib.loads(Path(__file__).with_name("ch5_printed.toml").read_text(encoding="utf-8"))["row"]
    models = ("shred", "shallow decoder", "linear")
    found = [(row["sensors"], model, *row[model]) for row in rows if row["kind"] == kind for model in models]
    return pd.DataFrame(found, columns=pd.Index(PRINTED))


def cell(study: Study, sensors: str, settings: ReconstructionSettings, folder: Path) -> dict[str, pd.DataFrame]:
    """Summary and errors of one sensor set in one data set, with their report; what is in the folder is not redone."""
    if not (folder / "report.html").exists():
        done, _ = reconstruct_study(study, SENSORS[sensors], settings)
        done.save(folder)
        write_reconstruction_report(done, folder)
    return {name: pd.read_csv(folder / f"{name}.csv").assign(sensors=sensors) for name in ("summary", "errors")}


def first_person(study: Study) -> Study:
    """The study with its first participant alone."""
    return study.model_copy(update={"participants": study.participants[:1]}).placed(study.folder)


def cohort(folder: Path, people: int = PEOPLE, walk_s: float = WALK_S) -> Study:
    """The embedded cohort, walking; ten joint angles, no pelvis and no trunk.

    Parameters
    ----------
    walk_s : float
        Length of each walk [s].
    """
    if not (folder / "study.toml").exists():
        write_demonstration(folder, walk_s, people)
    return load_study(folder)


def treadmill(data: Path, folder: Path) -> Study:
    """One person of treadmill_walk_ik, twelve walks of 21 s, all 18 states."""
    with np.load(data / "treadmill_walk_ik" / "addbio_expert3_ik.npz") as packed:
        named = [vocabulary().named(str(name)) for name in packed["columns"]]
        kept = [k for k, channel in enumerate(named) if channel is not None]
        for number in TREADMILL:
            values = np.asarray(packed[f"S01DE{number}"], float)[:, kept]
            channels = tuple(channel for channel in named if channel is not None)
            folder.mkdir(parents=True, exist_ok=True)
            gd.write(gd.Recording(np.arange(len(values)) / 100.0, values, channels), folder / f"{number}.mot")
    trials = tuple(PlannedTrial(condition="walk", files=(f"{number}.mot",)) for number in TREADMILL)
    return _study("treadmill_walk_ik", ("walk", "none"), (Participant(id="S01", trials=trials),)).placed(folder)


def exotendon(data: Path) -> Study:
    """Two runners of exotendon_run, one of them without and with the device."""
    folder = data / "exotendon_run"
    found = {path.name: path.relative_to(folder) for path in sorted(folder.rglob("*.mot"))}
    found["welk002"] = next(path for path in found.values() if path.parts[0] == "welk002")
    people = tuple(
        Participant(
            id=who,
            trials=tuple(PlannedTrial(condition=word, files=(str(found[name]),)) for word, name in runs.items()),
        )
        for who, runs in RUNS.items()
    )
    return _study("exotendon_run", ("natural", "exotendon"), people).placed(folder)


def _study(title: str, words: tuple[str, str], people: tuple[Participant, ...]) -> Study:
    both = Conditions(nominal=words[0], device=words[1])
    return Study(title=title, conditions=both, participants=people, quality=Quality(late_change="report"))
