import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from gaitdisc.channel import Channel
from gaitdisc.errors import ChannelError, SamplingError, SchemaError, ShapeError
from gaitdisc.reconstruction.windows import (
    Lags,
    cut_windows,
    fill_readings,
    hidden,
    missing_runs,
    present,
    stacked,
    thin_windows,
    with_missing,
)
from gaitdisc.recording import Recording, Samples


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
    with pytest.raises(ShapeError, match=r"spacing 4.*ahead 0"):
        Lags(0, 4)
    with pytest.raises(ShapeError, match=r"state that is not.*-1"):
        Lags(1, 4, -1)


def two(values):
    channels = (Channel("a", "angle", "deg"), Channel("b", "angle", "deg"))
    return Recording(np.arange(len(values)) / 100, np.array(values, float), channels)


@settings(max_examples=20, deadline=None)
@given(st.floats(0.0, 0.6), st.floats(1.0, 20.0))
def test_as_many_are_missing_as_asked_for_in_runs_as_long(share, run):
    lost = missing_runs(np.full(40, share), np.full(40, run), 5000, seed=3)
    assert lost.mean() == pytest.approx(share, abs=0.03)
    starts = (lost[1:] & ~lost[:-1]).sum()
    if share > 0.1:
        assert lost.sum() / starts == pytest.approx(max(run, 1 / (1 - share)), rel=0.15)


def test_readings_go_missing_in_the_sensors_alone():
    r = two(np.ones((2000, 2)))
    lost = with_missing(r, ["b"], 0.4, 0.1)
    assert np.isfinite(lost["a"]).all()
    assert np.isnan(lost["b"]).mean() == pytest.approx(0.4, abs=0.1)
    assert np.isfinite(with_missing(r, ["b"], 0.0, 0.1).values).all()


def test_what_stands_for_a_missing_reading():
    nan = np.nan
    r = two([[nan, 1], [2, nan], [nan, nan], [3, 4]])
    means = np.array([10.0, 20.0])
    assert fill_readings(r, ["a", "b"], "mean", means).values.tolist() == [[10, 1], [2, 20], [10, 20], [3, 4]]
    assert fill_readings(r, ["a", "b"], "last", means).values.tolist() == [[10, 1], [2, 1], [2, 1], [3, 4]]
    np.testing.assert_array_equal(fill_readings(r, ["a", "b"], "none", means).values, r.values)
    with pytest.raises(SchemaError, match=r"treatment of missing samples must be none, mean or last; found 'zero'"):
        fill_readings(r, ["a"], "zero", means[:1])


def test_every_second_window_is_hidden_in_part():
    rng = np.random.default_rng(0)
    x = rng.normal(size=(400, 30))
    names = tuple(str(k) for k in range(30))
    samples = Samples(x, x[:, :1], names, ("y",), np.arange(400.0), np.zeros(400))
    made = hidden(samples, 3)
    lost = np.isnan(made.x)
    assert not lost[::2].any()
    assert 0.2 < lost[1::2].mean() < 0.4
    np.testing.assert_array_equal(made.x[~lost], x[~lost])
    assert np.isfinite(made.y).all()
    assert hidden(samples, 3, seed=0).x.tobytes() == made.x.tobytes() != hidden(samples, 3, seed=1).x.tobytes()
