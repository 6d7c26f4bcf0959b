"""Numbers with bounds: fitted within these, in every explanation alike; a wrong one has to leave them."""

import numpy as np
import pytest
from hidden_in_a_mass import MASS, record, with_load

from gaitdisc.discovery.candidate import Candidate
from gaitdisc.discovery.candidate_model import Part, fit_model
from gaitdisc.discovery.case import set_up_case
from gaitdisc.discovery.fitted import prior_of
from gaitdisc.discovery.noise import white_noise
from gaitdisc.simulation.simulation_file import simulation_of

NOISE = 0.013


def bounded(k=24.0, low=20.0, high=28.0):
    """The mass, its stiffness believed to lie between bounds; 24 is true."""
    return simulation_of(MASS.replace("value = 24.0", f"value = {k}\nlow = {low}\nhigh = {high}"), "bounded.toml")


@pytest.fixture(scope="module")
def measured():
    return record(with_load("0"), 3)


def _fitted(simulation, measured, parts=()):
    case = set_up_case(simulation, measured)
    shooting = case.shooting(case.segments(case.learned)).with_noise(white_noise(np.array([NOISE])))
    return fit_model(shooting, simulation, parts, case.guess.starts(shooting.segments))


def test_half_the_width_is_two_standard_deviations():
    prior = prior_of(bounded())
    assert (prior.names, prior.sd.tolist()) == (("k",), [2.0])
    assert prior.left(np.array([2.0, 20.0, 0.8])).tolist() == [2.0]
    assert prior.within(np.array([2.0, 40.0, 0.8])).tolist() == [2.0, 28.0, 0.8]


@pytest.mark.parametrize("bounds", ["", "\nlow = 20.0", "\nhigh = 28.0", "\nlow = 24.0\nhigh = 24.0"])
def test_a_number_without_two_bounds_is_exact(bounds):
    exact = simulation_of(MASS.replace("value = 24.0", f"value = 24.0{bounds}"), "exact.toml")
    assert prior_of(exact).names == ()


def test_a_number_that_is_a_little_off_is_found_within_its_bounds(measured):
    model = _fitted(bounded(k=22.5, low=19.0, high=26.0), measured)
    found = model.fit.values[model.machine.parameters.index("k")]
    error = float(np.sqrt(model.fit.covariance[0, 0]))
    assert abs(found - 24.0) < 4 * error < 0.5
    assert model.size == 0


def test_a_number_stops_at_its_bound_and_the_others_are_fitted_with_it_there(measured):
    held = _fitted(bounded(k=20.0, low=18.0, high=22.0), measured)
    at_bound = _fitted(bounded(k=22.0, low=21.999, high=22.0), measured)
    assert held.fit.values[1] == pytest.approx(22.0)
    assert held.fit.misfit == pytest.approx(at_bound.fit.misfit, rel=0.01)


def test_only_a_wrong_parameter_leaves_its_bounds(measured):
    wrong = Candidate("wrong_parameter", "parameter", "k", "wrong_parameter", value=20.0, bounds=(18.0, 22.0))
    model = _fitted(bounded(k=20.0, low=18.0, high=22.0), measured, (Part(wrong, {"value": 20.0}),))
    assert model.parts[0].values["value"] == pytest.approx(24.0, abs=0.3)
    assert model.fit.prior.names == ()
    assert model.size == 1


def test_few_data_leave_a_number_where_the_file_has_it(measured):
    case = set_up_case(bounded(k=22.0, low=21.9, high=22.1), measured)
    shooting = case.shooting(case.segments((0,))).with_noise(white_noise(np.array([50.0])))
    model = fit_model(shooting, case.search.base, (), case.guess.starts(shooting.segments))
    assert model.fit.values[1] == pytest.approx(22.0, abs=1e-3)
    assert np.sqrt(model.fit.covariance[0, 0]) == pytest.approx(0.05, rel=0.01)
