"""One saved folder of each kind, as the program of one day wrote it: tests/data/saved, and what its pages said.

    python tests/saved_folders.py FOLDER [KIND ...]      # writes them anew, below FOLDER

The folders in the tree were written by the version that their provenance names; they are not written anew when the
program changes, for they are what people have. `engine` needs MuJoCo, `tracked` OpenSim and the recorded walk of
../shared/data. Networks take two passes: what they learn is of no interest here.
"""

import os
import re
import shutil
import subprocess
import sys
import tempfile
from collections.abc import Callable
from pathlib import Path
from unittest.mock import patch

import numpy as np
import pandas as pd

from gaitdisc.cli import app
from gaitdisc.cohort.demonstration import write_demonstration

PROJECT = Path(__file__).parents[1]
DATA = Path(os.environ.get("GAITDISC_DATA", PROJECT.parent / "shared" / "data"))
FEW = {"angles": '"knee_angle_r", "ankle_angle_r"', "outputs": '"knee_angle_r", "ankle_angle_r"', "emg": '"emg_sol_r"'}
PENDULUM = """<mujoco model="pendulum"><option timestep="0.001"/><worldbody><body name="rod">
<joint name="pivot" type="hinge" axis="0 -1 0" damping="0.3"/>
<inertial pos="0 0 -0.4" mass="2" diaginertia="0.05 0.05 0.001"/></body></worldbody>
<actuator><motor name="drive" joint="pivot" gear="5"/></actuator></mujoco>
"""
SPRING = '<tendon><fixed stiffness="20" springlength="-1000 0.1"><joint joint="pivot" coef="1"/></fixed></tendon>'
TRACKED = """model = "subject01_metabolics.osim"
[tracked]
external_loads = "data/ExperimentalData/subject01_walk_grf.xml"
actuators = "data/gait10dof_Reserve_Actuators.xml"
forces = "data/CMC/results_spring/walk_subject_Actuation_force.sto"
speeds = "data/CMC/results_spring/walk_subject_Kinematics_u.sto"
accelerations = "data/CMC/results_spring/walk_subject_Kinematics_dudt.sto"
"""


def call(*words: object) -> None:
    """Run a command of gaitdisc in this process."""
    with patch("gaitdisc.models.training_settings.count_epochs", lambda *_: 2):
        app([str(word) for word in words], standalone_mode=False)


def write_study(laboratory: str = "angles", people: int = 1) -> None:
    """People who walk 30 s without and with a spring, in two trials each over ground, and a study of few channels."""
    with patch("gaitdisc.cohort.demonstration.TRIALS", 2):
        write_demonstration(Path("small"), 30.0, people, laboratory=laboratory)
    file = Path("small/study.toml")
    text = file.read_text(encoding="utf-8")
    for key, names in FEW.items():
        text = re.sub(rf"(?s)(?<=\n{key} = \[).*?(?=\])", names, text)
    file.write_text(text, encoding="utf-8")


def write_run() -> None:
    """A response run of two people, with the questions that were asked of it."""
    write_study(people=2)
    for command in ("run", "modalities", "sensitivity"):
        call(command, "small", "--out", "run", "--jobs", "1", "-q")


def write_cycles() -> None:
    """A clinic's run of pooled cycles beside a reference; one person's cycles alone are in it."""
    write_study("overground")
    call("reference", "small", "--out", "reference")
    call("run", "small", "--out", "run", "--reference", "reference", "--jobs", "1", "-q")


def write_comparison() -> None:
    """Two walks of a person, by strides."""
    write_study()
    call("compare", "small", "--participant", "W01", "--out", "compared")


def write_reconstruction() -> None:
    """Angles from one sensor, and a saved model a person."""
    write_study()
    call("reconstruct", "small", "-s", "knee_angle_r", "--condition", "nominal", "--out", "found", "-q")


def write_discovery() -> None:
    """A simulation file held against a table."""
    subprocess.run([sys.executable, PROJECT / "studies/hidden_spring.py", "."], check=True)
    call("discover", "ankle.toml", "walk.csv", "--out", "found", "-q")


def write_motion() -> None:
    """What a device does to a person, of motion alone."""
    write_study()
    call("discover", "small/study.toml", "--participant", "W01", "--out", "found", "-q")


def write_device() -> None:
    """What a device does to a person, in moments."""
    write_study("markers")
    call("discover", "small/study.toml", "--participant", "W01", "--out", "found", "-q")


def pendulum_trials(
    truth: Path, seed: int, drive: Callable, rate: float = 100.0, start: float = 0.2, noise_deg: float = 0.2
) -> pd.DataFrame:
    """Four trials of a pendulum in degrees; drive takes a generator of random numbers and the times."""
    from gaitdisc.engines.engine import read_model
    from gaitdisc.engines.motion import Motion

    model, rng, t, rest = read_model(truth), np.random.default_rng(seed), np.arange(300) / rate, np.zeros((1, 1))
    tables = []
    for trial in range(1, 5):
        driven = drive(rng, t)
        run = model.run(Motion(rng.uniform(-start, start, (1, 1)), rest, rest), driven[None, :, None], rate)
        pivot = np.rad2deg(run[0, :, 0]) + noise_deg * rng.normal(size=len(t))
        tables.append(pd.DataFrame({"trial": trial, "time": t, "drive": driven, "pivot": pivot}))
    return pd.concat(tables)


def write_engine() -> None:
    """A model of MuJoCo held against a table."""
    Path("pendulum.xml").write_text(PENDULUM)
    Path("truth.xml").write_text(PENDULUM.replace("</mujoco>", f"{SPRING}</mujoco>"))
    trials = pendulum_trials(
        Path("truth.xml"), 3, lambda rng, t: 0.35 * np.sin(2 * np.pi * rng.uniform(0.5, 1.2) * t + rng.uniform(0, 6))
    )
    trials.to_csv("trials.csv", index=False)
    call("new", "pendulum.toml", "--from", "pendulum.xml", "--degrees")
    call("discover", "pendulum.xml", "trials.csv", "--out", "found", "-q")


def write_tracked() -> None:
    """A walk with recorded forces, of which the spring is missing in the model."""
    Path("data").symlink_to(DATA / "opensim_gait10dof")
    shutil.copy("data/CMC/subject01_metabolics.osim", ".")
    Path("subject01_metabolics.toml").write_text(TRACKED)
    motion = "data/CMC/results_spring/walk_subject_Kinematics_q.sto"
    call("discover", "subject01_metabolics.osim", motion, "--out", "found", "-q")


KINDS: dict[str, tuple[Callable[[], None], str]] = {  # what writes it, and the folder that is kept
    "run": (write_run, "run"),
    "cycles": (write_cycles, "run"),
    "mismatch": (write_comparison, "compared"),
    "reconstruction": (write_reconstruction, "found"),
    "discovery": (write_discovery, "found"),
    "device": (write_device, "found"),
    "motion": (write_motion, "found"),
    "engine": (write_engine, "found"),
    "tracked": (write_tracked, "found"),
}


def write_kind(kind: str, place: Path) -> None:
    """Write one kind in an empty folder, and keep it without what is drawn of it."""
    write, kept = KINDS[kind]
    before = Path.cwd()
    with tempfile.TemporaryDirectory() as folder:
        os.chdir(folder)
        try:
            write()
        finally:
            os.chdir(before)
        shutil.rmtree(place / kind, ignore_errors=True)
        drawn = shutil.ignore_patterns("report", "report.html", "figures", "tables")
        shutil.copytree(Path(folder) / kept, place / kind, ignore=drawn)


if __name__ == "__main__":
    target = Path(sys.argv[1]).resolve()
    for name in sys.argv[2:] or KINDS:
        write_kind(name, target)
