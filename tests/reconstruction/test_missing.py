import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from gaitdisc.channel import Channel
from gaitdisc.errors import SchemaError
from gaitdisc.reconstruction.windows import fill_readings, hidden, missing_runs, with_missing
from gaitdisc.recording import Recording, Samples


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
