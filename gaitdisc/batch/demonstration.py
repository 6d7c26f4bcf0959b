"""The demonstration's study folder: the embedded cohort, written as a laboratory's files."""

from __future__ import annotations

import json
from collections.abc import Callable
from pathlib import Path

from gaitdisc.cohort.cohort import the_twelve, walks_of
from gaitdisc.cohort.marker_trial import standing
from gaitdisc.ingest.c3d_writing import write_c3d
from gaitdisc.ingest.storage import write_storage
from gaitdisc.ingest.study import STATIC, Conditions, Models, Participant, PlannedTrial, Study
from gaitdisc.ingest.study_file import write_study
from gaitdisc.recording import Trial
from gaitdisc.whole_file import write_whole

WALK_S = 60.0
MUSCLES = ("ham", "rf", "vas", "gas", "sol", "ta", "gmed")
FORCES = tuple(f"ground_force_{side}_v{axis}" for side in "rl" for axis in "xy")
OUTPUTS = ("hip_flexion_r", "knee_angle_r", "ankle_angle_r", *(f"emg_{muscle}_r" for muscle in MUSCLES[:5]))


def write_demonstration(
    folder: Path,
    duration_s: float = WALK_S,
    people: int = 12,
    hidden: str = "spring",
    told: Callable[[str, float], None] = lambda *_: None,
    markers: bool = False,
) -> Study:
    """Let the cohort walk and write the recordings, the study file, and apart from them the truth.

    Parameters
    ----------
    duration_s : float
        Length of each walk [s]; the dissertation's is 240.
    told : callable
        Called with a pseudonym and 1.0 when that person has walked.
    markers : bool
        Whether the laboratory gives markers, belts and a static trial in place of joint angles.

    Returns
    -------
    Study
        As written; it passes through the same reading as a laboratory's.
    """
    participants = []
    for person in the_twelve()[:people]:
        walks = walks_of(person, duration_s, hidden, markers)
        write = write_marker_trial if markers else write_trial
        planned = tuple(
            PlannedTrial(
                condition=word,
                files=write(trial, folder, f"raw/{person.name}/{word}"),
                speed_m_per_s=person.speed_m_per_s,
            )
            for word, trial in walks.trials.items()
        )
        if markers:
            files = write_marker_trial(standing(person), folder, f"raw/{person.name}/static")
            planned = (PlannedTrial(condition=STATIC, files=files), *planned)
        participants.append(
            Participant(id=person.name, mass_kg=round(person.mass_kg, 1) if markers else None, trials=planned)
        )
        write_whole(folder / "truth" / f"{person.name}.json", json.dumps(walks.truth, indent=1))
        told(person.name, 1.0)
    study = Study(
        title=f"Demonstration: {people} of the embedded cohort, hidden effect: {hidden}",
        conditions=Conditions(nominal="nominal", device="exo"),
        channels={} if markers else {name: f"{name} [N]" for name in FORCES},
        models=Models(emg=tuple(f"emg_{muscle}_{side}" for side in "rl" for muscle in MUSCLES), outputs=OUTPUTS),
        participants=tuple(participants),
    ).placed(folder)
    write_study(study, folder / "study.toml")
    return study


def write_trial(trial: Trial, folder: Path, stem: str) -> tuple[str, ...]:
    """Write angles as OpenSim does, EMG and forces as the analog channels of a C3D file."""
    angles, analog = names = (f"{stem}_ik.mot", f"{stem}.c3d")
    (folder / angles).parent.mkdir(parents=True, exist_ok=True)
    write_storage(trial.stream("kinematics"), folder / angles)
    write_c3d((trial.stream("emg"), trial.stream("forces")), folder / analog)
    return names


def write_marker_trial(trial: Trial, folder: Path, stem: str) -> tuple[str, ...]:
    """Write markers, EMG and belts as one C3D file."""
    name = f"{stem}.c3d"
    (folder / name).parent.mkdir(parents=True, exist_ok=True)
    write_c3d([stream for key, stream in trial.streams.items() if key != "kinematics"], folder / name, trial.surfaces)
    return (name,)
