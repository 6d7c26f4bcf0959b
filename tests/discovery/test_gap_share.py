import numpy as np
import pytest

from gaitdisc.discovery.candidate_model import Part
from gaitdisc.discovery.criteria import CRITERIA
from gaitdisc.discovery.gap_share import GapScale, cross_validated


@pytest.fixture(scope="module")
def scale(case):
    return case.scale


def test_the_scale_is_noise_and_a_hundredth_of_the_spread():
    scale = GapScale(np.array([0.03, 0.0]), np.array([4.0, 1.0]))
    assert scale.size == pytest.approx([0.05, CRITERIA.model_error])
    assert scale.floor == pytest.approx((0.36 + 0.0) / 2)
    assert scale.least == pytest.approx((0.64 + 1.0) / 2)


def test_the_true_explanation_closes_the_gap_and_a_wrong_one_does_not(case, as_read, cubic, scale):
    shooting, base = as_read.shooting, case.search.base
    before = cross_validated(scale, shooting, base, (), as_read.model)
    after = cross_validated(scale, shooting, base, (Part(cubic, {"factor": -10.0}),), before.model)
    assert after.model.parts[0].values["factor"] == pytest.approx(-14.0, rel=0.05)
    assert after.gap < 0.15 * before.gap
    load = next(one for one in case.search.candidates if one.label == "constant_load@load")
    wrong = cross_validated(scale, shooting, base, (Part(load, {"factor": 0.0}),), before.model)
    assert wrong.gap > 0.8 * before.gap


def test_what_was_not_fitted_leaves_the_sensors_noise(case, as_read, cubic, scale):
    found = cross_validated(scale, as_read.shooting, case.search.base, (Part(cubic, {"factor": -14.0}),), as_read.model)
    assert found.errors.mean() == pytest.approx(scale.floor, rel=0.15)
    assert found.model.explanations == {("cubic_stiffness@load", ("x**3",))}
    assert found.model.penalty == pytest.approx(0.03)
