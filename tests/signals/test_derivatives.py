"""Derivatives by local polynomials of curves whose derivatives are known; how long a series resembles itself."""

import numpy as np
import pytest
from changed_trials import with_column
from hypothesis import given, settings
from hypothesis import strategies as st

from gaitdisc.channel import Channel
from gaitdisc.errors import SamplingError
from gaitdisc.recording import Recording, Strides
from gaitdisc.signals.butterworth import low_pass
from gaitdisc.signals.derivatives import derivative, differentiate_recording, trajectory


@settings(deadline=None, max_examples=30)
@given(st.lists(st.floats(-10, 10), min_size=5, max_size=5))
def test_a_quartic_is_differentiated_exactly(coefficients):
    t = np.arange(40) / 100
    p = np.polynomial.Polynomial(coefficients)
    for order in (1, 2):
        found = derivative(p(t)[:, None], 100.0, order)[2:-2, 0]
        assert np.allclose(found, p.deriv(order)(t)[2:-2], atol=1e-7)


@pytest.mark.parametrize(("order", "bound"), [(1, 30), (2, 90)])
def test_a_sine_is_off_by_the_stated_share(order, bound):
    t, w = np.arange(400) / 100, 2 * np.pi * 5
    truth = w * np.cos(w * t) if order == 1 else -(w**2) * np.sin(w * t)
    e = derivative(np.sin(w * t)[:, None], 100.0, order)[2:-2, 0] - truth[2:-2]
    assert np.abs(e).max() / w**order == pytest.approx((w / 100) ** 4 / bound, rel=0.1)


def test_gaps_and_ends_have_no_derivative():
    x = np.arange(30.0)[:, None]
    x[12] = np.nan
    missing = np.flatnonzero(np.isnan(derivative(x, 100.0, 2)))
    assert missing.tolist() == [0, 1, 10, 11, 12, 13, 14, 28, 29]


def test_too_few_samples_are_refused():
    with pytest.raises(SamplingError, match=r"5 samples.*4"):
        derivative(np.zeros((4, 1)), 100.0)


def test_the_unit_becomes_a_rate(made):
    walk, _ = made.walk(3)
    assert differentiate_recording(walk, 2).channels[0].unit == "deg/s2"
    assert differentiate_recording(walk).channels[0].unit == "deg/s"


def test_a_trajectory_knows_what_is_usable(made):
    walk, contacts = made.walk(10)
    gappy = with_column(walk, "knee_angle_r", np.nan, slice(500, 504))
    strides = Strides(contacts[:-1], contacts[1:], "r", "force")
    path = trajectory(low_pass(gappy), strides)
    assert path.usable[32:-32, 0].all()
    assert not path.usable[:32].any()
    assert not path.usable[-32:].any()
    assert np.flatnonzero(~path.usable[100:-100, 1]).tolist() == list(range(398, 406))
    assert np.isfinite(path.xddot[path.usable]).all()
    assert np.nanmax(path.phi) < 100
    assert np.isnan(path.phi[0])


def test_the_acceleration_of_a_made_walk_is_right(made):
    walk, contacts = made.walk(20, spread=0.0)
    strides = Strides(contacts[:-1], contacts[1:], "r", "force")
    path = trajectory(low_pass(walk, 10.0), strides)
    fine = made.curve("hip_flexion", (walk.time[:, None] + [-1e-3, 0, 1e-3] - contacts[0]) / 1.1)
    truth = (fine @ [1.0, -2.0, 1.0]) / 1e-6
    rows = path.usable[:, 0] & np.isfinite(path.phi)
    assert np.corrcoef(path.xddot[rows, 0], truth[rows])[0, 1] > 0.97


def test_the_velocity_of_a_heading_that_passes_180_deg():
    t = np.arange(300) / 100
    true = 170 + 10 * t
    walk = Recording(t, ((true + 180) % 360 - 180)[:, None], (Channel("pelvis_rotation", "angle", "deg"),))
    np.testing.assert_allclose(differentiate_recording(walk).values[2:-2], 10.0, atol=1e-6)
    path = trajectory(walk, Strides(np.array([0.0]), np.array([2.9]), "r", "events"))
    np.testing.assert_allclose(path.xdot[2:-2], 10.0, atol=1e-6)
    np.testing.assert_allclose(path.xddot[2:-2], 0.0, atol=1e-3)
