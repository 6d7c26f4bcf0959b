from __future__ import annotations

import numpy as np
import torch

from gaitdisc.networks.feedforward import FeedForward
from gaitdisc.networks.readout import PENALTIES, choose_penalty, solve_readout


def features_and_noise(count=300, noise=0.0, seed=0):
    torch.manual_seed(seed)
    network = FeedForward(2, 1, nodes=4)
    x = torch.randn(count, 2)
    with torch.no_grad():
        y = network.features(x) @ torch.tensor([[1.0], [-2.0], [0.5], [3.0]]) + 4 + noise * torch.randn(count, 1)
    return network, x, y


def test_the_solution_is_the_minimum_of_the_penalised_squares():
    network, x, y = features_and_noise(noise=0.3)
    solve_readout(network, (x, y), 0.01)
    h = network.features(x).detach().double().numpy()
    w = network.readout.weight.detach().double().numpy()[0]
    rest = y.double().numpy()[:, 0] - h @ w - float(network.readout.bias.detach())
    np.testing.assert_allclose(h.T @ rest / len(h), 0.01 * w, atol=1e-5)
    np.testing.assert_allclose(rest.mean(), 0.0, atol=1e-6)


def test_the_penalty_is_weak_without_noise_and_strong_for_nothing_but_noise():
    network, x, y = features_and_noise()
    part, check = (x[:200], y[:200]), (x[200:], y[200:])
    before = network.readout.weight.detach().clone()
    assert choose_penalty(network, part, check)[0] == PENALTIES[0]
    torch.manual_seed(1)
    assert choose_penalty(network, (x[:20], torch.randn(20, 1)), (x[200:], torch.randn(100, 1)))[0] >= 0.01
    assert torch.equal(before, network.readout.weight)
