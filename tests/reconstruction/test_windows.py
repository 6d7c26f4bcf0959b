import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from gaitdisc.channel import Channel
from gaitdisc.errors import ChannelError, SamplingError, ShapeError
from gaitdisc.reconstruction.windows import Lags, cut_windows, present, stacked, thin_windows
from gaitdisc.recording import Recording


def counting(length=30, rate=100.0):
    """Channel a counts samples, b counts hundreds, c thousands: every window says where it comes from."""
    channels = tuple(Channel(name, "angle", "deg") for name in "abc")
    n = np.arange(length, dtype=float)
    return Recording(n / rate, np.column_stack([n, 100 * n, 1000 * n]), channels)


@given(st.integers(1, 5), st.integers(1, 4))
def test_every_reading_is_of_the_time_that_its_name_says(count, spacing):
    lags = Lags(count, spacing)
    made = cut_windows(counting(), ["b", "a"], ["c"], lags, np.zeros(30))
    assert len(made) == 30 - lags.reach
    last = made.y[:, 0] / 1000
    for k in range(count):
        ago = (count - 1 - k) * spacing
        np.testing.assert_array_equal(made.x[:, 2 * k] / 100, last - ago)
        np.testing.assert_array_equal(made.x[:, 2 * k + 1], last - ago)
    np.testing.assert_allclose(made.time, last / 100)
    assert made.inputs[-2:] == ("b", "a")


@pytest.mark.parametrize(
    ("gap", "kept", "lost"),
    [(slice(10, 11), False, {10, 12, 14, 25}), (slice(10, 15), True, {14, 25})],  # 14 has no reading at all
)
def test_no_window_reaches_over_a_missing_value_unless_those_are_kept(gap, kept, lost):
    recording = counting()
    values = recording.values.copy()
    values[gap, 0] = np.nan
    values[25, 2] = np.nan
    made = cut_windows(recording.with_values(values), ["a"], ["c"], Lags(3, 2), np.zeros(30), missing=kept)
    assert set((made.y[:, 0] / 1000).astype(int)) == set(range(4, 30)) - lost
    assert np.isnan(made.x).any() == kept


def test_windows_of_two_trials_never_join():
    pair = [cut_windows(counting(8), ["a"], ["c"], Lags(3, 1), np.zeros(8)) for _ in range(2)]
    both = stacked(pair)
    assert len(both) == 12
    np.testing.assert_array_equal(np.diff(both.x, axis=1), 1)


def test_present_readings_and_every_third_window():
    made = cut_windows(counting(), ["a", "b"], ["c"], Lags(3, 2), np.zeros(30))
    now = present(made, ["a", "b"])
    np.testing.assert_array_equal(now.x, made.y / [1000, 10])
    assert now.inputs == ("a", "b")
    assert len(thin_windows(made, 9)) == 9
    assert thin_windows(made, 100).x.shape == made.x.shape


@given(st.integers(0, 5))
def test_a_window_may_tell_the_future(ahead):
    made = cut_windows(counting(), ["a"], ["a", "c"], Lags(3, 2, ahead), np.arange(30.0))
    assert len(made) == 30 - 4 - ahead
    np.testing.assert_array_equal(made.y[:, 0] - made.x[:, -1], ahead)
    np.testing.assert_allclose(made.time * 100, made.y[:, 0])
    np.testing.assert_array_equal(made.phi, made.y[:, 0])


def test_refusals():
    with pytest.raises(SamplingError, match=r"0\.40 s.*0\.30 s"):
        cut_windows(counting(), ["a"], ["c"], Lags(11, 4), np.zeros(30))
    with pytest.raises(ChannelError, match="'d' is"):
        cut_windows(counting(), ["d"], ["c"], Lags(2, 1), np.zeros(30))
    with pytest.raises(SamplingError, match=r"0\.20 s.*0\.10 s.*0\.30 s"):
        cut_windows(counting(), ["a"], ["c"], Lags(6, 4, 10), np.zeros(30))
    with pytest.raises(ShapeError, match=r"4 samples.*0 ahead"):
        Lags(0, 4)
    with pytest.raises(ShapeError, match=r"state that is not.*-1"):
        Lags(1, 4, -1)
