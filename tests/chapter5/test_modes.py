import numpy as np
import pytest
from chapter5.modes import evening_rotation, fit_modes
from hypothesis import given, settings
from hypothesis import strategies as st

from gaitdisc.errors import TrainingError

RNG = np.random.default_rng(0)


@given(st.lists(st.floats(1e-6, 1e6), min_size=1, max_size=40))
@settings(max_examples=60, deadline=None)
def test_the_rotation_evens_all_variances(variances):
    variances = np.array(variances)
    turn = evening_rotation(variances)
    np.testing.assert_allclose(turn.T @ turn, np.eye(len(variances)), atol=1e-9)
    found = np.einsum("km,k,km->m", turn, variances, turn)
    np.testing.assert_allclose(found, variances.mean(), rtol=1e-6)


def test_energies_are_those_of_the_singular_values():
    values = RNG.normal(size=(40, 30, 1)) * np.linspace(1, 5, 30)[:, None]
    centred = (values - values.mean(axis=0)).reshape(40, -1)
    singular = np.linalg.svd(centred, compute_uv=False) ** 2
    np.testing.assert_allclose(fit_modes(values).energies[:29], (singular / singular.sum())[:29], rtol=1e-4)


def test_what_is_left_is_the_energy_that_was_not_wanted():
    values = RNG.normal(size=(50, 200, 1)).astype(np.float32)
    modes = fit_modes(values, 0.9)
    found = modes.fields(modes.coefficients(values))
    left = np.mean((found - values) ** 2) / np.mean((values - values.mean(axis=0)) ** 2)
    assert left == pytest.approx(1 - modes.energies[: modes.count].sum(), abs=1e-4)
    assert 1 - left >= 0.9
    assert 1 - modes.energies[: modes.count - 1].sum() > 0.1
    variances = modes.coefficients(values).var(axis=0)
    np.testing.assert_allclose(variances, variances.mean(), rtol=1e-3)
    np.testing.assert_allclose(modes.basis.T @ modes.basis, np.eye(modes.count), atol=1e-5)


def test_quantities_of_other_units_weigh_alike():
    values = np.stack([RNG.normal(size=(40, 20)), 1e4 * RNG.normal(size=(40, 20))], axis=-1)
    modes = fit_modes(values, 0.99)
    left = (modes.fields(modes.coefficients(values)) - values).std(axis=(0, 1)) / values.std(axis=(0, 1))
    assert left.max() < 0.15


def test_most_modes_can_be_limited():
    assert fit_modes(RNG.normal(size=(20, 30, 1)), 1.0, most=3).count == 3


def test_what_cannot_be_fitted_is_refused():
    with pytest.raises(TrainingError, match=r"1 snapshots.*0.99"):
        fit_modes(np.ones((1, 3, 1)))
    with pytest.raises(TrainingError, match=r"quantity 2.*5 snapshots"):
        fit_modes(np.stack([RNG.normal(size=(5, 3)), np.ones((5, 3))], axis=-1))
