"""Steps of the descent by torch: the reference for every network, and the way on a GPU."""

from __future__ import annotations

import copy
from typing import Any

import numpy as np
import torch
from numpy.typing import NDArray
from torch import Tensor, nn

from gaitdisc.networks.training_settings import Schedule


class TorchSteps:
    """Adam with decoupled decay on any torch module.

    Decay acts on weight matrices only.

    part, check pair of Tensor ((sample, input), (sample, output)): scaled samples to descend on, and to check by; on
        the device of the network
    precision: of the matrix products: `float32` or `bfloat16`; weights stay float32
    Source: Loshchilov and Hutter 2019, Decoupled weight decay regularization.
    """

    arithmetic = "torch"

    def __init__(
        self,
        network: nn.Module,
        part: tuple[Tensor, Tensor],
        check: tuple[Tensor, Tensor],
        schedule: Schedule,
        precision: str = "float32",
    ) -> None:
        self._network, self._part, self._check, self._batch = network, part, check, schedule.batch
        self._short = precision == "bfloat16"
        matrices = [p for p in network.parameters() if p.ndim > 1]
        others = [p for p in network.parameters() if p.ndim <= 1]
        groups = [{"params": matrices, "weight_decay": schedule.decay}, {"params": others, "weight_decay": 0.0}]
        self._adam = torch.optim.AdamW(groups, fused=True)

    def epoch(self, order: Tensor, rates: NDArray[np.float64]) -> None:
        """Step through all samples once.

        order Tensor (sample,): in which the samples are seen
        rates (step,): learning rate of each step
        """
        self._network.train()
        x, y = (values[order.to(values.device)] for values in self._part)
        for step, rate in enumerate(rates.tolist()):
            rows = slice(step * self._batch, (step + 1) * self._batch)
            for group in self._adam.param_groups:
                group["lr"] = rate
            self._adam.zero_grad()
            with torch.autocast(x.device.type, torch.bfloat16, enabled=self._short):
                estimate = self._network(x[rows])
            nn.functional.mse_loss(estimate.float(), y[rows]).backward()
            self._adam.step()

    def loss(self) -> float:
        """Mean squared error of the scaled outputs on the check part."""
        self._network.eval()
        with torch.no_grad():
            return float(nn.functional.mse_loss(self._network(self._check[0]), self._check[1]))

    def weights(self) -> dict[str, Any]:
        """Copy of the weights as they are: a reference would follow the descent."""
        return copy.deepcopy(self._network.state_dict())

    def restore(self, weights: dict[str, Any]) -> None:
        """Give the network weights that it had before."""
        self._network.load_state_dict(weights)
