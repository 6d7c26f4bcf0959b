"""The dissertation's feed-forward network: log-sigmoid, radial basis, linear (section 4.2.2)."""

from __future__ import annotations

import torch
from torch import Tensor, nn


class FeedForward(nn.Module):
    """Three layers: log-sigmoid, radial basis exp(-n^2) with n = Wx + b, pure linear.

    The radial basis is that of a feed-forward layer: n is an inner product, not a distance to a centre.

    nodes: nodes of either hidden layer; the dissertation has 64
    Source: Ebers 2023, section 4.2.2: "each layer had 64 nodes". We read 49-64-64-8, with 7,880 parameters; a third
        layer of 64 linear nodes before the eight outputs would describe the same functions.

    >>> sum(weights.numel() for weights in FeedForward(49, 8).parameters())
    7880
    """

    def __init__(self, inputs: int, outputs: int, nodes: int = 64) -> None:
        super().__init__()
        self.sigmoid = nn.Linear(inputs, nodes)
        self.radial = nn.Linear(nodes, nodes)
        self.readout = nn.Linear(nodes, outputs)

    def features(self, x: Tensor) -> Tensor:
        """What the linear layer reads, (sample, node), of scaled inputs (sample, input)."""
        n = self.radial(torch.sigmoid(self.sigmoid(x)))
        return torch.exp(-n * n)

    def forward(self, x: Tensor) -> Tensor:
        """Scaled outputs (sample, output) of scaled inputs (sample, input)."""
        return self.readout(self.features(x))
