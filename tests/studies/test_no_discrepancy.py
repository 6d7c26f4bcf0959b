"""The study of the cohort's first law prints a difference and its error for every variable."""

from __future__ import annotations

import importlib.util
from pathlib import Path

import numpy as np
import pytest

STUDY = Path(__file__).parents[2] / "studies" / "no_discrepancy.py"


@pytest.fixture(scope="module")
def study():
    spec = importlib.util.spec_from_file_location("no_discrepancy", STUDY)
    module = importlib.util.module_from_spec(spec)
    spec.loader.exec_module(module)
    return module


def test_every_variable_has_its_difference(study, capsys):
    apart = study.run(quick=True)
    printed = capsys.readouterr().out
    assert apart.shape == (2, len(study.OUTPUTS))
    assert np.all(np.abs(apart[:, :3]) < 0.1)  # angles, 5 s held out
    assert all(name in printed for name in (*study.OUTPUTS, "standard error", "2 pairs of walks"))
