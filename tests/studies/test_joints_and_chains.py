import importlib

import numpy as np
import pytest


@pytest.fixture(scope="module")
def study():
    return importlib.import_module("joints_and_chains")


def test_what_is_hidden_changes_every_system_s_motion(study):
    for hidden in study.KNOWN.values():
        model = study.model_of(hidden)
        truth = study.complete(model, hidden, np.random.default_rng(1))
        driven, plain = study.Driven(tuple(hidden.driven_by), 0.2, hidden.fastest_hz), study.Sensed(0.0)
        one, other = (study.recorded(of, driven, plain, np.random.default_rng(2)) for of in (model, truth))
        channels = [name for name, _ in model.observations]
        one, other = (table[channels].to_numpy() for table in (one, other))
        assert np.isfinite(other).all()
        assert np.abs(one - other).max() > 0.05 * one.std(), hidden.model


def test_numbers_put_off_hold_the_true_ones_within_their_bounds(study):
    model = study.model_of(study.KNOWN["elbow"])
    off = study.put_off(model, 0.05, np.random.default_rng(3))
    for one, true in zip(off.parameters, model.parameters, strict=True):
        assert one.low < true.value < one.high
        assert one.value != true.value


@pytest.mark.slow
@pytest.mark.parametrize(
    "name",
    [
        "leg",
        "exo ankle",
        "elbow",
        "standing",
        "chain",
    ],
)
def test_each_is_named_and_nothing_is_invented(study, name):
    lines = study.run([name], 1, study.Record(0.02, 0.05, 6.0))
    assert all(": 1 of 1" in line for line in lines), lines
