import importlib

import numpy as np
import pytest


@pytest.fixture(scope="module")
def pooled_cycles():
    return importlib.import_module("pooled_cycles")


def test_events_of_one_person_found_without_the_file_s_own(pooled_cycles, gait_data):
    study = pooled_cycles.study_of(gait_data, quick=True)
    whole, _ = pooled_cycles.pooled(study)
    assert [count for what, count in pooled_cycles.counts(whole) if "each foot" in what] == ["2 of 2"]
    found, trials = pooled_cycles.pooled(study, withhold=True)
    assert all("markers" in one.detectors for one in found)
    for kind, most in (("contacts", 50), ("foot offs", 40)):
        apart = pooled_cycles.differences_ms(found, trials, kind)
        assert len(apart) >= 6 and np.percentile(np.abs(apart), 95) <= most
    assert len(pooled_cycles.against_events(found, trials)) == 4
