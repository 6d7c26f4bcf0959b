"""A small study on disk: two people, short walks, angles only, fast to fit."""

from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from driven_walker import DrivenWalker

from gaitdisc.discovery.tracked_pass import Pass
from gaitdisc.engines.motion import Coordinate, TrackedMotion
from gaitdisc.ingest.storage import write_storage
from gaitdisc.ingest.study import Conditions, Models, Participant, PlannedTrial, Study
from gaitdisc.simulation.parts import Parameter

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


class Leg:
    """Two segments of which every moment is known, where OpenSim would stand: a mass, a knee and an ankle."""

    mass_kg, vertical, base, called, path = 70.0, 0, (0,), "a leg", Path("leg.osim")
    parameters = (
        Parameter("foot_mass", 1.2, "kg"),
        Parameter("toes_mass", 0.2, "kg"),
        Parameter("trunk_mass", 40.0, "kg"),
    )
    controls, offered = (), ()
    coordinates = tuple(
        Coordinate(name, unit, name) for name, unit in (("pelvis_ty", "m"), ("knee", "rad"), ("ankle", "rad"))
    )
    inertia = np.array([mass_kg, 1.0, 0.4])

    def __init__(self, pulls, carried=1.0):
        self.pulls, self.carried = pulls, carried  # (sample, coordinate) [N m]; share of the weight under the foot

    def demanded(self, motion, loaded=True, values=None):
        moments = self.inertia * motion.a + self.pulls
        for one in self.parameters:
            more = (values or {}).get(one.name, one.value) - one.value
            moments[:, 0] += 9.81 * more
            if one.name != "trunk_mass":
                moments[:, 1:] += more * ([0.3, 0.1] * motion.a[:, 1:] + 9.81 * np.sin(motion.q[:, 1:]) * [0.4, 0.2])
        moments[:, 0] += self.mass_kg * 9.81 * (1 - self.carried * loaded)
        return moments


@pytest.fixture
def leg_walk():
    """Return a maker of walks of the leg: two seconds at 60 Hz, whose muscles give all that the motion demands."""

    def made(carried=1.0) -> Pass:
        time = np.arange(0, 2, 1 / 60)
        phase = 2 * np.pi * 0.9 * time
        q = np.column_stack([1 + 0 * time, 0.5 + 0.4 * np.sin(phase), 0.2 * np.sin(phase) + 0.08 * np.sin(2 * phase)])
        v, a = (np.gradient(q, time, axis=0), np.gradient(np.gradient(q, time, axis=0), time, axis=0))
        muscles = np.column_stack([0 * time, 40 * np.sin(phase + 1) ** 2, -60 * np.clip(np.sin(phase), 0, None) ** 2])
        engine = Leg(muscles, carried)
        motion = TrackedMotion(time, q, v, a, ("quads", "calf"), np.ones((len(time), 2)), True)
        demanded = engine.demanded(motion)
        pulls = np.zeros((len(time), 2, 3))
        pulls[:, 0, 1], pulls[:, 1, 2] = demanded[:, 1], demanded[:, 2]
        groups = {"knee_raising_muscles": muscles[:, 1], "ankle_lowering_muscles": muscles[:, 2]}
        return Pass(engine, motion, 6.0, demanded, pulls, groups)  # pyright: ignore[reportArgumentType]

    return made
