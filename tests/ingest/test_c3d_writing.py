import ezc3d
import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from gaitdisc.channel import Channel
from gaitdisc.errors import ChannelError, SamplingError
from gaitdisc.ingest.c3d_writing import write_c3d
from gaitdisc.recording import Recording, Surface

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
    with pytest.raises(SamplingError, match=r"655.34 s.*walk.c3d.*655.35 s"):
        write_c3d([recording(EMG[:1], np.ones((65_535, 1)), 100.0)], tmp_path / "walk.c3d")
    path = write_c3d([recording(EMG[:1], np.ones((65_534, 1)), 100.0)], tmp_path / "walk.c3d")
    assert len(reader.read(path).stream("emg").time) == 65_534


def test_two_time_bases_are_refused(tmp_path):
    emg, force = recording(EMG, np.ones((100, 2))), recording(FORCE, np.ones((200, 1)), 2000.0)
    with pytest.raises(SamplingError, match=r"emg_sol_r.*100 samples.*1000 Hz, and ground_force_r_vy.*200.*2000 Hz"):
        write_c3d([emg, force], tmp_path / "walk.c3d")
    assert not list(tmp_path.iterdir())


@pytest.mark.parametrize(("rate_hz", "start_s"), [(1050.0, 0.0), (50.0, 0.0), (1000.0, 2.0)])
def test_a_clock_that_the_format_cannot_hold_is_refused(tmp_path, rate_hz, start_s):
    with pytest.raises(SamplingError, match=rf"emg_sol_r begins at {start_s:g} s and has {rate_hz:g} Hz"):
        write_c3d([recording(EMG, np.ones((100, 2)), rate_hz, start_s)], tmp_path / "walk.c3d")


def test_a_name_that_no_file_can_hold_and_a_plate_without_a_channel_are_refused(tmp_path):
    with pytest.raises(ChannelError):
        write_c3d([recording((Channel("emg\t1", "emg", "V"),), np.ones((100, 1)))], tmp_path / "walk.c3d")
    plate = Surface("plate_1", np.array([[0.0, 0, 0], [0.4, 0, 0], [0.4, 0.6, 0], [0, 0.6, 0]]))
    with pytest.raises(ChannelError, match=r"walk.c3d.*'plate_1_fx'"):
        write_c3d([recording(EMG, np.ones((100, 2)))], tmp_path / "walk.c3d", [plate])


def test_markers_and_plates_are_read_back(reader, tmp_path):
    rng = np.random.default_rng(3)
    markers = Recording(
        np.arange(50) / 100.0,
        np.where(rng.random((50, 6)) < 0.02, np.nan, rng.normal(1, 0.3, (50, 6))),
        tuple(Channel(f"{name}.{axis}", "marker", "m") for name in ("RHEE", "LHEE") for axis in "xyz"),
    )
    gaps = np.isnan(markers.values.reshape(50, 2, 3)).any(axis=2)  # a point is seen or it is not
    turn = np.array([[0.0, 0.6], [0.0, 0.0], [0.4, 0.0], [0.4, 0.6]])  # the plate's own x is the laboratory's -y
    surfaces = [Surface(f"plate_{n}", np.column_stack([turn[:, 0], turn[:, 1] + n, np.zeros(4)])) for n in (1, 2)]
    force = np.tile([20.0, -30.0, 700.0], (500, 1)) + rng.normal(0, 5, (500, 3))
    point = np.column_stack([rng.uniform(-0.15, 0.15, (500, 2)), np.zeros(500)])
    wrench = np.hstack([force, np.cross(point, force) + np.array([0, 0, 4.0])])
    columns = tuple(
        Channel(f"plate_{n}_{kind}{axis}", *("vertical_force" if kind + axis == "fz" else quantity, unit))
        for n in (1, 2)
        for kind, quantity, unit in (("f", "force", "N"), ("m", "moment", "N m"))
        for axis in "xyz"
    )
    forces = recording(columns, np.hstack([wrench, 0.5 * wrench]))
    path = write_c3d([markers, forces, recording(EMG, np.ones((500, 2)))], tmp_path / "walk.c3d", surfaces)
    trial = reader.read(path)
    found = trial.stream("markers")
    assert found.names == markers.names
    np.testing.assert_array_equal(np.isnan(found.values.reshape(50, 2, 3)).all(axis=2), gaps)
    np.testing.assert_allclose(
        found.values.reshape(50, 2, 3)[~gaps], markers.values.reshape(50, 2, 3)[~gaps], rtol=1e-6
    )
    for name in forces.names:
        np.testing.assert_allclose(trial.stream("forces")[name], forces[name], rtol=1e-5, atol=1e-3)
    centre = np.column_stack([trial.stream("forces")[f"plate_1_p{axis}"] for axis in "xyz"])
    np.testing.assert_allclose(centre - surfaces[0].corners.mean(axis=0), point, atol=1e-5)
    seen = ezc3d.c3d(str(path), extract_forceplat_data=True)["data"]["platform"]  # as another program reads it
    np.testing.assert_allclose(np.abs(seen[1]["force"].T), np.abs(0.5 * force), rtol=1e-5)
    assert [surface.name for surface in trial.surfaces] == ["plate_1", "plate_2"]
    assert trial.findings == () and trial.stream("emg").names == ("emg_sol_r", "emg_ta_r")
    alone = reader.read(write_c3d([markers], tmp_path / "alone.c3d"))
    np.testing.assert_array_equal(alone.stream("markers").values, found.values)
    again = write_c3d([trial.stream("markers"), trial.stream("forces")], tmp_path / "again.c3d", trial.surfaces)
    np.testing.assert_allclose(reader.read(again).stream("forces").values, trial.stream("forces").values, atol=1e-3)
