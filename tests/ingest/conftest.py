"""C3D files written for the tests with ezc3d."""

import textwrap
from pathlib import Path

import numpy as np
import pytest

from gaitdisc.errors import GaitdiscError
from gaitdisc.ingest import reader_process
from gaitdisc.ingest.c3d import C3DReader
from gaitdisc.ingest.new_study import _describe_trial
from gaitdisc.ingest.reading import read_trial


@pytest.fixture
def playing(monkeypatch, tmp_path):
    """Return what puts a script in the place of the process that reads files, once it was asked for one."""

    def play(script: str) -> None:
        worker = tmp_path / "worker.py"
        worker.write_text("import sys, time, os, signal\nline = sys.stdin.readline()\n" + textwrap.dedent(script))
        monkeypatch.setattr(reader_process, "WORKER", worker)

    return play


def _written(path: Path, points=None, analog=None, parameters=None, first_frame: int = 1) -> Path:
    """Points (3, point, frame), analog (channel, sample), parameters {(group, name): value}; 100 and 1000 Hz, mm, V."""
    import ezc3d

    file = ezc3d.c3d()
    count = 0 if points is None else points.shape[1]
    channels = 0 if analog is None else len(analog)
    settings = {
        ("POINT", "UNITS"): ["mm"],
        ("POINT", "RATE"): [100.0],
        ("POINT", "LABELS"): [f"M{number}" for number in range(1, count + 1)],
    }
    if channels:
        settings[("ANALOG", "RATE")] = [1000.0]
        settings[("ANALOG", "LABELS")] = [f"A{number}" for number in range(1, channels + 1)]
        settings[("ANALOG", "UNITS")] = ["V"] * channels
    for (group, name), value in (settings | (parameters or {})).items():
        file.add_parameter(group, name, value)
    if points is not None:
        file["data"]["points"] = np.concatenate([points, np.ones((1, *points.shape[1:]))])
    if analog is not None:
        file["data"]["analogs"] = analog[None]
    if first_frame != 1:
        file["header"]["points"]["first_frame"] = first_frame - 1
    file.write(str(path))
    return path


@pytest.fixture(scope="session")
def write_c3d():
    return _written


@pytest.fixture(scope="session")
def reader():
    with C3DReader() as one:
        yield one


@pytest.fixture
def some_points():
    """Three markers within a laboratory, (3, 3, 50) [mm]."""
    return np.random.default_rng(1).normal(900, 300, (3, 3, 50))


@pytest.fixture
def some_analog():
    """Four channels, (4, 500) [V]."""
    return np.random.default_rng(2).normal(0, 1e-3, (4, 500))


@pytest.fixture(scope="session")
def real_files(gait_data, reader):
    """Every real recording: path, names of its channels, findings, how a draft describes it; or path, the refusal."""
    found = []
    for path in sorted(gait_data.parent.rglob("*")):
        if path.suffix in (".mot", ".sto", ".trc", ".c3d"):
            try:
                trial = read_trial(path, reader=reader)
            except GaitdiscError as error:
                found.append((path, type(error)))
                continue
            names = {name for recording in trial.streams.values() for name in recording.names}
            found.append((path, names, trial.findings, _describe_trial((Path("P01/a.c3d"),), trial)))
    return found


@pytest.fixture(scope="session")
def real_trials(real_files):
    """Of those that can be read."""
    return [one[:3] for one in real_files if len(one) > 2]
