from __future__ import annotations

import pytest
import torch
from torch import nn

from gaitdisc.errors import TrainingError
from gaitdisc.networks.descent import check_loss, descend, epochs_of
from gaitdisc.networks.feedforward import FeedForward
from gaitdisc.networks.training_settings import TrainingSettings


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


def test_best_weights_are_restored_where_the_schedule_goes_on_and_worsens():
    slope = Slope()
    settings = TrainingSettings(epochs=50, batch=4, learning_rate=0.005)
    found = descend(slope, walked(3.0), walked(1.0), 0.0, settings)
    assert 1 < found.best_epoch < len(found.losses)
    assert found.losses[-1] > 100 * min(found.losses)  # it went on to 3 after it had passed 1
    assert check_loss(slope, walked(1.0)) == min(found.losses) == found.losses[found.best_epoch - 1]


def test_decay_pulls_matrices_to_zero_and_spares_offsets():
    weights = {}
    for decay in (0.0, 3.0):
        torch.manual_seed(0)
        network = nn.Sequential(nn.Linear(1, 1))
        x, y = walked(3.0)
        descend(network, (x, y + 2), (x, y + 2), decay, TrainingSettings(batch=50, learning_rate=0.05))
        weights[decay] = network[0].weight.item(), network[0].bias.item()
    assert weights[0.0] == pytest.approx((3.0, 2.0), abs=0.01)
    assert weights[3.0][0] < 2.7
    assert weights[3.0][1] == pytest.approx(2.0, abs=0.05)


def test_a_loss_that_explodes_names_the_learning_rate():
    settings = TrainingSettings(learning_rate=1e30)
    with pytest.raises(TrainingError, match=r"after epoch 1 of 1000 at learning rate 1e\+30\. Lower the learning rate"):
        descend(FeedForward(1, 1), walked(1.0), walked(1.0), 0.0, settings)


def test_progress_rises_to_one_epoch_by_epoch():
    told = []
    settings = TrainingSettings(batch=1)
    descend(Slope(), walked(1.0, 100), walked(1.0, 100), 0.0, settings, told.append)
    assert epochs_of(100, settings) == 20
    assert told == [epoch / 20 for epoch in range(1, 21)]
