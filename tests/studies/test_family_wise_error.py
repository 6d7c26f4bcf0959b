import importlib

import pytest


@pytest.fixture(scope="module")
def study():
    return importlib.import_module("family_wise_error")


def test_every_sum_has_its_p(study):
    found = study.p_of_sums(11)
    assert len(found) == 34
    assert found[[0, 3, 10]].round(5).tolist() == [0.00098, 0.00488, 0.04199]
    assert found[-1] == 1


@pytest.mark.parametrize("correlation", [0.0, 0.8])
def test_a_family_raises_no_more_false_alarms_than_it_may(study, correlation):
    studies = 2000
    found = study.false_alarms(11, 8, correlation, studies)
    assert found["one pair"] <= 0.05 + 3 * (0.05 * 0.95 / studies) ** 0.5
    assert found["all"] <= 0.05 + 3 * (0.05 * 0.95 / studies) ** 0.5
    assert found["one pair"] <= found["pair"] <= 3 * 0.05 + 0.02  # three families have three chances


def test_a_family_is_not_needlessly_strict(study):
    assert study.false_alarms(11, 8, 0.0, 2000)["one pair"] > 0.03
