from __future__ import annotations

import numpy as np
import torch

from gaitdisc.networks.feedforward import FeedForward


def test_the_dissertations_network_has_7880_parameters():
    assert sum(weights.numel() for weights in FeedForward(49, 8).parameters()) == 7880


def test_layers_are_log_sigmoid_radial_basis_linear():
    network = FeedForward(3, 2, nodes=5).double()
    weights = {name: values.detach().numpy() for name, values in network.named_parameters()}
    x = np.random.default_rng(0).normal(size=(7, 3))
    first = 1 / (1 + np.exp(-(x @ weights["sigmoid.weight"].T + weights["sigmoid.bias"])))
    second = np.exp(-((first @ weights["radial.weight"].T + weights["radial.bias"]) ** 2))
    third = second @ weights["readout.weight"].T + weights["readout.bias"]
    np.testing.assert_allclose(network(torch.from_numpy(x)).detach().numpy(), third, rtol=1e-12)
