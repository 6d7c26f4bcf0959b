from itertools import combinations

import numpy as np
import pytest

from gaitdisc.channel import Channel
from gaitdisc.errors import ChannelError
from gaitdisc.models.fourier_ridge import fit_fourier_ridge
from gaitdisc.reconstruction.sensor_search import search_sensors
from gaitdisc.reconstruction.windows import Lags, cut_windows, split_within
from gaitdisc.recording import Recording

NAMES = ("sum", "one", "other", "difference", "noise")


@pytest.fixture(scope="module")
def channels():
    return tuple(Channel(name, "angle", "deg") for name in NAMES)


@pytest.fixture(scope="module")
def parts(channels):
    rng = np.random.default_rng(0)
    one, other, noise = rng.normal(size=(3, 3000))
    close = one - other + 0.05 * rng.normal(size=3000)
    recording = Recording(np.arange(3000) / 100, np.column_stack([one + other, one, other, close, noise]), channels)
    windows = cut_windows(recording, recording.names, recording.names, Lags(2, 1), np.zeros(3000))
    return split_within([windows], "temporal", 0.01)


def test_two_sensors_tell_four_channels_and_the_fifth_must_be_read_itself(parts, channels):
    found = search_sensors([parts], channels, 4)
    assert found["fits"].tolist() == [5, 10, 10, 2]
    assert found["loss"].is_monotonic_decreasing
    assert "noise" in found["names"][2]
    assert found["rmse_deg"][2] < 0.08 < found["rmse_deg"][0]
    assert (found["seconds"] >= 0).all()


def test_the_loss_is_that_of_ridge_regression_on_the_windows(parts, channels):
    found = search_sensors([parts], channels, 2)
    read = [NAMES.index(name) for name in found["names"][1].split(", ")]
    rest = [k for k in range(5) if k not in read]
    columns = [k for k in range(parts.fitted().x.shape[1]) if k % 5 in read]

    def some(samples):
        names = tuple(samples.inputs[k] for k in columns), tuple(samples.outputs[k] for k in rest)
        return type(samples)(samples.x[:, columns], samples.y[:, rest], *names, samples.time, samples.phi)

    model = fit_fourier_ridge(some(parts.fitted()), some(parts.checked()))
    test = some(parts.tested())
    rmse = np.sqrt(np.mean((model(test.x) - test.y) ** 2))
    assert found["rmse_deg"][1] == pytest.approx(rmse, rel=1e-3)


def test_the_best_pair_is_the_best_of_all_pairs(parts, channels):
    found = search_sensors([parts], channels, 2)
    pairs = [", ".join(pair) for pair in combinations(NAMES, 2)]
    assert found["names"][1] in pairs
    assert "noise" not in found["names"][0]


def test_a_translation_is_neither_a_candidate_nor_counted(parts, channels):
    moved = (*channels[:4], Channel("noise", "translation", "m"))
    found = search_sensors([parts], moved, 3)
    assert found["fits"].tolist() == [4, 6, 4]
    assert "noise" not in found["names"][2]


def test_people_are_searched_together(parts, channels):
    one, two = search_sensors([parts], channels, 2), search_sensors([parts, parts], channels, 2)
    assert one["names"].tolist() == two["names"].tolist()
    assert two["loss"].to_numpy() == pytest.approx(one["loss"].to_numpy())
    assert two["fits"].tolist() == [10, 20]


def test_no_sensor_is_refused_in_words(parts, channels):
    with pytest.raises(ChannelError, match=r"least.*0.*channels 5"):
        search_sensors([parts], channels, 0)
