from functools import partial

import numpy as np
import pytest
import torch

from gaitdisc.errors import ShapeError, TrainingError
from gaitdisc.networks import shred
from gaitdisc.networks.shred import ShallowDecoder, Shred
from gaitdisc.networks.trained_network import load_network, save_network
from gaitdisc.networks.trainer import train
from gaitdisc.networks.training_settings import TrainingSettings
from gaitdisc.recording import Samples

BUILD = partial(Shred, sensors=1, nodes=16)


@pytest.fixture(scope="module")
def echo():
    """The state is what the sensor read five samples ago: no model without history can tell it."""
    noise = np.random.default_rng(0).normal(size=700)
    x = np.lib.stride_tricks.sliding_window_view(noise, 6)
    time = np.arange(len(x)) / 100
    names = tuple(f"{k} ago" for k in range(5, -1, -1))
    return Samples(np.array(x), np.array(x[:, :1]), names, ("state",), time, time % 1)


def test_readings_are_read_oldest_first_and_sensors_side_by_side():
    torch.manual_seed(0)
    network = Shred(6, 2, 2, nodes=4)
    x = torch.rand(3, 6)
    last = network.recurrent(x.reshape(3, 3, 2))[1][0]
    torch.testing.assert_close(network.features(x), network.decoder.features(last))


@pytest.mark.parametrize("cell", ["gru", "lstm"])
def test_the_dissertations_size(cell):
    gates = {"gru": 3, "lstm": 4}[cell]
    network = Shred(75, 18, 3, 64, 2, cell)
    wanted = gates * (64 * 3 + 64 * 64 + 128) + gates * (2 * 64 * 64 + 128)
    assert sum(w.numel() for w in network.recurrent.parameters()) == wanted


def test_many_windows_are_read_in_parts_with_the_same_numbers(monkeypatch):
    network, x = Shred(6, 2, 2), torch.rand(10, 6)
    whole = network(x)
    monkeypatch.setattr(shred, "AT_ONCE", 3)
    torch.testing.assert_close(network(x), whole)


def test_it_learns_what_needs_history_and_is_loaded_as_it_was_saved(echo, tmp_path):
    settings = TrainingSettings(epochs=20, batch=64, decays=(0.0,))
    done = train(echo.rows(slice(0, 500)), BUILD, settings, check=echo.rows(slice(510, 600)))
    later = echo.rows(slice(610, None))
    told = done.network(later.x)
    assert np.var(told - later.y) < 0.2 * np.var(later.y)
    save_network(done.network, tmp_path / "shred.npz")
    np.testing.assert_array_equal(load_network(tmp_path / "shred.npz", BUILD)(later.x), told)


def test_a_window_that_lacks_a_reading():
    with pytest.raises(ShapeError, match="7 numbers"):
        Shred(7, 2, 2)


def test_a_masked_network_reads_the_mean_and_that_it_is_none():
    torch.manual_seed(0)
    network, x = Shred(6, 2, 2, masked=True), torch.rand(4, 6)
    lost = x.clone()
    lost[:, 3] = torch.nan
    mean = torch.where(lost.isnan(), 0.0, lost)
    assert network(lost).isfinite().all()
    assert not torch.allclose(network(lost), network(mean))  # a value of 0 is not a missing one
    assert Shred(6, 2, 2)(lost).isnan().all()


def test_missing_readings_in_training(echo):
    rng = np.random.default_rng(0)
    holes = Samples(
        np.where(rng.random(echo.x.shape) < 0.3, np.nan, echo.x),
        *(getattr(echo, n) for n in ("y", "inputs", "outputs", "time", "phi")),
    )
    build = partial(BUILD, masked=True)
    settings = TrainingSettings(epochs=1, batch=64, decays=(0.0,), missing_inputs=True)
    done = train(holes.rows(slice(0, 500)), build, settings, check=holes.rows(slice(510, 600)))
    told = done.network(holes.x[610:])
    there = np.isfinite(holes.x[610:, 0])
    error = (told - echo.y[610:])[:, 0] ** 2
    assert np.mean(error[there]) < 0.3 < np.mean(error[~there])
    with pytest.raises(TrainingError, match="needs finite numbers"):
        train(holes.rows(slice(0, 500)), build, TrainingSettings(epochs=1))


def test_it_has_two_hidden_layers_and_its_readout_is_linear():
    network = ShallowDecoder(3, 18, 350, 400)
    assert sum(w.numel() for w in network.parameters()) == 4 * 350 + 351 * 400 + 401 * 18
    x = torch.rand(5, 3)
    torch.testing.assert_close(network(x), network.readout(network.features(x)))
