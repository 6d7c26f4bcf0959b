"""The shallow decoder network: two hidden layers from what is known now to the state, without history."""

from __future__ import annotations

import torch
from torch import Tensor, nn


class ShallowDecoder(nn.Module):
    """Two layers of rectified linear nodes, and a linear one.

    first, second: nodes of the hidden layers; the code of SHRED has 350 and 400
    Source: Erichson et al. 2020, Shallow neural networks for fluid flow reconstruction with limited sensors.

    >>> ShallowDecoder(3, 18)(torch.zeros(2, 3)).shape
    torch.Size([2, 18])
    """

    def __init__(self, inputs: int, outputs: int, first: int = 128, second: int = 128) -> None:
        super().__init__()
        self.first = nn.Linear(inputs, first)
        self.second = nn.Linear(first, second)
        self.readout = nn.Linear(second, outputs)

    def features(self, x: Tensor) -> Tensor:
        """Return what the linear layer reads, (sample, node).

        x Tensor (sample, input): scaled inputs
        """
        return torch.relu(self.second(torch.relu(self.first(x))))

    def forward(self, x: Tensor) -> Tensor:
        """Scaled states, (sample, state).

        x Tensor (sample, input): scaled inputs
        """
        return self.readout(self.features(x))
