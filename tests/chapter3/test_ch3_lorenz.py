import importlib
from pathlib import Path

import pytest

STUDIES = Path(__file__).parents[2] / "studies"


@pytest.fixture
def study(monkeypatch):
    monkeypatch.syspath_prepend(STUDIES)
    return importlib.import_module("ch3_lorenz")


def test_the_hidden_term_is_in_the_first_equation(study):
    system = study.system()
    x = system.start[None]
    assert (system.true(x) - system.known(x)).round(9).tolist() == [[-5.12, 0.0, 0.0]]


@pytest.mark.slow
def test_no_learned_rate_loses_before_the_first_jump_but_that_of_dmd(study, tmp_path):
    cells = study.run(quick=True, folder=tmp_path).cells["done right"]
    for cell in cells:
        if cell.approach == "dynamics" and cell.method not in ("dmd", "bopdmd"):
            part = cell.parts["oracle forecast"]
            assert part.accuracy(until_s=part.first_jump_s()).min() > 80
