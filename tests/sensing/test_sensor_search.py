import numpy as np

from gaitdisc.channel import Channel
from gaitdisc.recording import Recording
from gaitdisc.sensing.sensor_search import search_sensors
from gaitdisc.sensing.splits import split_within
from gaitdisc.sensing.windows import Lags, windows_of


def test_the_sensor_that_tells_most_comes_first_and_one_that_adds_nothing_last():
    rng = np.random.default_rng(0)
    one, other = rng.normal(size=(2, 3000))
    values = np.column_stack([one + other, one, other, one - other + 0.05 * rng.normal(size=3000)])
    channels = tuple(Channel(name, "angle", "deg") for name in ("sum", "one", "other", "difference"))
    recording = Recording(np.arange(3000) / 100, values, channels)
    windows = windows_of(recording, recording.names, recording.names, Lags(2, 1), np.zeros(3000))
    found = search_sensors(split_within([windows], "temporal", 0.01), channels, 3)
    assert found["fits"].tolist() == [4, 3, 2]
    assert set(found["added"][:2]) <= {"sum", "one", "other", "difference"}
    assert found["loss"].is_monotonic_decreasing
    assert 0.015 < found["rmse_deg"][1] < 0.08
