import importlib

import numpy as np
import pytest


@pytest.fixture(scope="module")
def study():
    return importlib.import_module("knee_with_memory")


def test_what_is_hidden_changes_the_leg_s_motion_and_nothing_hides_nothing(study):
    for kind in study.KINDS:
        truth, _ = study.hidden(kind, np.random.default_rng(1))
        plain, _ = study.hidden("nothing", np.random.default_rng(1))
        sensed = study.Sensed(0.0, channels=("hip", "knee"))
        both = (study.recorded(leg, study.DRIVEN, sensed, np.random.default_rng(2)) for leg in (truth, plain))
        one, other = (table.to_numpy() for table in both)
        assert (np.abs(one - other).max() < 1e-9) == (kind == "nothing")


@pytest.mark.slow
def test_each_is_named_where_it_is_hidden(study):
    lines = study.run(1, 0.02)
    assert len(lines) == len(study.KINDS)
    assert all("named in 1 of 1" in line for line in lines), lines
