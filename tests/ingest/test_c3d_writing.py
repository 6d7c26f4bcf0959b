import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from gaitdisc.channel import Channel
from gaitdisc.errors import ChannelError, SamplingError
from gaitdisc.ingest.c3d_writing import write_c3d
from gaitdisc.recording import Recording

EMG = (Channel("emg_sol_r", "emg", "V", "r"), Channel("emg_ta_r", "emg", "V", "r"))
FORCE = (Channel("ground_force_r_vy", "vertical_force", "N", "r"),)


def recording(channels, values, rate_hz=1000.0, start_s=0.0):
    return Recording(start_s + np.arange(len(values)) / rate_hz, values, channels)


@settings(max_examples=8, deadline=None)
@given(st.integers(0, 1000), st.integers(2, 40), st.sampled_from([100.0, 1000.0, 2000.0]))
def test_what_was_written_is_read_to_single_precision(reader, tmp_path_factory, seed, frames, rate_hz):
    rng = np.random.default_rng(seed)
    count = round(frames * rate_hz / 100.0)
    emg, force = (
        recording(EMG, rng.normal(0, 1, (count, 2)), rate_hz),
        recording(FORCE, rng.normal(0, 800, (count, 1)), rate_hz),
    )
    path = write_c3d([emg, force], tmp_path_factory.mktemp("c3d") / "walk.c3d")
    trial = reader.read(path, {"ground_force_r_vy": "ground_force_r_vy [N]"})
    for key, written in (("emg", emg), ("forces", force)):
        found = trial.stream(key)
        assert (found.names, found.rate_hz) == (written.names, rate_hz)
        np.testing.assert_allclose(found.values, written.values, rtol=1e-6)
        np.testing.assert_allclose(found.time, written.time, atol=1e-12)
    assert trial.findings == ()


def test_volts_of_a_converter_come_back_to_the_last_bit(reader, tmp_path):
    step = 5.0 / 2**15
    values = np.random.default_rng(1).integers(-(2**15), 2**15, (500, 2)) * step
    found = reader.read(write_c3d([recording(EMG, values)], tmp_path / "walk.c3d"))
    np.testing.assert_array_equal(found.stream("emg").values, values)


def test_a_frame_that_is_not_whole_is_left_away(reader, tmp_path):
    path = write_c3d([recording(EMG, np.ones((57, 2)))], tmp_path / "walk.c3d")
    assert len(reader.read(path).stream("emg").time) == 50


def test_a_walk_of_more_frames_than_16_bits_count_is_refused(reader, tmp_path):
    with pytest.raises(SamplingError, match=r"holds 655.34 s at most; walk.c3d would last 655.35 s"):
        write_c3d([recording(EMG[:1], np.ones((65_535, 1)), 100.0)], tmp_path / "walk.c3d")
    path = write_c3d([recording(EMG[:1], np.ones((65_534, 1)), 100.0)], tmp_path / "walk.c3d")
    assert len(reader.read(path).stream("emg").time) == 65_534


def test_two_time_bases_are_refused(tmp_path):
    emg, force = recording(EMG, np.ones((100, 2))), recording(FORCE, np.ones((200, 1)), 2000.0)
    with pytest.raises(
        SamplingError, match=r"emg_sol_r has 100 samples at 1000 Hz, ground_force_r_vy has 200 at 2000 Hz"
    ):
        write_c3d([emg, force], tmp_path / "walk.c3d")
    assert not list(tmp_path.iterdir())


@pytest.mark.parametrize(("rate_hz", "start_s"), [(1050.0, 0.0), (50.0, 0.0), (1000.0, 2.0)])
def test_a_clock_that_the_format_cannot_hold_is_refused(tmp_path, rate_hz, start_s):
    with pytest.raises(SamplingError, match=f"emg_sol_r begins at {start_s:g} s and has {rate_hz:g} Hz"):
        write_c3d([recording(EMG, np.ones((100, 2)), rate_hz, start_s)], tmp_path / "walk.c3d")


def test_a_name_that_no_file_can_hold_is_refused(tmp_path):
    with pytest.raises(ChannelError):
        write_c3d([recording((Channel("emg\t1", "emg", "V"),), np.ones((100, 1)))], tmp_path / "walk.c3d")
