"""A small study on disk: two people, short walks, angles only, fast to fit."""

from __future__ import annotations

from dataclasses import replace

import pytest
from driven_walker import DrivenWalker

from gaitdisc.ingest.storage import write_storage
from gaitdisc.ingest.study import Conditions, Models, Participant, PlannedTrial, Study

ANGLES = ("hip_flexion_r", "knee_angle_r", "ankle_angle_r", "hip_flexion_l", "knee_angle_l")


@pytest.fixture(scope="session")
def recordings(tmp_path_factory):
    folder = tmp_path_factory.mktemp("recordings")
    for number in (1, 2):
        walker = DrivenWalker(f"P0{number}", seed=number)
        for condition, spring in (("nominal", 0.0), ("exo", 250.0)):
            trial = replace(walker, spring_per_s2=spring).walked(30.0, condition)
            write_storage(trial.stream("kinematics").selected(ANGLES), folder / f"P0{number}_{condition}.mot")
    return folder


@pytest.fixture(scope="session")
def study(recordings) -> Study:
    people = tuple(
        Participant(
            id=name,
            trials=tuple(PlannedTrial(condition=word, files=(f"{name}_{word}.mot",)) for word in ("nominal", "exo")),
        )
        for name in ("P01", "P02")
    )
    return Study(
        title="two walkers",
        conditions=Conditions(nominal="nominal", device="exo"),
        models=Models(angles=ANGLES, outputs=("knee_angle_r", "ankle_angle_r")),
        participants=people,
    ).placed(recordings)


@pytest.fixture(scope="session")
def small(study) -> Study:
    """The study with as few inputs and outputs as leave something to vary."""
    return study.model_copy(
        update={"models": Models(angles=("knee_angle_r", "ankle_angle_r"), outputs=("ankle_angle_r",))}
    )
