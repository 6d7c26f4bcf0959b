from __future__ import annotations

import copy

import numpy as np
import pytest
import torch

from gaitdisc.networks.descent import TorchSteps
from gaitdisc.networks.feedforward import FeedForward
from gaitdisc.networks.fused_steps import FusedSteps, can_be_fused
from gaitdisc.networks.training_settings import TrainingSettings, schedule_of


def both(samples=1000, decay=0.3):
    """Fused and torch steps on copies of one network, a manufactured target, and their schedule."""
    torch.manual_seed(3)
    network = FeedForward(9, 3)
    x = torch.randn(samples, 9)
    y = torch.sin(x[:, :3]) + x[:, 3:6] * x[:, 6:]
    part, check = (x[:-100], y[:-100]), (x[-100:], y[-100:])
    schedule = schedule_of(len(part[0]), decay, TrainingSettings(batch=200))
    twin = copy.deepcopy(network)
    return (
        (network, FusedSteps(network, part, check, schedule)),
        (twin, TorchSteps(twin, part, check, schedule)),
        schedule,
    )


def test_weights_after_one_epoch_are_torchs():
    (fused, by_kernels), (twin, by_torch), schedule = both()
    before = copy.deepcopy(fused.state_dict())
    order = torch.randperm(900)
    for steps in (by_kernels, by_torch):
        steps.epoch(order, schedule.rates[0])
    assert by_kernels.loss() == pytest.approx(by_torch.loss(), rel=1e-5)
    by_kernels.restore(by_kernels.weights())
    for name, wanted in twin.state_dict().items():
        moved = (wanted - before[name]).norm()
        assert moved > 0
        assert (fused.state_dict()[name] - wanted).norm() <= 1e-4 * moved


def test_weights_are_a_copy_and_the_network_gets_what_is_restored():
    (network, steps), _, schedule = both()
    before = copy.deepcopy(network.state_dict())
    kept, loss = steps.weights(), steps.loss()
    steps.epoch(torch.arange(900), schedule.rates[0])
    assert steps.loss() != loss
    steps.restore(kept)
    assert steps.loss() == loss
    assert all(torch.equal(values, before[name]) for name, values in network.state_dict().items())
    steps.epoch(torch.arange(900), schedule.rates[0])
    assert not np.array_equal(steps.weights(), kept)  # what was restored is still a copy


def test_only_the_dissertations_own_network_in_float32_is_fused():
    class Made(FeedForward):
        """Could compute something else."""

    assert can_be_fused(FeedForward(3, 2, nodes=5))
    assert not can_be_fused(Made(3, 2))
    assert not can_be_fused(FeedForward(3, 2).double())
