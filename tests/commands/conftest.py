"""A study with one participant, and the recordings that it is of."""

import re

import pytest
from driven_walker import DrivenWalker

from gaitdisc.ingest.storage import write_storage

ANGLES = ("hip_flexion_r", "knee_angle_r", "ankle_angle_r", "hip_flexion_l", "knee_angle_l")


@pytest.fixture(autouse=True)
def whatever_was_learnt(trained_briefly):
    """No test of a command looks at how good a network is."""


@pytest.fixture(scope="session")
def recordings(tmp_path_factory):
    folder = tmp_path_factory.mktemp("lab")
    for condition, spring in (("natural", 0.0), ("exo", 250.0)):
        walker = DrivenWalker("A", seed=8, spring_per_s2=spring)
        path = folder / "walker1" / f"{condition}.mot"
        path.parent.mkdir(exist_ok=True)
        write_storage(walker.walked(30.0, condition).stream("kinematics").selected(ANGLES), path)
    return folder


@pytest.fixture(scope="session")
def study(recordings, tmp_path_factory, called):
    folder = tmp_path_factory.mktemp("study") / "study"
    called("new", folder, "--from", recordings, ends=0)
    file = folder / "study.toml"
    few, text = '"knee_angle_r", "ankle_angle_r"', file.read_text(encoding="utf-8")
    for key in ("angles", "outputs"):  # as few as leave something to vary
        text = re.sub(rf"(?s)(?<=\n{key} = \[).*?(?=\])", few, text)
    file.write_text(text, encoding="utf-8")
    return folder
