"""Steps of the descent by compiled code: the dissertation's network on the CPU, with torch's numbers to rounding."""

from __future__ import annotations

import numpy as np
import torch
from numpy.typing import NDArray
from torch import Tensor, nn

from gaitdisc.networks.feedforward import FeedForward
from gaitdisc.networks.fused_kernels import descend_epoch, mean_squared_error
from gaitdisc.networks.training_settings import Schedule


class FusedSteps:
    """Adam with decoupled decay on a `FeedForward` in float32 on the CPU, with gradients written by hand.

    Same weights to start from, same order of samples, same steps as `TorchSteps`: the two differ by rounding. Nothing
    is dispatched between two matrix products, and what lies between them is one pass over memory.

    part, check pair of Tensor ((sample, input), (sample, output)): scaled samples to descend on, and to check by
    """

    arithmetic = "fused"

    def __init__(
        self, network: FeedForward, part: tuple[Tensor, Tensor], check: tuple[Tensor, Tensor], schedule: Schedule
    ) -> None:
        self._network, self._schedule = network, schedule
        self._part, self._check = (tuple(t.contiguous().numpy() for t in pair) for pair in (part, check))
        self._nodes = network.radial.out_features
        self._weights = torch.cat([p.detach().reshape(-1) for p in matrices_then_offsets(network)]).numpy()
        self._moments = np.zeros((2, self._weights.size), np.float32)
        self._done = 0

    def epoch(self, order: Tensor, rates: NDArray[np.float64]) -> None:
        """Step through all samples once.

        order Tensor (sample,): in which the samples are seen
        rates (step,): learning rate of each step
        """
        number = self._done + 1 + np.arange(len(rates))
        self._done += len(rates)
        paces = np.empty((len(rates), 3), np.float32)
        paces[:, 0] = 1 - rates * self._schedule.decay
        paces[:, 1] = rates / (1 - 0.9**number)
        paces[:, 2] = 1 / np.sqrt(1 - 0.999**number)
        x, y = self._part
        sizes = (self._nodes, self._schedule.batch)
        descend_epoch(self._weights, self._moments, x, y, order.numpy(), sizes, paces)

    def loss(self) -> float:
        """Mean squared error of the scaled outputs on the check part."""
        x, y = self._check
        return float(mean_squared_error(self._weights, x, y, self._nodes))

    def weights(self) -> NDArray[np.float32]:
        """Copy of the weights as they are: a reference would follow the descent."""
        return self._weights.copy()

    def restore(self, weights: NDArray[np.float32]) -> None:
        """Give the network weights that it had before.

        weights (weight,): from `weights`
        """
        self._weights[:] = weights
        parameters = matrices_then_offsets(self._network)
        parts = torch.from_numpy(weights).split([p.numel() for p in parameters])
        with torch.no_grad():
            for parameter, values in zip(parameters, parts, strict=True):
                parameter.copy_(values.reshape(parameter.shape))


def matrices_then_offsets(network: FeedForward) -> tuple[Tensor, ...]:
    """Return the parameters in the order of the compiled code's one vector.

    >>> [tuple(p.shape) for p in matrices_then_offsets(FeedForward(3, 2, nodes=4))]
    [(4, 3), (4, 4), (2, 4), (4,), (4,), (2,)]
    """
    linear = (network.sigmoid, network.radial, network.readout)
    return (*(layer.weight for layer in linear), *(layer.bias for layer in linear))


def can_be_fused(network: nn.Module) -> bool:
    """Whether the compiled code computes this network: the dissertation's own, in float32, on the CPU.

    >>> can_be_fused(FeedForward(3, 2)), can_be_fused(FeedForward(3, 2).double()), can_be_fused(nn.Linear(3, 2))
    (True, False, False)
    """
    if type(network) is not FeedForward:  # a network made from it may compute something else
        return False
    return all(p.device.type == "cpu" and p.dtype == torch.float32 for p in network.parameters())
