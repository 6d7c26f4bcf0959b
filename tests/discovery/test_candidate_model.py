import numpy as np
import pytest
from hidden_in_a_mass import mass

from gaitdisc.discovery.candidate import Candidate
from gaitdisc.discovery.candidate_model import Part, fit_model, with_parts

WRONG = Candidate("wrong_parameter", "parameter", "k", "wrong_parameter", value=24.0)
DRIFT = Candidate("sensor_error", "observation", "x", "sensor_drift")


def test_parts_are_put_in_one_after_the_other_under_names_of_their_own():
    parts = (Part(WRONG, {"value": 25.0}), Part(DRIFT, {"rate": 0.1}))
    simulation, names = with_parts(mass(), parts)
    assert names == ({"value": "k"}, {"rate": "part1_rate"})
    assert dict(simulation.observations)["x"] == "(x) + part1_rate*t"


def test_the_true_explanation_is_fitted_to_its_true_number(case, as_read, cubic):
    part = Part(cubic, {"factor": 0.0})
    model = fit_model(as_read.shooting, case.search.base, (part,), as_read.model.fit.starts)
    error = float(np.sqrt(model.fit.covariance[0, 0]))
    assert model.parts[0].values["factor"] == pytest.approx(-14.0, abs=max(4 * error, 0.1))
    assert model.names == ({"factor": "part0_factor"},)
    assert model.fit.misfit < as_read.model.fit.misfit


def test_a_number_more_costs_the_logarithm_of_what_was_measured(case, as_read, cubic):
    model = fit_model(as_read.shooting, case.search.base, (Part(cubic, {"factor": 0.0}),), as_read.model.fit.starts)
    assert model.size == 1
    assert model.bic - model.fit.misfit == pytest.approx(np.log(model.fit.white.size))


def test_without_explanations_only_the_starts_are_fitted(as_read):
    assert as_read.model.size == 0
    assert as_read.model.bic == as_read.model.fit.misfit
