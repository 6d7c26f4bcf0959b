"""The cohort's muscles against published facts: who is alike, what rests, what the spring does, what EMG explains."""

from __future__ import annotations

import importlib

import numpy as np
import pytest

MUSCLES = ("ham", "rf", "vas", "gas", "sol", "ta", "gmed")


@pytest.fixture(scope="module")
def study():
    return importlib.import_module("cohort_muscles")


def of(values, *names):
    return np.array([values[MUSCLES.index(name)] for name in names])


def test_emg_angle_and_rate_explain_the_moments(study):
    explained = study.run(quick=True)["explained"]
    assert np.all(np.median(explained, axis=0) > (0.7, 0.8, 0.9))  # hip, knee, ankle


@pytest.mark.slow
def test_the_cohorts_muscles_are_as_those_of_people(study):
    found = study.run()
    correlation, variation = study.alike(found["curves"])
    # Winter and Yack (1987): distal muscles of one joint differ least between people, proximal and two-joint ones most
    assert of(variation, "sol", "ta").mean() < of(variation, "ham", "rf", "gas", "gmed").mean()
    assert np.all((variation > 0.2) & (variation < 0.9))
    assert np.all((correlation > 0.70) & (correlation < 0.98))
    assert np.all((found["curves"].min(axis=1) / found["curves"].max(axis=1)).mean(axis=0) < 0.08)
    change = found["change"].mean(axis=0)
    assert -0.5 < of(change, "sol")[0] < of(change, "gas")[0] < -0.05  # soleus falls most
    assert of(change, "ta")[0] > 0.0
    assert np.all(np.median(found["explained"], axis=0) > (0.7, 0.8, 0.9))
