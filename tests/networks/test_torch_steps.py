from __future__ import annotations

import numpy as np
import pytest
import torch
from torch import nn

from gaitdisc.networks.shred import Shred
from gaitdisc.networks.torch_steps import TorchSteps
from gaitdisc.networks.training_settings import PRECISIONS, TrainingSettings, schedule_of


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


@pytest.mark.parametrize("cell", ["gru", "lstm"])
def test_steps_in_bfloat16_lead_nearly_where_those_in_float32_do(cell):
    x = torch.from_numpy(np.random.default_rng(0).normal(size=(64, 8)).astype(np.float32))
    y = x[:, 2:3] * x[:, 6:7]
    found = {}
    for precision in PRECISIONS:
        torch.manual_seed(0)
        network = Shred(8, 1, 2, nodes=8, cell=cell)
        schedule = schedule_of(64, 0.0, TrainingSettings(batch=16, learning_rate=1e-3))
        steps = TorchSteps(network, (x, y), (x, y), schedule, precision)
        before = steps.loss()
        steps.epoch(torch.arange(64), schedule.rates[0])
        assert {weights.dtype for weights in network.parameters()} == {torch.float32}
        found[precision] = before - steps.loss()
    assert found["float32"] > 0
    assert found["bfloat16"] == pytest.approx(found["float32"], rel=0.3)
    assert found["bfloat16"] != found["float32"]
