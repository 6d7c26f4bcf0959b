"""Columns into streams; missing forces are refused, other gaps are reported."""

from __future__ import annotations

import numpy as np
import pytest

from gaitdisc.channel import Channel, vocabulary
from gaitdisc.errors import ChannelError, ReadError, SamplingError
from gaitdisc.ingest.columns import named_channel, sorted_trial, stream_of
from gaitdisc.ingest.reading import read_trial
from gaitdisc.recording import Source

TIME = np.arange(5) / 100
SOURCE = Source("walk.mot", "0" * 64, "mot")


def _trial(*names, values=None):
    table = np.ones((5, len(names))) if values is None else values
    return sorted_trial(SOURCE, TIME, table, [named_channel(name) for name in names])


def test_every_channel_of_the_vocabulary_has_its_stream():
    streams = {channel.name: stream_of(channel) for channel in vocabulary().channels}
    assert streams["knee_angle_r"] == streams["pelvis_tx"] == "kinematics"
    assert streams["ground_force_r_vy"] == streams["ground_force_r_px"] == streams["ground_torque_r_y"] == "forces"
    assert streams["knee_angle_r_moment"] == "moments"
    assert streams["emg_sol_r"] == "emg"


def test_one_file_gives_several_streams_on_one_base():
    trial = _trial("knee_angle_r", "emg_sol_r", "RHEE.x", "sync")
    assert set(trial.streams) == {"kinematics", "emg", "markers", "signals"}
    assert trial.name == "walk"
    assert trial.streams["emg"].source == SOURCE


@pytest.mark.parametrize("name", ["ground_force_r_vx", "ground_force_r_vy", "pelvis_tx_force"])
def test_nan_in_a_force_is_refused_with_sample_and_time(name):
    values = np.ones((5, 1))
    values[2:4] = np.nan
    with pytest.raises(ReadError, match=rf"{name}.*2 of 5.*sample 3.*0\.02 s"):
        _trial(name, values=values)


def test_gaps_elsewhere_stay_for_the_quality_checks():
    values = np.ones((5, 2))
    values[1, 0] = values[2, 1] = np.nan
    trial = _trial("knee_angle_r", "ground_force_r_px", values=values)
    assert np.isnan(trial.streams["kinematics"].values[1, 0])
    assert trial.findings == ()


def test_two_columns_of_one_channel_are_refused():
    with pytest.raises(ChannelError, match=r"walk\.mot.*'sync'.*columns 2.*4"):
        sorted_trial(SOURCE, TIME, np.ones((5, 3)), [Channel(n, "signal", "1") for n in ("sync", "a", "sync")])


@pytest.mark.parametrize("rate_hz", [100.0, 1000.0, 2000.0])
def test_milliseconds_under_the_name_of_seconds_are_refused(tmp_path, rate_hz):
    time = np.arange(400) / rate_hz
    knee = 30 * np.sin(6 * time)
    rows = "\n".join(f"{1000 * t:g},{value}" for t, value in zip(time, knee, strict=True))
    (tmp_path / "walk.csv").write_text(f"time,knee_angle_r [deg]\n{rows}\n")
    said = rf"knee_angle_r .*0\.2 s .* {1000 / rate_hz:g} s apart, and 400"
    with pytest.raises(SamplingError, match=said):
        read_trial(tmp_path / "walk.csv")
    (tmp_path / "walk.csv").write_text(f"time [ms],knee_angle_r [deg]\n{rows}\n")
    assert read_trial(tmp_path / "walk.csv").stream("kinematics").rate_hz == pytest.approx(rate_hz)
    (tmp_path / "tank.csv").write_text(f"time,level\n{rows}\n")  # no walk: any rate
    assert read_trial(tmp_path / "tank.csv", {"level": "level [1]"}).stream("signals").rate_hz < 5
