from __future__ import annotations

import torch
from torch import nn

from gaitdisc.networks.schedule import schedule_of
from gaitdisc.networks.torch_steps import TorchSteps
from gaitdisc.networks.training_settings import TrainingSettings


def test_one_epoch_is_that_of_a_loop_written_out():
    settings = TrainingSettings(batch=4)
    torch.manual_seed(0)
    x, y = torch.randn(10, 3), torch.randn(10, 2)
    ours, theirs = nn.Linear(3, 2), nn.Linear(3, 2)
    theirs.load_state_dict(ours.state_dict())
    schedule = schedule_of(10, 0.5, settings)
    order = torch.randperm(10)
    TorchSteps(ours, (x, y), (x, y), schedule).epoch(order, schedule.rates[0])
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
    schedule = schedule_of(8, 0.0, TrainingSettings())
    steps = TorchSteps(network, (x, 5 * x), (x, 5 * x), schedule)
    before, loss = steps.weights(), steps.loss()
    steps.epoch(torch.arange(8), schedule.rates[0])
    assert steps.loss() < loss
    steps.restore(before)
    assert steps.loss() == loss
