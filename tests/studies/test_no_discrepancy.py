"""The study of the cohort's first law prints a difference and its error for every variable."""

from __future__ import annotations

import importlib

import numpy as np
import pytest


@pytest.fixture(scope="module")
def study():
    return importlib.import_module("no_discrepancy")


def test_every_variable_has_its_difference(study, capsys):
    apart = study.run(quick=True)
    printed = capsys.readouterr().out
    assert apart.shape == (2, len(study.OUTPUTS))
    assert np.all(np.abs(apart[:, :3]) < 0.1)  # angles, 5 s held out
    assert all(name in printed for name in (*study.OUTPUTS, "standard error", "2 pairs of walks"))
