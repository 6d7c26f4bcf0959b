import numpy as np
import pytest
from hidden_in_a_mass import MASS, record, with_load
from scipy.linalg import null_space

from gaitdisc.discovery.candidate import Candidate
from gaitdisc.discovery.case import set_up_case
from gaitdisc.discovery.fitted import Fitted, find_basis, read_prior, without
from gaitdisc.discovery.noise import white_noise
from gaitdisc.discovery.scored_model import Part, fit_model
from gaitdisc.simulation.simulation_file import parse_simulation

RNG = np.random.default_rng(0)


def _fitted(white, slopes, free=("k",)):
    segments, samples = white.shape
    starts = np.zeros((segments, slopes.shape[2] - len(free)))
    return Fitted(free, np.zeros(3), starts, np.zeros((segments, samples, 2)), white[..., None], white, slopes)


def test_what_the_start_states_explain_is_projected_out():
    slopes = RNG.normal(size=(4, 30, 3))
    white = (slopes[..., :2] @ RNG.normal(size=(4, 2, 1)))[..., 0]
    left, constants = _fitted(white, slopes).projected
    np.testing.assert_allclose(left, 0.0, atol=1e-12)
    np.testing.assert_allclose(np.swapaxes(slopes[..., :2], 1, 2) @ constants, 0.0, atol=1e-12)


def test_a_basis_is_orthonormal_whatever_the_units():
    slopes = RNG.normal(size=(3, 20, 2)) * np.array([1e9, 1e-9])
    basis = find_basis(slopes)
    np.testing.assert_allclose(np.swapaxes(basis, 1, 2) @ basis, np.broadcast_to(np.eye(2), (3, 2, 2)), atol=1e-12)


def test_a_start_state_that_nothing_shows_explains_nothing():
    slopes = RNG.normal(size=(2, 20, 2))
    slopes[..., 1] = 2 * slopes[..., 0]
    assert np.count_nonzero(np.abs(find_basis(slopes)).sum(axis=1)) == 2
    assert not find_basis(np.zeros((1, 9, 2))).any()


def test_columns_less_a_basis_are_at_right_angles_to_it():
    basis = find_basis(RNG.normal(size=(2, 15, 2)))
    left = without(basis, RNG.normal(size=(2, 15, 4)))
    np.testing.assert_allclose(np.swapaxes(basis, 1, 2) @ left, 0.0, atol=1e-12)


def test_the_covariance_is_that_of_the_regression_that_has_the_starts_in_it():
    slopes = RNG.normal(size=(5, 12, 3))
    whole = np.zeros((60, 11))
    for segment in range(5):
        whole[12 * segment : 12 * segment + 12, 2 * segment : 2 * segment + 2] = slopes[segment, :, :2]
    whole[:, 10] = slopes[..., 2].ravel()
    wanted = np.linalg.inv(whole.T @ whole)[10, 10]
    assert _fitted(np.zeros((5, 12)), slopes).covariance[0, 0] == pytest.approx(wanted)


@pytest.mark.parametrize(("variance", "least"), [(0.0, 0.0), (0.3, 0.0), (40.0, 5.0)])
def test_the_likelihood_beside_random_effects_is_that_of_the_dense_covariance_without_the_starts(variance, least):
    rng = np.random.default_rng(5)
    white, slopes, effects = (rng.normal(size=(3, *shape)) for shape in ((12,), (12, 3), (12, 4)))
    covariance, starts = np.eye(36), np.zeros((36, 6))
    for segment in range(3):
        rows = slice(12 * segment, 12 * segment + 12)
        covariance[rows, rows] += variance * effects[segment] @ effects[segment].T
        starts[rows, 2 * segment : 2 * segment + 2] = slopes[segment, :, :2]
    contrasts = null_space(starts.T)
    dense = contrasts.T @ covariance @ contrasts
    whitened = np.linalg.inv(np.linalg.cholesky(dense)) @ contrasts.T
    left, slope = whitened @ white.ravel(), whitened @ slopes[..., 2].ravel()
    squares = left @ left - (slope @ left) ** 2 / (slope @ slope)
    level = max(squares / 30, least)
    wanted = np.linalg.slogdet(dense)[1] + 30 * np.log(level) + squares / level
    found = _fitted(white, slopes).beside(effects).likelihood(variance, 30, least)
    assert found == (pytest.approx(wanted), pytest.approx(level))


def test_nothing_free_has_no_covariance():
    assert _fitted(np.zeros((2, 9)), np.zeros((2, 9, 2)), ()).covariance.shape == (0, 0)


def test_a_segment_that_failed_has_no_finite_misfit():
    white = np.ones((2, 9))
    white[1] = np.inf
    fit = _fitted(white, np.zeros((2, 9, 3)))
    assert fit.misfit == np.inf
    assert fit.misfits.tolist() == [9.0, np.inf]


def test_segments_that_are_better_are_taken():
    slopes = np.zeros((2, 9, 3))
    one, other = _fitted(np.ones((2, 9)), slopes), _fitted(np.zeros((2, 9)), slopes)
    assert one.where(np.array([True, True]), other) is other
    assert one.where(np.array([False, False]), other) is one
    assert one.where(np.array([False, True]), other).misfits.tolist() == [9.0, 0.0]


NOISE = 0.013


def bounded(k=24.0, low=20.0, high=28.0):
    """The mass, its stiffness believed to lie between bounds; 24 is true."""
    return parse_simulation(MASS.replace("value = 24.0", f"value = {k}\nlow = {low}\nhigh = {high}"), "bounded.toml")


@pytest.fixture(scope="module")
def measured():
    return record(with_load("0"), 3)


def _fitted_mass(simulation, measured, parts=()):
    case = set_up_case(simulation, measured)
    shooting = case.shooting(case.segments(case.learned)).with_noise(white_noise(np.array([NOISE])))
    return fit_model(shooting, simulation, parts, shooting.segments.starts(case.guess))


def test_half_the_width_is_two_standard_deviations():
    prior = read_prior(bounded())
    assert (prior.names, prior.sd.tolist()) == (("k",), [2.0])
    assert prior.left(np.array([2.0, 20.0, 0.8])).tolist() == [2.0]
    assert prior.within(np.array([2.0, 40.0, 0.8])).tolist() == [2.0, 28.0, 0.8]


@pytest.mark.parametrize("bounds", ["", "\nlow = 20.0", "\nhigh = 28.0", "\nlow = 24.0\nhigh = 24.0"])
def test_a_number_without_two_bounds_is_exact(bounds):
    exact = parse_simulation(MASS.replace("value = 24.0", f"value = 24.0{bounds}"), "exact.toml")
    assert read_prior(exact).names == ()


def test_a_number_that_is_a_little_off_is_found_within_its_bounds(measured):
    model = _fitted_mass(bounded(k=22.5, low=19.0, high=26.0), measured)
    found = model.fit.values[model.machine.parameters.index("k")]
    error = float(np.sqrt(model.fit.covariance[0, 0]))
    assert abs(found - 24.0) < 4 * error < 0.5
    assert model.size == 0


def test_a_number_stops_at_its_bound_and_the_others_are_fitted_with_it_there(measured):
    held = _fitted_mass(bounded(k=20.0, low=18.0, high=22.0), measured)
    at_bound = _fitted_mass(bounded(k=22.0, low=21.999, high=22.0), measured)
    assert held.fit.values[1] == pytest.approx(22.0)
    assert held.fit.misfit == pytest.approx(at_bound.fit.misfit, rel=0.01)


def test_only_a_wrong_parameter_leaves_its_bounds(measured):
    wrong = Candidate("wrong_parameter", "parameter", "k", "wrong_parameter", value=20.0, bounds=(18.0, 22.0))
    model = _fitted_mass(bounded(k=20.0, low=18.0, high=22.0), measured, (Part(wrong, {"value": 20.0}),))
    assert model.parts[0].values["value"] == pytest.approx(24.0, abs=0.3)
    assert model.fit.prior.names == ()
    assert model.size == 1


def test_few_data_leave_a_number_where_the_file_has_it(measured):
    case = set_up_case(bounded(k=22.0, low=21.9, high=22.1), measured)
    shooting = case.shooting(case.segments((0,))).with_noise(white_noise(np.array([50.0])))
    model = fit_model(shooting, case.search.base, (), shooting.segments.starts(case.guess))
    assert model.fit.values[1] == pytest.approx(22.0, abs=1e-3)
    assert np.sqrt(model.fit.covariance[0, 0]) == pytest.approx(0.05, rel=0.01)
