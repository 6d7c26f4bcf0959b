import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from scipy.integrate import trapezoid
from scipy.signal import butter, sosfiltfilt, sosfreqz

from gaitdisc.statistics.r2 import simulate_null


def analytic_null(frequency_hz, gain):
    """Squared correlation of x and x'' for white noise through a linear filter, m2^2 / (m0 m4), of moments of power.

    x' adds nothing, for it does not correlate with x'' in stationary noise.
    """
    m0, m2, m4 = (trapezoid(frequency_hz**power * gain**2, frequency_hz) for power in (0, 2, 4))
    return float(m2**2 / (m0 * m4))


def spectral(gain, rate_hz):
    """Filter and exact derivatives in the frequency domain."""

    def filtered(noise):
        f = np.fft.rfftfreq(len(noise), 1 / rate_hz)[:, None]
        power = np.fft.rfft(noise, axis=0) * gain(f)
        return tuple(np.fft.irfft(power * (2j * np.pi * f) ** order, len(noise), axis=0) for order in range(3))

    return filtered


def low_passed(noise, order=4, cutoff_hz=6, rate_hz=100):
    """The dissertation's reading: Butterworth both ways, then the gradient twice."""
    x = sosfiltfilt(butter(order, cutoff_hz, fs=rate_hz, output="sos"), noise, axis=0)
    xdot = np.gradient(x, 1 / rate_hz, axis=0)
    return x, xdot, np.gradient(xdot, 1 / rate_hz, axis=0)


def emg_envelope(noise, order=4):
    """1 kHz: high-pass 40 Hz, rectify, low-pass 10 Hz, then every tenth sample."""
    high = sosfiltfilt(butter(order, 40, "high", fs=1000, output="sos"), noise, axis=0)
    x = sosfiltfilt(butter(order, 10, fs=1000, output="sos"), np.abs(high), axis=0)[::10]
    xdot = np.gradient(x, 0.01, axis=0)
    return x, xdot, np.gradient(xdot, 0.01, axis=0)


@given(st.floats(0.1, 400))
def test_a_flat_band_gives_five_ninths(edge_hz):
    f = np.linspace(0, edge_hz, 2001)
    assert analytic_null(f, np.ones_like(f)) == pytest.approx(5 / 9, abs=1e-5)


def test_a_narrow_band_is_a_sine_and_gives_one():
    f = np.linspace(0, 10, 10001)
    assert analytic_null(f, np.exp(-(((f - 4) / 0.05) ** 2))) == pytest.approx(1.0, abs=1e-3)


@pytest.mark.parametrize("width", [0.3, 1.0, 3.0])
def test_simulation_and_analysis_agree(width):
    def gain(f):
        return np.exp(-(((f - 4) / width) ** 2))

    f = np.linspace(0, 50, 20001)
    found = simulate_null(spectral(gain, 100), 20_000, walks=30)
    assert found == pytest.approx(analytic_null(f, gain(f)), abs=0.01)


def test_kinematics_of_the_dissertation():
    """Feasibility study: about 0.508 for 6 Hz, order 4 each way, 100 Hz; the filter alone, exactly derived, 0.496."""
    found = simulate_null(low_passed, 21_000)
    assert found == pytest.approx(0.508, abs=0.005)
    f, response = sosfreqz(butter(4, 6, fs=100, output="sos"), worN=5000, fs=100)
    assert analytic_null(f, np.abs(response) ** 2) == pytest.approx(0.496, abs=0.001)


def test_emg_of_the_dissertation():
    """Feasibility study: about 0.510 at order 4 each way, 0.413 at order 2."""
    assert simulate_null(emg_envelope, 60_000, walks=12) == pytest.approx(0.510, abs=0.015)
    assert simulate_null(lambda noise: emg_envelope(noise, 2), 60_000, walks=12) == pytest.approx(0.413, abs=0.015)


def test_same_seed_same_null():
    one, same, other = (simulate_null(low_passed, 2000, walks=5, seed=seed) for seed in (0, 0, 1))
    assert one == same != other
