import importlib
from pathlib import Path

import numpy as np
import pytest

STUDIES = Path(__file__).parents[2] / "studies"


@pytest.fixture
def study(monkeypatch):
    monkeypatch.syspath_prepend(STUDIES)
    return importlib.import_module("ch5_turbulence")


@pytest.mark.slow
def test_one_sensor_does_not_tell_a_turbulent_flow_ahead_of_time(study, tmp_path):
    result = study.run(quick=True, folder=tmp_path, models=3)
    r2 = {
        split: np.median([c.r2 for c in result.cells if (c.split, c.model) == (split, "delay ridge")])
        for split in study.SPLITS
    }
    assert r2["temporal"] < r2[study.RANDOM] < 0.9
    ceiling = {c.split: c.r2 for c in result.cells if c.model == study.CEILING}
    assert ceiling[study.RANDOM] > 0.95
    assert ceiling["temporal"] > r2["temporal"]
    assert (tmp_path / "figures" / "boxes.png").exists()
