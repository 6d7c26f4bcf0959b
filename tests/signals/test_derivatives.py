"""Derivatives by local polynomials of curves whose derivatives are known; how long a series resembles itself."""

import numpy as np
import pytest
from changed_trials import with_column
from hypothesis import given, settings
from hypothesis import strategies as st
from scipy.signal import savgol_filter as of_scipy

from gaitdisc.channel import Channel
from gaitdisc.errors import SamplingError
from gaitdisc.recording import Recording, Strides
from gaitdisc.signals.butterworth import lowpassed
from gaitdisc.signals.derivatives import differentiated, differentiated_recording, savgol_filter, trajectory
from gaitdisc.signals.series import autocorrelation_time


@settings(deadline=None, max_examples=30)
@given(st.lists(st.floats(-10, 10), min_size=5, max_size=5))
def test_a_quartic_is_differentiated_exactly(coefficients):
    t = np.arange(40) / 100
    p = np.polynomial.Polynomial(coefficients)
    for order in (1, 2):
        found = differentiated(p(t)[:, None], 100.0, order)[2:-2, 0]
        assert np.allclose(found, p.deriv(order)(t)[2:-2], atol=1e-7)


@pytest.mark.parametrize(("order", "bound"), [(1, 30), (2, 90)])
def test_a_sine_is_off_by_the_stated_share(order, bound):
    t, w = np.arange(400) / 100, 2 * np.pi * 5
    truth = w * np.cos(w * t) if order == 1 else -(w**2) * np.sin(w * t)
    e = differentiated(np.sin(w * t)[:, None], 100.0, order)[2:-2, 0] - truth[2:-2]
    assert np.abs(e).max() / w**order == pytest.approx((w / 100) ** 4 / bound, rel=0.1)


def test_gaps_and_ends_have_no_derivative():
    x = np.arange(30.0)[:, None]
    x[12] = np.nan
    missing = np.flatnonzero(np.isnan(differentiated(x, 100.0, 2)))
    assert missing.tolist() == [0, 1, 10, 11, 12, 13, 14, 28, 29]


def test_too_few_samples_are_refused():
    with pytest.raises(SamplingError, match=r"5 samples.*4"):
        differentiated(np.zeros((4, 1)), 100.0)


def test_the_unit_becomes_a_rate(made):
    walk, _ = made.walk(3)
    assert differentiated_recording(walk, 2).channels[0].unit == "deg/s2"
    assert differentiated_recording(walk).channels[0].unit == "deg/s"


def test_a_trajectory_knows_what_is_usable(made):
    walk, contacts = made.walk(10)
    gappy = with_column(walk, "knee_angle_r", np.nan, slice(500, 504))
    strides = Strides(contacts[:-1], contacts[1:], "r", "force")
    path = trajectory(lowpassed(gappy), strides)
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
    path = trajectory(lowpassed(walk, 10.0), strides)
    fine = made.curve("hip_flexion", (walk.time[:, None] + [-1e-3, 0, 1e-3] - contacts[0]) / 1.1)
    truth = (fine @ [1.0, -2.0, 1.0]) / 1e-6
    rows = path.usable[:, 0] & np.isfinite(path.phi)
    assert np.corrcoef(path.xddot[rows, 0], truth[rows])[0, 1] > 0.97


def test_the_velocity_of_a_heading_that_passes_180_deg():
    t = np.arange(300) / 100
    true = 170 + 10 * t
    walk = Recording(t, ((true + 180) % 360 - 180)[:, None], (Channel("pelvis_rotation", "angle", "deg"),))
    np.testing.assert_allclose(differentiated_recording(walk).values[2:-2], 10.0, atol=1e-6)
    path = trajectory(walk, Strides(np.array([0.0]), np.array([2.9]), "r", "events"))
    np.testing.assert_allclose(path.xdot[2:-2], 10.0, atol=1e-6)
    np.testing.assert_allclose(path.xddot[2:-2], 0.0, atol=1e-3)


@given(half=st.integers(2, 12), extra=st.integers(0, 30), derivative=st.integers(0, 2), seed=st.integers(0, 99))
def test_numbers_are_those_of_scipy(half, extra, derivative, seed):
    width = 2 * half + 1
    values = np.random.default_rng(seed).normal(0, 10, width + extra)
    found = savgol_filter(values, width, 3, derivative, 0.01)
    np.testing.assert_allclose(
        found, of_scipy(values, width, 3, derivative, 0.01), rtol=0, atol=1e-9 * 0.01**-derivative
    )


@pytest.mark.parametrize("derivative", [0, 1, 2, 3])
def test_a_cubic_and_its_derivatives_come_out_exactly_up_to_both_ends(derivative):
    time = np.linspace(-1, 1, 41)
    cubic = np.polynomial.Polynomial([0.3, -1.0, 2.0, 0.7])
    found = savgol_filter(cubic(time), 11, 3, derivative, time[1] - time[0])
    expected = cubic.deriv(derivative)(time) if derivative else cubic(time)
    np.testing.assert_allclose(found, expected, atol=1e-9)


def test_of_an_autoregressive_series_it_is_the_sum_of_a_geometric_one():
    rng, kept = np.random.default_rng(0), 0.8
    series = np.zeros(200_000)
    for k, push in enumerate(rng.standard_normal(len(series) - 1)):
        series[k + 1] = kept * series[k] + push
    assert autocorrelation_time(series[:, None], 0.01)[0] == pytest.approx((1 + kept) / (1 - kept), rel=0.05)


def test_every_column_has_its_own_and_one_that_stands_still_none():
    rng = np.random.default_rng(1)
    noise = rng.standard_normal(50_000)
    found = autocorrelation_time(np.column_stack([noise, np.repeat(noise[::10], 10), np.zeros(50_000)]), 0.05)
    assert found == pytest.approx([1.0, 10.0, 1.0], rel=0.05)


def test_a_shift_and_a_scale_change_nothing():
    values = np.random.default_rng(2).standard_normal((500, 2)).cumsum(axis=0)
    assert autocorrelation_time(3 - 7 * values) == pytest.approx(autocorrelation_time(values))
