"""The networks: feed-forward, SHRED, and windows that carry over."""

from functools import partial

import numpy as np
import pytest
import torch
from hypothesis import given, settings
from hypothesis import strategies as st
from torch import nn

from gaitdisc.errors import ShapeError, TrainingError
from gaitdisc.models import networks
from gaitdisc.models.carried_windows import CarriedWindows, Linear, decoded, gru_step, lstm_step
from gaitdisc.models.networks import FeedForward, ShallowDecoder, Shred
from gaitdisc.models.trained_network import TrainedNetwork
from gaitdisc.models.trainer import train
from gaitdisc.models.training_settings import TrainingSettings
from gaitdisc.reconstruction.model_folder import load_weights, save_weights
from gaitdisc.recording import Samples, fit_scale

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
    monkeypatch.setattr(networks, "AT_ONCE", 3)
    torch.testing.assert_close(network(x), whole)


@pytest.mark.slow
def test_it_learns_what_needs_history_and_is_loaded_as_it_was_saved(echo, tmp_path):
    settings = TrainingSettings(epochs=20, batch=64, decays=(0.0,))
    done = train(echo.rows(slice(0, 500)), BUILD, settings, check=echo.rows(slice(510, 600)))
    later = echo.rows(slice(610, None))
    told = done.network(later.x)
    assert np.var(told - later.y) < 0.2 * np.var(later.y)
    save_weights(done.network, tmp_path / "shred.npz")
    np.testing.assert_array_equal(load_weights(tmp_path / "shred.npz", BUILD)(later.x), told)


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


@pytest.mark.slow
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
    with pytest.raises(TrainingError, match="must be finite"):
        train(holes.rows(slice(0, 500)), build, TrainingSettings(epochs=1))


def test_it_has_two_hidden_layers_and_its_readout_is_linear():
    network = ShallowDecoder(3, 18, 350, 400)
    assert sum(w.numel() for w in network.parameters()) == 4 * 350 + 351 * 400 + 401 * 18
    x = torch.rand(5, 3)
    torch.testing.assert_close(network(x), network.readout(network.features(x)))


def test_layers_are_log_sigmoid_radial_basis_linear():
    network = FeedForward(3, 2, nodes=5).double()
    weights = {name: values.detach().numpy() for name, values in network.named_parameters()}
    x = np.random.default_rng(0).normal(size=(7, 3))
    first = 1 / (1 + np.exp(-(x @ weights["sigmoid.weight"].T + weights["sigmoid.bias"])))
    second = np.exp(-((first @ weights["radial.weight"].T + weights["radial.bias"]) ** 2))
    third = second @ weights["readout.weight"].T + weights["readout.bias"]
    np.testing.assert_allclose(network(torch.from_numpy(x)).detach().numpy(), third, rtol=1e-12)


def untrained(count, sensors, **options):
    torch.manual_seed(0)
    rng = np.random.default_rng(0)
    x, y = rng.normal(30, 20, (60, count * sensors)), rng.normal(-5, 10, (60, 4))
    names = tuple(f"x{k}" for k in range(count * sensors)), tuple(f"y{k}" for k in range(4))
    return TrainedNetwork(*names, fit_scale(x), fit_scale(y), Shred(count * sensors, 4, sensors, nodes=6, **options))


def read_whole(readings, count, spacing):
    last = np.arange((count - 1) * spacing, len(readings))
    rows = last[:, None] + (np.arange(count) - count + 1) * spacing
    return readings[rows].reshape(len(last), -1)


@settings(max_examples=12, deadline=None)
@given(st.integers(1, 7), st.integers(1, 4), st.integers(1, 3), st.sampled_from(["gru", "lstm"]), st.integers(1, 2))
def test_it_tells_what_the_torch_network_tells(count, spacing, sensors, cell, layers):
    network = untrained(count, sensors, cell=cell, layers=layers)
    readings = np.random.default_rng(1).normal(30, 20, ((count - 1) * spacing + 9, sensors))
    carried = CarriedWindows(network, count, spacing)
    told = np.array([carried.update(reading) for reading in readings])
    reach = (count - 1) * spacing
    assert np.isnan(told[:reach]).all()
    windows = read_whole(readings, count, spacing)
    np.testing.assert_allclose(told[reach:] / 10, network(windows) / 10, atol=1e-6)  # float32; 10 is the sd
    exact = network.network.double()(torch.from_numpy(network.x_scale.scaled(windows)))
    np.testing.assert_allclose(told[reach:], network.y_scale.unscaled(exact.detach().numpy()), rtol=1e-12, atol=1e-12)


def test_a_missing_reading_spoils_the_windows_that_hold_it_and_no_other():
    carried = CarriedWindows(untrained(3, 1), 3, 2)
    for value in range(10):
        carried.update(np.array([float(value)]))
    spoilt = [bool(np.isnan(carried.update(np.array([np.nan if k == 0 else 1.0]))).all()) for k in range(7)]
    assert spoilt == [True, False, True, False, True, False, False]


@pytest.mark.parametrize("cell", ["gru", "lstm"])
def test_an_input_that_did_not_vary_weighs_nothing(cell):
    network = untrained(2, 2, cell=cell)
    x = np.random.default_rng(0).normal(size=(40, 4))
    x[:, [1, 3]] = 7.0
    still = TrainedNetwork(network.inputs, network.outputs, fit_scale(x), network.y_scale, network.network)
    one, other = CarriedWindows(still, 2, 1), CarriedWindows(still, 2, 1)
    for value in range(3):
        a, b = one.update(np.array([value, 7.0])), other.update(np.array([value, -100.0]))
    np.testing.assert_array_equal(a, b)


def test_a_masked_network_tells_on_while_readings_are_missing():
    network = untrained(3, 2, masked=True)
    readings = np.random.default_rng(1).normal(30, 20, (40, 2))
    readings[5:20, 0] = np.nan
    readings[10:30, 1] = np.nan
    carried = CarriedWindows(network, 3, 2)
    told = np.array([carried.update(reading) for reading in readings])[4:]
    windows = read_whole(readings, 3, 2)
    silent = np.isnan(windows).all(axis=1)
    assert silent.sum() == 6
    assert (np.isnan(told).all(axis=1) == silent).all()
    np.testing.assert_allclose(told[~silent], network(windows)[~silent], atol=1e-5)


def laid_out(weight, bias):
    return Linear(np.ascontiguousarray(weight.detach().numpy().T), bias.detach().numpy())


def both_of(cell):
    return laid_out(cell.weight_ih, cell.bias_ih), laid_out(cell.weight_hh, cell.bias_hh)


def test_one_step_of_torchs_cells():
    torch.manual_seed(0)
    x, h, c = torch.randn(5, 3).double(), torch.randn(5, 4).double(), torch.randn(5, 4).double()
    gru, lstm = nn.GRUCell(3, 4).double(), nn.LSTMCell(3, 4).double()
    np.testing.assert_allclose(gru_step(x.numpy(), h.numpy(), *both_of(gru)), gru(x, h).detach(), atol=1e-14)
    after, kept = lstm_step(x.numpy(), h.numpy(), c.numpy(), *both_of(lstm))
    wanted = [part.detach().numpy() for part in lstm(x, (h, c))]
    np.testing.assert_allclose([after, kept], wanted, atol=1e-14)


def test_states_stay_bounded_however_far_out_a_reading_is():
    torch.manual_seed(0)
    after = gru_step(np.full((1, 3), 1e6), np.zeros((1, 4)), *both_of(nn.GRUCell(3, 4).double()))
    assert np.isfinite(after).all() and np.abs(after).max() <= 1.0


def test_the_decoder_is_torchs():
    torch.manual_seed(0)
    network = ShallowDecoder(6, 3).double()
    layers = [laid_out(one.weight, one.bias) for one in (network.first, network.second, network.readout)]
    x = torch.randn(6).double()
    np.testing.assert_allclose(decoded(x.numpy(), *layers), network(x[None])[0].detach(), atol=1e-13)
