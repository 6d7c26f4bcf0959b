import importlib
from pathlib import Path

import pytest
from texts import says

STUDIES = Path(__file__).parents[2] / "studies"


@pytest.fixture
def study(monkeypatch):
    monkeypatch.syspath_prepend(STUDIES)
    return importlib.import_module("ch3_burgers")


def test_the_pulse_of_the_text_cannot_run(study):
    assert says(study.text_start(study.Conditions(duration_s=2.0)), "every bound at 0 s")


@pytest.mark.slow
def test_the_quick_study_shows_both_metrics(study, tmp_path):
    result = study.run(quick=True, folder=tmp_path)
    assert "by the mean error" in result.tables[0].rows[1][2]
