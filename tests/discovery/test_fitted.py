import numpy as np
import pytest

from gaitdisc.discovery.fitted import Fitted, start_basis, without

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
    basis = start_basis(slopes)
    np.testing.assert_allclose(np.swapaxes(basis, 1, 2) @ basis, np.broadcast_to(np.eye(2), (3, 2, 2)), atol=1e-12)


def test_a_start_state_that_nothing_shows_explains_nothing():
    slopes = RNG.normal(size=(2, 20, 2))
    slopes[..., 1] = 2 * slopes[..., 0]
    assert np.count_nonzero(np.abs(start_basis(slopes)).sum(axis=1)) == 2
    assert not start_basis(np.zeros((1, 9, 2))).any()


def test_columns_less_a_basis_are_at_right_angles_to_it():
    basis = start_basis(RNG.normal(size=(2, 15, 2)))
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
