import numpy as np
import pytest
from chapter5.turbulence import Box
from hypothesis import given, settings
from hypothesis import strategies as st

from gaitdisc.errors import ShapeError

BOX = Box(16)


@given(st.integers(0, 2**31))
@settings(max_examples=10, deadline=None)
def test_modes_and_nodes_are_one_field_and_energy_is_its_mean_square(seed):
    velocity = np.random.default_rng(seed).normal(size=(3, 16, 16, 16))
    modes = BOX.to_modes(velocity)
    np.testing.assert_allclose(BOX.to_nodes(modes), velocity, atol=1e-12)
    assert BOX.energy(modes).sum() == pytest.approx(0.5 * (velocity**2).sum(axis=0).mean(), rel=1e-6)


@given(st.integers(0, 2**31))
@settings(max_examples=10, deadline=None)
def test_what_is_projected_has_no_divergence_and_is_not_projected_again(seed):
    modes = BOX.to_modes(np.random.default_rng(seed).normal(size=(3, 16, 16, 16)))
    once = BOX.projected(modes)
    assert np.abs((BOX.k * once).sum(axis=0)).max() < 1e-6 * np.abs(once).max() * BOX.nodes
    np.testing.assert_allclose(BOX.projected(once), once, atol=1e-7)
    assert not once[:, ~BOX.kept].any()


def test_a_gradient_is_taken_away_whole():
    x = 2 * np.pi * np.arange(16) / 16
    gradient = np.zeros((3, 16, 16, 16))
    gradient[0] = np.cos(2 * x)[:, None, None]  # of sin(2 x) / 2
    assert np.abs(BOX.projected(BOX.to_modes(gradient))).max() < 1e-12


def test_two_thirds_of_the_wavenumbers_are_kept():
    assert [Box(n).largest for n in (32, 48, 64)] == [10, 15, 21]
    assert 3 * BOX.largest < BOX.nodes  # a product of three kept modes cannot fold back onto a kept one


def test_too_coarse_a_box_is_refused():
    with pytest.raises(ShapeError, match=r"8 or more.*33"):
        Box(33)
