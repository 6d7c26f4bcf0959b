import importlib
from pathlib import Path

import pytest

STUDIES = Path(__file__).parents[2] / "studies"


@pytest.fixture
def study(monkeypatch):
    monkeypatch.syspath_prepend(STUDIES)
    return importlib.import_module("ch3_measurement_bias")


def test_the_unscented_filter_finds_the_gain(study):
    record = study.recorded(study.systems()["code"], study.Conditions(noise=0.001, duration_s=8.0))
    said = study.filters(record)
    assert "gain found 1.100" in said or "gain found 1.099" in said


@pytest.mark.slow
def test_every_method_removes_most_of_the_bias_without_noise(study, tmp_path):
    cells = study.run(quick=True, folder=tmp_path).cells
    assert all(
        cell.parts["reconstruction"].accuracy()[0] > 95
        for found in cells.values()
        for cell in found
        if not cell.noise and cell.method != "bopdmd"  # its mean over bags mixes modes whose eigenvalues are rounding
    )
