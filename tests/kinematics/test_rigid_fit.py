"""A rigid body is found again, whichever of its markers are seen."""

from __future__ import annotations

import numpy as np
from hypothesis import given, settings
from hypothesis import strategies as st
from scipy.spatial.transform import Rotation

from gaitdisc.kinematics.pose import fitted_pose

BODY = np.array([[0, 0, 0], [0.1, 0.02, 0], [0.0, 0.2, 0.01], [0.03, 0.1, 0.08], [-0.05, 0.15, 0.02]])


def moved(seed: int, frames: int = 12) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    random = np.random.default_rng(seed)
    rotation = Rotation.random(frames, random_state=seed).as_matrix()
    origin = random.normal(size=(frames, 3))
    return origin, rotation, origin[:, None] + np.einsum("fij,pj->fpi", rotation, BODY)


@settings(deadline=None)
@given(st.integers(0, 2**32 - 1))
def test_pose_comes_back(seed):
    origin, rotation, places = moved(seed)
    fit = fitted_pose(BODY, places)
    np.testing.assert_allclose(fit.pose.rotation, rotation, atol=1e-9)
    np.testing.assert_allclose(fit.pose.origin, origin, atol=1e-9)
    np.testing.assert_allclose(fit.residual_m, 0, atol=1e-9)


@settings(deadline=None)
@given(st.integers(0, 2**32 - 1))
def test_any_three_markers_carry_the_others(seed):
    origin, rotation, places = moved(seed)
    random = np.random.default_rng(seed)
    for frame in range(len(places)):
        places[frame, random.permutation(5)[: random.integers(0, 3)]] = np.nan
    fit = fitted_pose(BODY, places)
    np.testing.assert_allclose(fit.pose.rotation, rotation, atol=1e-9)
    np.testing.assert_allclose(fit.pose.origin, origin, atol=1e-9)
    np.testing.assert_array_equal(fit.seen, np.isfinite(places[..., 0]))


def test_two_markers_tell_no_pose():
    _, _, places = moved(1)
    places[3, :3] = np.nan
    fit = fitted_pose(BODY, places)
    assert fit.pose.known.tolist() == [frame != 3 for frame in range(12)]
    assert np.isnan(fit.residual_m[3])


def test_three_markers_on_a_line_tell_no_pose():
    line = np.array([[0, 0, 0], [0, 0.1, 0], [0, 0.2, 0], [0.1, 0, 0]])
    places = np.tile(line, (2, 1, 1))
    places[1, 3] = np.nan
    assert fitted_pose(line, places).pose.known.tolist() == [True, False]


def test_a_mirrored_body_is_not_followed_into_the_mirror():
    _, _, places = moved(2)
    fit = fitted_pose(BODY * [1, 1, -1], places)
    np.testing.assert_allclose(np.linalg.det(fit.pose.rotation), 1, atol=1e-12)
    assert (fit.residual_m > 0.01).all()


def test_the_fit_is_the_least_of_squares():
    """Turning the body a little to any side from the fit makes the squares larger."""
    random = np.random.default_rng(3)
    _, _, places = moved(3, 1)
    places = places + 0.01 * random.normal(size=places.shape)
    fit = fitted_pose(BODY, places)
    best = fit.residual_m[0]
    middle = places[0].mean(axis=0)
    centred = BODY - BODY.mean(axis=0)
    for turn in Rotation.random(50, random_state=4):
        little = Rotation.from_rotvec(0.01 * turn.as_rotvec()).as_matrix()
        apart = places[0] - middle - centred @ (little @ fit.pose.rotation[0]).T
        assert np.sqrt((apart**2).sum() / 5) > best


def test_residual_is_the_distance_of_the_markers():
    """Of a square two opposite corners move out by 1 mm and two in: nothing turns, each is 1 mm off."""
    square = np.array([[1, 0, 0], [0, 1, 0], [-1, 0, 0], [0, -1, 0.0]]) * 0.1
    places = (square * np.array([1.01, 0.99, 1.01, 0.99])[:, None])[None]
    np.testing.assert_allclose(fitted_pose(square, places).residual_m, 1e-3, rtol=1e-9)
