"""The demonstration's study folder: small recordings that the package makes itself, written as a laboratory's files."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path

from gaitdisc.cohort.driven_walker import DrivenWalker
from gaitdisc.ingest.storage import write_storage
from gaitdisc.ingest.study import Conditions, HeldOut, Models, Participant, PlannedTrial, Study
from gaitdisc.ingest.study_file import write_study
from gaitdisc.recording import Trial

WALK_S = 60.0
SPRING_PER_S2 = 250.0
PEOPLE = (DrivenWalker("W01", 1.08, 1.0, seed=11), DrivenWalker("W02", 1.15, 0.93, seed=12))
FILES = {"kinematics": "ik.mot", "emg": "emg.sto", "forces": "grf.mot"}
TITLE = "Demonstration: two driven walkers, with and without a one-sided ankle spring"


def write_demonstration(folder: Path, duration_s: float = WALK_S) -> Study:
    """Make the recordings and the study file.

    Parameters
    ----------
    folder : Path
        Where the study shall lie.
    duration_s : float
        Length of each walk [s].

    Returns
    -------
    Study
        As written; it passes through the same reading as a laboratory's.
    """
    participants = []
    for person in PEOPLE:
        walks = {
            "nominal": person.walked(duration_s, "nominal"),
            "exo": replace(person, spring_per_s2=SPRING_PER_S2).walked(duration_s, "exo"),
        }
        planned = tuple(
            PlannedTrial(condition=word, files=_write_trial(trial, folder, f"raw/{person.name}/{word}"))
            for word, trial in walks.items()
        )
        participants.append(Participant(id=person.name, trials=planned))
    study = Study(
        title=TITLE,
        conditions=Conditions(nominal="nominal", device="exo"),
        channels={f"emg_{muscle}_{side}": f"emg_{muscle}_{side} [V]" for side in "rl" for muscle in ("sol", "ta")},
        models=Models(
            emg=("emg_sol_r", "emg_ta_r", "emg_sol_l", "emg_ta_l"),
            outputs=("hip_flexion_r", "knee_angle_r", "ankle_angle_r", "emg_sol_r", "emg_ta_r"),
        ),
        held_out=HeldOut(share=0.125),
        participants=tuple(participants),
    ).placed(folder)
    write_study(study, folder / "study.toml")
    return study


def _write_trial(trial: Trial, folder: Path, stem: str) -> tuple[str, ...]:
    names = []
    for key, ending in FILES.items():
        names.append(f"{stem}_{ending}")
        (folder / names[-1]).parent.mkdir(parents=True, exist_ok=True)
        write_storage(trial.stream(key), folder / names[-1])
    return tuple(names)
