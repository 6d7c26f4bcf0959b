"""What electrodes see: amplitude, delay, neighbours, floor."""

from __future__ import annotations

import numpy as np
import pytest

from gaitdisc.cohort.emg import BAND_HZ, CROSS_TALK, DELAY_S, FLOOR_V, RANGE_V, electrode_volts, heard
from gaitdisc.cohort.person import MUSCLES, drawn

PERSON = drawn("A", 5, "f")
TA, SOL, GAS = (MUSCLES.index(name) for name in ("emg_ta", "emg_sol", "emg_gas"))


def volts(excitation, late_s=0.0, seed=1):
    return electrode_volts(np.random.default_rng(seed), excitation, PERSON, 1000.0, late_s)


def alone(muscle, level=0.4, count=20_000):
    excitation = np.zeros((count, len(MUSCLES)))
    excitation[:, muscle] = level
    return excitation


def test_amplitude_follows_excitation():
    low, high = (volts(alone(TA, level))[:, TA].std() for level in (0.1, 0.3))
    assert high == pytest.approx(3 * low, rel=0.03)


def test_neighbours_are_heard_and_nobody_else():
    seen = volts(alone(SOL)).std(axis=0)
    assert seen[GAS] == pytest.approx(CROSS_TALK["emg_gas", "emg_sol"] * seen[SOL], rel=0.8)
    assert seen[TA] < 1.5 * FLOOR_V
    assert heard(2).shape == (14, 14)
    assert not heard(2)[:7, 7:].any()


@pytest.mark.parametrize("late_s", [0.0, 0.05])
def test_the_signal_comes_before_the_excitation_by_the_electromechanical_delay(late_s):
    excitation = alone(TA)
    excitation[:10_000] = 0.0
    power = volts(excitation, late_s)[:, TA] ** 2
    begins = np.flatnonzero(np.convolve(power, np.ones(10) / 10, "same") > 0.2 * power[12_000:].mean())[0]
    assert begins == pytest.approx(10_000 + 1000 * (late_s - DELAY_S), abs=12)


def test_power_lies_in_the_band():
    signal = volts(alone(TA))[:, TA]
    power, hz = np.abs(np.fft.rfft(signal)) ** 2, np.fft.rfftfreq(len(signal), 0.001)
    inside = (hz > BAND_HZ[0]) & (hz < BAND_HZ[1])
    assert power[inside].sum() > 0.9 * power.sum()
    assert 80.0 < hz[np.searchsorted(np.cumsum(power), power.sum() / 2)] < 200.0


def test_a_converter_has_a_range():
    assert np.abs(volts(alone(TA, 50.0))).max() <= RANGE_V
