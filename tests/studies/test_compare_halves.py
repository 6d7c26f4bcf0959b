import importlib

import pytest


def study(name):
    return importlib.import_module(name)


@pytest.mark.slow
def test_a_planted_shift_is_found_and_nothing_is_named(gait_data):
    found = study("compare_halves").run(gait_data, quick=True)
    percent = {(one.walk, one.shift): one.mismatch.alignment.percent for one in found}
    walks = {walk for walk, _ in percent}
    assert len(walks) == 3 and len(percent) == 6
    assert [percent[walk, 7] - percent[walk, 0] for walk in walks] == pytest.approx([-7.0] * 3, abs=0.4)
    assert [one.mismatch.ordered() for one in found] == [[]] * 6
