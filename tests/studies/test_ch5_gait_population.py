import importlib
from pathlib import Path

import pandas as pd
import pytest
from texts import says

STUDIES = Path(__file__).parents[2] / "studies"


@pytest.fixture
def study(monkeypatch):
    monkeypatch.syspath_prepend(STUDIES)
    return importlib.import_module("ch5_gait_population")


def test_what_calibration_brings_is_said_in_degrees_and_percent(study):
    table = pd.DataFrame(
        {"sensors": "3 sagittal", "model": ["shred", "shred, calibrated"], "rmse_deg": [4.0, 1.0], "participant": "W01"}
    )
    [said] = study.calibration_sentences(table)
    assert says(said, "3 sagittal", "shred", "4.00 to 1.00 deg", "-75 %")


@pytest.mark.slow
def test_ten_strides_of_a_new_person_halve_the_error(study, tmp_path):
    rmse = study.run(quick=True, folder=tmp_path).table.groupby(["sensors", "model"])["rmse_deg"].mean()
    assert rmse["3 sagittal", "delay ridge, calibrated"] < 0.5 * rmse["3 sagittal", "delay ridge"]
