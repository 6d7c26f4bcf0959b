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
    with pytest.raises(SamplingError, match=r"rate_hz.*rate_hz=100"):
        gd.lowpass(X)
    with pytest.raises(SamplingError, match="rate_hz is -1"):
        gd.lowpass(X, rate_hz=-1.0)
    with pytest.raises(SamplingError, match=r"order.*3"):
        gd.differentiate(X, 3, rate_hz=100.0)
    with pytest.raises(ChannelError, match=r"stream of a.*kinematics"):
        gd.lowpass(gd.Trial("walk", {"kinematics": RECORDING}))
    with pytest.raises(ShapeError, match=r"DataFrame.*array of numbers"):
        gd.lowpass("walk.csv", rate_hz=100.0)
    with pytest.raises(ReadError, match=r"columns must contain numbers.*'who'"):
        gd.lowpass(pd.DataFrame({"time": T, "who": "me"}))


def test_a_column_of_a_table_is_filtered_by_its_index_or_at_a_rate_and_stays_a_column():
    table = pd.DataFrame(X, columns=["knee_angle_r", "a"])
    for column, rate in ((table["a"], {"rate_hz": RATE_HZ}), (table.set_index(pd.Index(T, name="time"))["a"], {})):
        found = gd.lowpass(column, **rate)
        assert isinstance(found, pd.Series) and found.index.equals(column.index) and found.name == "a"
        np.testing.assert_allclose(found, gd.lowpass(RECORDING)["a"], rtol=1e-9)


def test_a_table_without_times_is_filtered_at_a_rate_under_its_own_labels():
    table = pd.DataFrame(X)  # its labels are the numbers 0 and 1
    found = gd.lowpass(table, rate_hz=RATE_HZ)
    assert list(found) == [0, 1] and found.index.equals(table.index)
    np.testing.assert_allclose(found, gd.lowpass(X, rate_hz=RATE_HZ))
    assert list(gd.lowpass(table.assign(time=T))) == [0, 1, "time"]
    with pytest.raises(SamplingError, match=r"a table without times.*rate_hz=100"):
        gd.lowpass(table)


@pytest.mark.parametrize("signal", [RECORDING, pd.DataFrame({"time": T, "a": X[:, 0]})], ids=["recording", "table"])
def test_a_rate_that_the_times_contradict_is_refused(signal):
    assert gd.lowpass(signal, rate_hz=RATE_HZ) is not None
    with pytest.raises(SamplingError, match=r"120 samples.*rate_hz.*200"):
        gd.lowpass(signal, rate_hz=200)


@pytest.mark.parametrize("shape", [(7, 1000), (600, 2, 3)])
def test_an_array_on_its_side_is_refused(shape):
    with pytest.raises(ShapeError, match="time"):
        gd.differentiate(np.zeros(shape), rate_hz=RATE_HZ)


def test_a_rate_and_a_cut_off_are_numbers():
    with pytest.raises(SamplingError, match="rate_hz is '100'"):
        gd.lowpass(X, rate_hz="100")
    with pytest.raises(SamplingError, match=r"\[20, 40\]"):
        gd.lowpass(X, [20, 40], rate_hz=RATE_HZ)
