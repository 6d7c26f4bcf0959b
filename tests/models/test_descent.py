from dataclasses import replace

import numpy as np
import pytest
import torch
from torch import nn

from gaitdisc.errors import TrainingError
from gaitdisc.models.networks import FeedForward, Shred
from gaitdisc.models.trainer import TorchSteps, descend
from gaitdisc.models.training_settings import PRECISIONS, ScaledSamples, TrainingSettings, count_epochs, make_schedule


def test_one_epoch_is_that_of_a_loop_written_out():
    settings = TrainingSettings(batch=4)
    torch.manual_seed(0)
    x, y = torch.randn(10, 3), torch.randn(10, 2)
    ours, theirs = nn.Linear(3, 2), nn.Linear(3, 2)
    theirs.load_state_dict(ours.state_dict())
    schedule = make_schedule(10, 0.5, settings)
    order = torch.randperm(10)
    TorchSteps(ours, ScaledSamples(x, y), ScaledSamples(x, y), schedule).epoch(order, schedule.rates[0])
    groups = [{"params": [theirs.weight], "weight_decay": 0.5}, {"params": [theirs.bias], "weight_decay": 0.0}]
    adam = torch.optim.AdamW(groups, lr=settings.learning_rate)
    for start, rate in zip((0, 4, 8), schedule.rates[0].tolist(), strict=True):
        rows = order[start : start + 4]
        for group in adam.param_groups:
            group["lr"] = rate
        adam.zero_grad()
        ((theirs(x[rows]) - y[rows]) ** 2).mean().backward()
        adam.step()
    assert torch.allclose(ours.weight, theirs.weight, rtol=1e-5, atol=1e-7)
    assert torch.allclose(ours.bias, theirs.bias, rtol=1e-5, atol=1e-7)


def test_weights_are_a_copy_and_come_back():
    network = nn.Linear(1, 1)
    x = torch.ones(8, 1)
    schedule = make_schedule(8, 0.0, TrainingSettings())
    steps = TorchSteps(network, ScaledSamples(x, 5 * x), ScaledSamples(x, 5 * x), schedule)
    before, loss = steps.weights(), steps.loss()
    steps.epoch(torch.arange(8), schedule.rates[0])
    assert steps.loss() < loss
    steps.restore(before)
    assert steps.loss() == loss


@pytest.mark.parametrize("cell", ["gru", "lstm"])
def test_steps_in_bfloat16_lead_nearly_where_those_in_float32_do(cell):
    x = torch.from_numpy(np.random.default_rng(0).normal(size=(64, 8)).astype(np.float32))
    y = x[:, 2:3] * x[:, 6:7]
    found = {}
    for precision in PRECISIONS:
        torch.manual_seed(0)
        network = Shred(8, 1, 2, nodes=8, cell=cell)
        schedule = make_schedule(64, 0.0, TrainingSettings(batch=16, learning_rate=1e-3))
        steps = TorchSteps(network, ScaledSamples(x, y), ScaledSamples(x, y), schedule, precision)
        before = steps.loss()
        steps.epoch(torch.arange(64), schedule.rates[0])
        assert {weights.dtype for weights in network.parameters()} == {torch.float32}
        found[precision] = before - steps.loss()
    assert found["float32"] > 0
    assert found["bfloat16"] == pytest.approx(found["float32"], rel=0.3)
    assert (found["bfloat16"] != found["float32"]) == ("AVX512" in torch.backends.cpu.get_cpu_capability())


class Slope(nn.Module):
    """y = w x, from w = 0."""

    def __init__(self):
        super().__init__()
        self.readout = nn.Linear(1, 1, bias=False)
        nn.init.zeros_(self.readout.weight)

    def forward(self, x):
        return self.readout(x)


def walked(target, count=200):
    x = torch.linspace(-1, 1, count)[:, None]
    return ScaledSamples(x, target * x)


def descended(network, part, check, decay, settings, *progress):
    return descend(network, part, check, make_schedule(len(part[0]), decay, settings), settings, *progress)


def loss_on(network, check):
    return TorchSteps(network, check, check, make_schedule(len(check[0]), 0.0, TrainingSettings())).loss()


def test_best_weights_are_restored_where_the_schedule_goes_on_and_worsens():
    slope = Slope()
    settings = TrainingSettings(epochs=50, batch=4, learning_rate=0.005)
    losses = descended(slope, walked(3.0), walked(1.0), 0.0, settings)
    assert losses[0] > min(losses)
    assert losses[-1] > 100 * min(losses)  # it went on to 3 after it had passed 1
    assert loss_on(slope, walked(1.0)) == min(losses)


def test_a_descent_without_gain_ends_after_its_patience_and_a_rate_may_stay():
    slope = Slope()
    settings = TrainingSettings(epochs=50, batch=4, learning_rate=0.005, falling=False, patience=5)
    assert set(make_schedule(200, 0.0, settings).rates.ravel()) == {0.005}
    losses = descended(slope, walked(3.0), walked(1.0), 0.0, settings)
    assert len(losses) == losses.index(min(losses)) + 6 < 50
    assert loss_on(slope, walked(1.0)) == min(losses)


def test_decay_pulls_matrices_to_zero_and_spares_offsets():
    weights = {}
    for decay in (0.0, 3.0):
        torch.manual_seed(0)
        network = nn.Sequential(nn.Linear(1, 1))
        x, y = walked(3.0)
        part = ScaledSamples(x, y + 2)
        descended(network, part, part, decay, TrainingSettings(batch=50, learning_rate=0.05))
        weights[decay] = network[0].weight.item(), network[0].bias.item()
    assert weights[0.0] == pytest.approx((3.0, 2.0), abs=0.01)
    assert weights[3.0][0] < 2.7
    assert weights[3.0][1] == pytest.approx(2.0, abs=0.05)


@pytest.mark.parametrize("arithmetic", ["auto", "torch"])
def test_a_loss_that_explodes_names_the_learning_rate(arithmetic):
    settings = TrainingSettings(learning_rate=1e30)
    with pytest.raises(TrainingError, match=r"1 of 1000.*1e\+30"):
        descended(FeedForward(1, 1), walked(1.0), walked(1.0), 0.0, replace(settings, arithmetic=arithmetic))


def test_progress_rises_to_one_epoch_by_epoch():
    told = []
    settings = TrainingSettings(batch=1)
    descended(Slope(), walked(1.0, 100), walked(1.0, 100), 0.0, settings, told.append)
    assert count_epochs(100, settings) == 20
    assert told == [epoch / 20 for epoch in range(1, 21)]


def test_the_dissertations_network_is_fused_with_torchs_losses():
    settings = TrainingSettings(batch=20)
    losses = {}
    for arithmetic in ("auto", "torch"):
        torch.manual_seed(0)
        chosen = replace(settings, arithmetic=arithmetic)
        losses[arithmetic] = descended(FeedForward(1, 1), walked(3.0), walked(2.0), 0.1, chosen)
    assert losses["auto"] != losses["torch"]
    assert losses["auto"][:5] == pytest.approx(losses["torch"][:5], rel=1e-3)
