import importlib
from pathlib import Path

import pytest

STUDIES = Path(__file__).parents[2] / "studies"


@pytest.fixture
def study(monkeypatch):
    monkeypatch.syspath_prepend(STUDIES)
    return importlib.import_module("ch5_gait_individual")


def test_the_table_of_the_dissertation_is_that_of_the_text(study):
    rows = study.gait.printed("individual").set_index(["sensors", "model"])["mean"]
    assert len(rows) == 4 * 3
    assert rows["3 sagittal", "shred"] == 0.064 and rows["1 random", "linear"] == 1.096


def test_the_runners_and_the_treadmill_walks_are_found(study, gait_data, tmp_path):
    found = study.gait.exotendon(gait_data)
    assert [len(person.trials) for person in found.participants] == [2, 1]
    assert len(study.gait.treadmill(gait_data, tmp_path).participants[0].trials) == 12


@pytest.mark.slow
def test_history_divides_the_error_and_windows_drawn_at_random_hide_it(study, tmp_path):
    result = study.run(quick=True, folder=tmp_path)
    rmse = result.table[result.table["sensors"] == "3 sagittal"].set_index("model")["rmse_deg"]
    assert rmse["delay ridge"] < 0.35 * rmse["linear"]
    text = result.page.read_text(encoding="utf-8")
    assert "random (leaks)" in text and "the norm of the error" in text
