import importlib
from pathlib import Path

import pytest

STUDIES = Path(__file__).parents[2] / "studies"


@pytest.fixture
def study(monkeypatch):
    monkeypatch.syspath_prepend(STUDIES)
    return importlib.import_module("ch3_report")


def test_a_statement_without_cells_is_not_answered(study):
    assert study.answered({"text": ()}, "dynamics", 0.0) == "not computed"
