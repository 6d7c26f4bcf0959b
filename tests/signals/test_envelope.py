from __future__ import annotations

import numpy as np
import pytest

from gaitdisc.channel import Channel
from gaitdisc.errors import ChannelError, SamplingError
from gaitdisc.recording import Recording, Source
from gaitdisc.signals.emg import enveloped

SOLEUS = Channel("emg_sol_r", "emg", "V", "r")


def emg(x, rate=1000.0, channel=SOLEUS):
    return Recording(np.arange(len(x)) / rate, np.asarray(x, float)[:, None], (channel,), source=Source("walk.c3d"))


def test_a_sine_gives_its_mean_rectified_value():
    t = np.arange(5000) / 1000
    out = enveloped(emg(0.003 * np.sin(2 * np.pi * 110 * t)))["emg_sol_r"]
    assert out[1000:4000] == pytest.approx(0.003 * 2 / np.pi, rel=0.01)


def test_a_modulated_carrier_gives_its_modulation():
    t = np.arange(10000) / 1000
    loud = 1 + 0.5 * np.sin(2 * np.pi * 1.0 * t)
    out = enveloped(emg(loud * np.sin(2 * np.pi * 150 * t)))["emg_sol_r"]
    assert np.abs(out - 2 / np.pi * loud)[1000:-1000].max() < 0.01


def test_movement_artefact_below_40_hz_is_gone():
    t = np.arange(5000) / 1000
    out = enveloped(emg(np.sin(2 * np.pi * 5 * t)))["emg_sol_r"]
    assert np.abs(out[1000:4000]).max() < 1e-4


def test_a_slow_rate_is_refused():
    with pytest.raises(SamplingError, match=r"40 Hz.*above 80.*walk\.c3d.*80.*EMG"):
        enveloped(emg(np.random.default_rng(0).normal(size=500), 80.0))


def test_an_envelope_is_refused():
    with pytest.raises(SamplingError, match=r"walk\.c3d, emg_sol_r.*500 samples.*below"):
        enveloped(emg(0.1 + np.abs(np.random.default_rng(0).normal(size=500))))


def test_an_angle_is_refused():
    with pytest.raises(ChannelError, match=r"walk\.c3d.*'knee_angle_r'.*angle"):
        enveloped(emg(np.zeros(500), channel=Channel("knee_angle_r", "angle", "deg", "r")))
