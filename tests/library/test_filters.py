"""Filters of recordings, tables and arrays."""

import numpy as np
import pandas as pd
import pytest

import gaitdisc as gd
from gaitdisc.errors import ChannelError, ReadError, SamplingError, ShapeError

RATE_HZ = 120.0
T = np.arange(600) / RATE_HZ
X = np.random.default_rng(0).normal(size=(len(T), 2)).cumsum(axis=0)
RECORDING = gd.Recording(T, X, (gd.Channel("knee_angle_r", "angle", "deg", "r"), gd.Channel("a", "signal", "V")))
DONE = {
    "lowpass": lambda x, **rate: gd.lowpass(x, 6.0, **rate),
    "highpass": lambda x, **rate: gd.highpass(x, 6.0, **rate),
    "first": gd.differentiate,
    "second": lambda x, **rate: gd.differentiate(x, 2, **rate),
}


@pytest.mark.parametrize("done", DONE.values(), ids=DONE)
def test_every_form_of_a_signal_is_filtered_alike_and_keeps_its_form(done):
    expected = done(RECORDING).values
    np.testing.assert_allclose(done(X, rate_hz=RATE_HZ), expected, rtol=1e-9, atol=1e-9)
    np.testing.assert_allclose(done(X[:, 0].tolist(), rate_hz=RATE_HZ), expected[:, 0], rtol=1e-9, atol=1e-9)
    table = pd.DataFrame(X, columns=["knee_angle_r", "a"]).assign(time=T)
    found = done(table)
    assert list(found) == list(table) and found["time"].equals(table["time"])
    np.testing.assert_allclose(found[["knee_angle_r", "a"]], expected, rtol=1e-9, atol=1e-9)
    by_time = done(RECORDING.to_pandas())
    assert by_time.index.equals(RECORDING.to_pandas().index)
    np.testing.assert_allclose(by_time, expected, rtol=1e-9, atol=1e-9)


def test_times_that_print_rounds_stand_for_even_ones():
    table = pd.DataFrame(X, index=pd.Index(T.round(3), name="time"), columns=["a", "b"])
    np.testing.assert_allclose(gd.lowpass(table), gd.lowpass(X, rate_hz=RATE_HZ), rtol=1e-9, atol=1e-9)


def test_an_envelope_of_an_array_is_that_of_its_recording():
    emg = np.sin(2 * np.pi * 120 * np.arange(2000) / 1000)
    recording = gd.Recording(np.arange(2000) / 1000, emg[:, None], (gd.Channel("emg_sol_r", "emg", "V", "r"),))
    np.testing.assert_allclose(gd.envelope(emg, rate_hz=1000.0), gd.envelope(recording).values[:, 0], atol=1e-12)


def test_what_cannot_be_filtered_is_refused():
    with pytest.raises(SamplingError, match=r"an array is filtered at its rate; no rate_hz.*rate_hz=100"):
        gd.lowpass(X)
    with pytest.raises(SamplingError, match="rate_hz is -1"):
        gd.lowpass(X, rate_hz=-1.0)
    with pytest.raises(SamplingError, match="the first or the second; order is 3"):
        gd.differentiate(X, 3, rate_hz=100.0)
    with pytest.raises(ReadError, match=r"the table needs a column 'time \[s\]'.*its columns are 0, 1"):
        gd.lowpass(pd.DataFrame(X))
    with pytest.raises(ChannelError, match=r'a filter takes one stream.*has kinematics.*stream\("kinematics"\)'):
        gd.lowpass(gd.Trial("walk", {"kinematics": RECORDING}))
    with pytest.raises(ShapeError, match="a Recording, a DataFrame or an array of numbers; found str"):
        gd.lowpass("walk.csv", rate_hz=100.0)
    with pytest.raises(ReadError, match="columns need numbers; column 'who' holds others"):
        gd.lowpass(pd.DataFrame({"time": T, "who": "me"}))
