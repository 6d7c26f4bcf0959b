"""The embedded cohort as a laboratory's study folder, and gait planted into its walks for tests of the rules."""

import json
from collections.abc import Callable
from dataclasses import replace
from pathlib import Path

import numpy as np
from scipy.ndimage import gaussian_filter1d

from gaitdisc.cohort.cohort import make_walks, the_twelve
from gaitdisc.cohort.marker_trial import overground, standing
from gaitdisc.cohort.person import MUSCLES, Person
from gaitdisc.errors import SchemaError
from gaitdisc.ingest.c3d_writing import write_c3d
from gaitdisc.ingest.storage import write_storage
from gaitdisc.ingest.study import STATIC, Conditions, Models, Participant, PlannedTrial, Study
from gaitdisc.ingest.study_file import write_study
from gaitdisc.recording import Trial
from gaitdisc.whole_file import write_whole

WALK_S = 60.0
TRIALS, OVERGROUND = 6, 4.0  # trials of a condition; strides that the last of them has at least
LABORATORIES = ("angles", "markers", "overground")
FORCES = tuple(f"ground_force_{side}_v{axis}" for side in "rl" for axis in "xy")
OUTPUTS = ("hip_flexion_r", "knee_angle_r", "ankle_angle_r", *(f"{muscle}_r" for muscle in MUSCLES[:5]))
STIFF_ABOVE_DEG, STIFF_SHARE = 20.0, 0.5  # what the knee bends beyond this is halved: some 20 deg less in swing
DROP_DEG, DROP_SMOOTH_S = 15.0, 0.03  # by which the foot hangs while it is off the ground
LIFTED_N = 20.0


def write_demonstration(
    folder: Path,
    duration_s: float = WALK_S,
    people: int = 12,
    hidden: str = "spring",
    progress: Callable[[str, float], None] = lambda *_: None,
    laboratory: str = "angles",
) -> Study:
    """Let the cohort walk; write the recordings, the study file as returned, and apart from them the truth.

    duration_s: of each walk [s], the dissertation's is 240; progress: called with a pseudonym who has walked
    laboratory: `angles` of a treadmill; `markers`, two belts and a static trial; or short trials `overground`
    """
    if laboratory not in LABORATORIES:
        raise SchemaError(f"the data must be {' or '.join(LABORATORIES)}", f"found {laboratory!r}", "Use one of these.")
    participants, markers = [], laboratory != "angles"
    for person in the_twelve()[:people]:
        walks = make_walks(person, duration_s, hidden, markers)
        write = write_marker_trial if markers else write_trial
        belt = None if laboratory == "overground" else person.speed_m_per_s
        planned = tuple(
            PlannedTrial(
                condition=word, files=write(trial, folder, f"raw/{person.name}/{trial.name}"), speed_m_per_s=belt
            )
            for word, walk in walks.trials.items()
            for trial in (_over_ground(walk, person, word) if belt is None else [replace(walk, name=word)])
        )
        if markers:
            files = write_marker_trial(standing(person), folder, f"raw/{person.name}/static")
            planned = (PlannedTrial(condition=STATIC, files=files), *planned)
        participants.append(
            Participant(id=person.name, mass_kg=round(person.mass_kg, 1) if markers else None, trials=planned)
        )
        write_whole(folder / "truth" / f"{person.name}.json", json.dumps(walks.truth, indent=1))
        progress(person.name, 1.0)
    study = Study(
        title=f"Demonstration: {people} simulated participants (embedded cohort); hidden effect: {hidden}",
        conditions=Conditions(nominal="nominal", device="exo"),
        channels={} if markers else {name: f"{name} [N]" for name in FORCES},
        models=Models(emg=tuple(f"{muscle}_{side}" for side in "rl" for muscle in MUSCLES), outputs=OUTPUTS),
        participants=tuple(participants),
    ).placed(folder)
    write_study(study, folder / "study.toml")
    return study


def _over_ground(walk: Trial, person: Person, word: str) -> list[Trial]:
    """Short trials, evenly over a walk on belts."""
    last = float(walk.stream("markers").time[-1]) - OVERGROUND * person.stride_s
    return [
        overground(walk, start, person.stride_s, person.speed_m_per_s, f"{word}_{number}")
        for number, start in enumerate(np.linspace(2.0, last, TRIALS), 1)
    ]


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


def plant(trial: Trial, what: str, side: str) -> Trial:
    """Walk with gait planted on one side: `stiff knee`, `drop foot`; as it is for an empty word."""
    if not what:
        return trial
    kinematics, forces = trial.stream("kinematics"), trial.stream("forces")
    name = {"stiff knee": f"knee_angle_{side}", "drop foot": f"ankle_angle_{side}"}[what]
    angle = kinematics[name]
    if what == "stiff knee":
        angle = np.minimum(angle, STIFF_ABOVE_DEG + STIFF_SHARE * (angle - STIFF_ABOVE_DEG))
    else:  # the foot hangs while it is off the ground
        lifted = (forces[f"ground_force_{side}_vy"] < LIFTED_N).astype(float)
        hanging = gaussian_filter1d(lifted, DROP_SMOOTH_S * forces.rate_hz)
        angle = angle - DROP_DEG * np.interp(kinematics.time, forces.time, hanging)
    values = np.array(kinematics.values)
    values[:, kinematics.index(name)] = angle
    return replace(trial, streams={**trial.streams, "kinematics": kinematics.with_values(values)})
