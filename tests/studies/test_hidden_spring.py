import importlib
from pathlib import Path

import numpy as np
import pytest
from scipy.signal import lsim

from gaitdisc.simulation.measured_table import read_measured
from gaitdisc.simulation.simulation_file import read_simulation
from gaitdisc.simulation.unit_check import unit_findings

STUDIES = Path(__file__).parents[2] / "studies"


@pytest.fixture(scope="module")
def read(tmp_path_factory):
    with pytest.MonkeyPatch.context() as patch:
        patch.syspath_prepend(str(STUDIES))
        study = importlib.import_module("hidden_spring")
        simulation, table = study.run(tmp_path_factory.mktemp("spring"))
    model = read_simulation(simulation)
    return model, read_measured(table, model)


def test_the_two_files_are_read_as_they_were_meant(read):
    model, measured = read
    assert (measured.trials, measured.channels, measured.rate) == (tuple("12345678"), ("theta",), 100.0)
    assert all(abs(count - 300) <= 1 for count in measured.drive.samples)
    assert 5.0 < np.degrees(np.nanmax(measured.observed)) < 20.0
    assert not model.effects
    assert unit_findings(model) == ()  # so that the README's `gaitdisc discover` prints no warning
    assert 1.0 < model.values()["foot_mass"] < 3.0


def test_an_ankle_that_nothing_acts_on_does_not_follow_its_record(read):
    """Else gains near 0 on every moment would explain any device better than the device does."""
    model, measured = read
    drive, mass = dict(zip((one.name for one in model.inputs), measured.drive.inputs[0].T, strict=True)), model.values()
    acting = drive["plantarflexors"] + drive["others"] - mass["foot_mass"] * drive["per_kg"]
    time, seen = np.arange(len(acting)) / measured.rate, measured.observed[0, :, 0]
    tracked = ([1.0], [1.0, 57.0, 800.0])
    off = [lsim(tracked, drive["recorded"] + share * acting, time)[1] - seen for share in (0.0, 0.3, 1.0)]
    nothing, third, all_of_it = (np.sqrt(np.nanmean(one[50:] ** 2)) for one in off)
    assert nothing > third > all_of_it  # though the spring is missing in all three
