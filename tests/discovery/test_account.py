import numpy as np
import pytest
from hidden_in_a_mass import mass

from gaitdisc.discovery.account import Part, account_for, with_parts
from gaitdisc.discovery.candidate import Candidate

WRONG = Candidate("wrong_parameter", "parameter", "k", "wrong_parameter", value=24.0)
DRIFT = Candidate("sensor_error", "observation", "x", "sensor_drift")


def test_parts_are_put_in_one_after_the_other_under_names_of_their_own():
    parts = (Part(WRONG, {"value": 25.0}), Part(DRIFT, {"rate": 0.1}))
    simulation, names = with_parts(mass(), parts)
    assert names == ({"value": "k"}, {"rate": "part1_rate"})
    assert dict(simulation.observations)["x"] == "(x) + part1_rate*t"


def test_the_true_explanation_is_fitted_to_its_true_number(inquiry, as_read, cubic):
    part = Part(cubic, {"factor": 0.0})
    account = account_for(as_read.shooting, inquiry.search.base, (part,), as_read.account.fit.starts)
    error = float(np.sqrt(account.fit.covariance[0, 0]))
    assert account.parts[0].values["factor"] == pytest.approx(-14.0, abs=max(4 * error, 0.1))
    assert account.names == ({"factor": "part0_factor"},)
    assert account.fit.misfit < as_read.account.fit.misfit


def test_a_number_more_costs_the_logarithm_of_what_was_measured(inquiry, as_read, cubic):
    account = account_for(
        as_read.shooting, inquiry.search.base, (Part(cubic, {"factor": 0.0}),), as_read.account.fit.starts
    )
    assert account.size == 1
    assert account.criterion - account.fit.misfit == pytest.approx(np.log(account.fit.white.size))


def test_without_explanations_only_the_starts_are_fitted(as_read):
    assert as_read.account.size == 0
    assert as_read.account.criterion == as_read.account.fit.misfit
