"""The embedded cohort walks as people do, in the numbers that the table in studies/results/cohort.md prints."""

from __future__ import annotations

import importlib

import numpy as np
import pytest


@pytest.fixture(scope="module")
def study():
    return importlib.import_module("cohort_norms")


def test_the_table_prints_and_its_numbers_are_those_of_walking(study, capsys):
    found = study.run(quick=True)
    printed = capsys.readouterr().out
    assert all(name in printed for name in study.SOURCES)
    assert all(f"| {name} |" in printed for name in study.BURSTS)
    ranges = {
        "knee flexion, swing peak [deg]": (50, 68),
        "ankle dorsiflexion, peak [deg]": (7, 16),
        "hip flexion moment [N m/kg]": (0.4, 1.0),  # 0.62 +- 0.20 in children, 0.9 +- 0.2 in fast ones
        "knee extension moment [N m/kg]": (0.2, 0.8),
        "ankle plantarflexion moment [N m/kg]": (1.1, 1.7),
        "stance [% stride]": (56, 63),
        "vertical force, first peak [BW]": (1.0, 1.3),
    }
    [sole] = [name for name in found if name.startswith("sole over belt speed")]
    ranges[sole] = (0.95, 1.05)
    for name, (low, high) in ranges.items():
        assert np.all((found[name] > low) & (found[name] < high)), (name, found[name])


def test_a_burst_that_goes_over_the_contact_is_read_as_one(study):
    curve = np.zeros(101)
    curve[90:], curve[:11] = 1.0, 1.0
    assert study.burst(curve) == "90-10"
