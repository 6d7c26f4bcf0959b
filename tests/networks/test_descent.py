from __future__ import annotations

from dataclasses import replace

import pytest
import torch
from torch import nn

from gaitdisc.errors import TrainingError
from gaitdisc.networks.descent import descend
from gaitdisc.networks.feedforward import FeedForward
from gaitdisc.networks.torch_steps import TorchSteps
from gaitdisc.networks.training_settings import TrainingSettings, epochs_of, schedule_of


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
    return x, target * x


def descended(network, part, check, decay, settings, *progress):
    return descend(network, part, check, schedule_of(len(part[0]), decay, settings), settings, *progress)


def loss_on(network, check):
    return TorchSteps(network, check, check, schedule_of(len(check[0]), 0.0, TrainingSettings())).loss()


def test_best_weights_are_restored_where_the_schedule_goes_on_and_worsens():
    slope = Slope()
    settings = TrainingSettings(epochs=50, batch=4, learning_rate=0.005)
    found = descended(slope, walked(3.0), walked(1.0), 0.0, settings)
    assert 1 < found.best_epoch < len(found.losses)
    assert found.losses[-1] > 100 * min(found.losses)  # it went on to 3 after it had passed 1
    assert loss_on(slope, walked(1.0)) == min(found.losses) == found.losses[found.best_epoch - 1]


def test_a_descent_without_gain_ends_after_its_patience_and_a_rate_may_stay():
    slope = Slope()
    settings = TrainingSettings(epochs=50, batch=4, learning_rate=0.005, falling=False, patience=5)
    assert set(schedule_of(200, 0.0, settings).rates.ravel()) == {0.005}
    found = descended(slope, walked(3.0), walked(1.0), 0.0, settings)
    assert len(found.losses) == found.best_epoch + 5 < 50
    assert loss_on(slope, walked(1.0)) == min(found.losses)


def test_decay_pulls_matrices_to_zero_and_spares_offsets():
    weights = {}
    for decay in (0.0, 3.0):
        torch.manual_seed(0)
        network = nn.Sequential(nn.Linear(1, 1))
        x, y = walked(3.0)
        descended(network, (x, y + 2), (x, y + 2), decay, TrainingSettings(batch=50, learning_rate=0.05))
        weights[decay] = network[0].weight.item(), network[0].bias.item()
    assert weights[0.0] == pytest.approx((3.0, 2.0), abs=0.01)
    assert weights[3.0][0] < 2.7
    assert weights[3.0][1] == pytest.approx(2.0, abs=0.05)


@pytest.mark.parametrize("arithmetic", ["auto", "torch"])
def test_a_loss_that_explodes_names_the_learning_rate(arithmetic):
    settings = TrainingSettings(learning_rate=1e30)
    with pytest.raises(TrainingError, match=r"after epoch 1 of 1000 at learning rate 1e\+30\. Take another seed"):
        descended(FeedForward(1, 1), walked(1.0), walked(1.0), 0.0, replace(settings, arithmetic=arithmetic))


def test_progress_rises_to_one_epoch_by_epoch():
    told = []
    settings = TrainingSettings(batch=1)
    descended(Slope(), walked(1.0, 100), walked(1.0, 100), 0.0, settings, told.append)
    assert epochs_of(100, settings) == 20
    assert told == [epoch / 20 for epoch in range(1, 21)]


def test_the_dissertations_network_is_fused_with_torchs_losses_and_another_is_not():
    settings = TrainingSettings(batch=20)
    found = {}
    for arithmetic in ("auto", "torch"):
        torch.manual_seed(0)
        chosen = replace(settings, arithmetic=arithmetic)
        found[arithmetic] = descended(FeedForward(1, 1), walked(3.0), walked(2.0), 0.1, chosen)
    assert (found["auto"].arithmetic, found["torch"].arithmetic) == ("fused", "torch")
    assert found["auto"].losses[:5] == pytest.approx(found["torch"].losses[:5], rel=1e-3)
    assert descended(Slope(), walked(1.0), walked(1.0), 0.0, settings).arithmetic == "torch"
