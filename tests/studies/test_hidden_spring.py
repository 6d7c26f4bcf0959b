import importlib
from pathlib import Path

import numpy as np

from gaitdisc.simulation.measured_table import read_measured
from gaitdisc.simulation.simulation_file import read_simulation
from gaitdisc.simulation.unit_check import unit_findings

STUDIES = Path(__file__).parents[2] / "studies"


def test_the_two_files_are_read_as_they_were_meant(tmp_path, monkeypatch):
    monkeypatch.syspath_prepend(str(STUDIES))
    study = importlib.import_module("hidden_spring")
    simulation, table = study.run(tmp_path)
    model = read_simulation(simulation)
    measured = read_measured(table, model)
    assert (measured.trials, measured.channels, measured.rate) == (tuple("12345678"), ("theta",), 100.0)
    assert all(abs(count - 300) <= 1 for count in measured.drive.samples)
    assert 5.0 < np.degrees(np.nanmax(measured.observed)) < 20.0
    assert not model.effects
    assert unit_findings(model) == ()  # so that the README's `gaitdisc discover` prints no warning
    assert 1.0 < model.values()["foot_mass"] < 3.0
