import importlib
from pathlib import Path

import numpy as np
import pytest
from chapter3.cell import PARTS, DiscrepancyCell, PartAccuracy
from texts import says

STUDIES = Path(__file__).parents[2] / "studies"
TIME = np.arange(301) / 10
TRUTH = np.sin(TIME)[:, None]


def cell(augmented, diverged=None, seed=0, method="gp", seconds=1.0):
    names = dict.fromkeys(PARTS, PartAccuracy(TIME, TRUTH, TRUTH + 0.2, augmented, diverged))
    return DiscrepancyCell("s", method, "dynamics", "right", 0.0, seed, ("x",), names, seconds, 0.0)


@pytest.fixture
def study(monkeypatch):
    monkeypatch.syspath_prepend(STUDIES)
    return importlib.import_module("chapter3.pages")


def test_a_statement_without_cells_is_not_answered(study):
    assert study.answered({"text": ()}, "dynamics", 0.0) == "not computed"


def test_seeds_are_median_and_range_and_one_that_diverged_is_a_time(study):
    quiet = [cell(TRUTH + off, seed=seed) for seed, off in enumerate((0.1, 0.05))]
    assert "62.5 [50.0, 75.0]" in study.answered({"text": tuple(quiet)}, "dynamics", 0.0)
    lost = cell(np.where(TIME[:, None] > 3, np.nan, TRUTH), 3.0, 1)
    said = study.answered({"text": (quiet[0], lost)}, "dynamics", 0.0)
    assert says(said, "diverged", "3.00 s", "1 of 2 seeds")
    assert "50.0" not in said


def test_captions_are_answered_with_cost_and_horizon(study):
    cells = {"text": (cell(TRUTH + 0.1, seconds=5.0), cell(TRUTH + 0.05, method="sindy"))}
    figures = {"cost": "Fig. 3.11", "horizon": "Fig. 3.9", "system": "Fig. 3.2", "noise": "Fig. 3.10"}
    said = study.blocks_of(cells, figures, ())[0].tables[0].rows
    assert [where for where, _, _ in said] == ["Fig. 3.2", "Fig. 3.9", "Fig. 3.11"]
    assert says(said[2][2], "SINDy 1.0 s", "Gaussian process 5.0 s")
    assert "Gaussian process 50/50/50/50" in said[1][2]
