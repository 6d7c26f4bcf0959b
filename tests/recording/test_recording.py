import numpy as np
import pytest
from changed_trials import markers_at
from hypothesis import given
from hypothesis import strategies as st

import gaitdisc as gd
from gaitdisc.channel import Channel
from gaitdisc.errors import ChannelError, SamplingError, ShapeError
from gaitdisc.recording import Recording, Source

KNEE = Channel("knee_angle_r", "angle", "deg", "r")
ANKLE = Channel("ankle_angle_r", "angle", "deg", "r")


def walk(samples=100, rate_hz=100.0):
    time = np.arange(samples) / rate_hz
    return Recording(time, np.column_stack([time, -time]), (KNEE, ANKLE), "P01", "exo", Source("walk.mot"))


def test_rate_and_duration():
    assert (walk().rate_hz, walk().duration_s) == (100.0, 1.0)
    assert Recording(np.zeros(1), np.zeros((1, 1)), (KNEE,)).duration_s == 0.0


@given(st.floats(10.0, 2000.0), st.integers(3, 500), st.floats(-100.0, 100.0))
def test_rate_of_any_even_time_base(rate_hz, samples, start):
    recording = Recording(start + np.arange(samples) / rate_hz, np.zeros((samples, 1)), (KNEE,))
    assert recording.rate_hz == pytest.approx(rate_hz, rel=1e-6)


def test_arrays_are_read_only():
    for array in (walk().values, walk().time, walk().suspect, walk()["knee_angle_r"]):
        with pytest.raises(ValueError, match="read-only"):
            array[0] = 1


def test_selected_keeps_order_and_marks():
    marks = np.zeros((100, 2), bool)
    marks[3, 1] = True
    chosen = walk().with_values(walk().values, marks).selected(["ankle_angle_r", "knee_angle_r"])
    assert chosen.names == ("ankle_angle_r", "knee_angle_r")
    assert chosen.suspect[3].tolist() == [True, False]
    assert walk().selected_by(lambda c: c.name.startswith("knee")).names == ("knee_angle_r",)


def test_marks_add_up():
    first, second = np.zeros((2, 100, 2), bool)
    first[0], second[1] = True, True
    recording = walk().with_values(walk().values, first)
    both = recording.with_values(recording.values, second)
    assert both.suspect.sum() == 4


def test_between_is_half_open():
    part = walk().between(0.1, 0.2)
    assert len(part.time) == 10
    assert part.time[0] == pytest.approx(0.1)


def test_missing_channel_names_the_nearest():
    with pytest.raises(ChannelError, match=r"'ankle_ang_r'.*walk.mot.*2 channels.*'ankle_angle_r'"):
        walk()["ankle_ang_r"]


@pytest.mark.parametrize(
    ("channels", "words"),
    [((KNEE, KNEE), "'knee_angle_r' 2 times"), (("knee_angle_r", KNEE), r"found 'knee_angle_r'.*Channel\(")],
)
def test_a_doubled_and_a_bare_name_are_refused(channels, words):
    with pytest.raises(ChannelError, match=words):
        Recording(np.arange(3) / 100, np.zeros((3, 2)), channels)


def test_a_rate_that_is_not_constant_names_the_step():
    time = np.arange(10) / 100
    time[6:] += 0.05
    with pytest.raises(SamplingError, match=r"0.06 s.*sample 5.*= 0.05 s\)"):
        Recording(time, np.zeros((10, 1)), (KNEE,))


def test_time_that_runs_backwards_or_is_not_a_number():
    for time in (np.array([0.0, -0.01, -0.02]), np.array([0.0, np.nan, 0.02]), np.zeros(3)):
        with pytest.raises(SamplingError, match="constant"):
            Recording(time, np.zeros((3, 1)), (KNEE,))


@pytest.mark.parametrize("shape", [(4, 2), (5,), (5, 3)])
def test_shapes_that_do_not_fit(shape):
    with pytest.raises(ShapeError, match=r"shape \(time, channel\)"):
        Recording(np.arange(5) / 100, np.zeros(shape), (KNEE, ANKLE))
    with pytest.raises(ShapeError, match="marks of suspect"):
        Recording(np.arange(5) / 100, np.zeros((5, 2)), (KNEE, ANKLE), suspect=np.zeros((5, 1), bool))


def test_tables_for_those_who_want_them():
    frame = walk().to_pandas()
    np.testing.assert_array_equal(frame["ankle_angle_r"], walk()["ankle_angle_r"])
    labelled = walk().to_xarray()
    assert labelled.sel(channel="knee_angle_r").coords["unit"].item() == "deg"
    assert labelled.dims == ("time", "channel")


def test_a_channel_is_taken_by_its_name_and_one_name_is_one_channel():
    walk = markers_at(np.arange(100) / 100, {"RHEE": np.zeros((100, 3))})
    assert walk.selected("RHEE.y").names == ("RHEE.y",)
    assert "RHEE.z" in walk and "RHEE" not in walk and 0 not in walk
    with pytest.raises(ChannelError, match=r"marker.*RHEE.x, RHEE.y, RHEE.z"):
        walk["RHEE"]
    for other in (["RHEE.x"], slice(0, 10), 0):
        with pytest.raises(ChannelError, match=rf"selected by its name; found {type(other).__name__}"):
            walk[other]


def test_a_table_with_units_is_read_back():
    walk = Recording(np.arange(100) / 100, np.ones((100, 1)), (Channel("RHEE.x", "marker", "m", "r"),))
    assert list(walk.to_pandas(units=True)) == ["RHEE.x [m]"]
    again = gd.read(walk.to_pandas(units=True)).stream("markers")
    assert [(one.name, one.unit) for one in again.channels] == [("RHEE.x", "m")] and (again.values == 1.0).all()
