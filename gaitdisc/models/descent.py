"""The one loop over epochs: Adam with decoupled decay, a cosine, and the best weights kept by copy."""

from __future__ import annotations

import copy
import math
from collections.abc import Callable
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any, cast

import torch
from torch import Tensor, nn

from gaitdisc.errors import TrainingError
from gaitdisc.models.feedforward import FeedForward
from gaitdisc.models.training_settings import ScaledSamples, Schedule, TrainingSettings
from gaitdisc.recording.arrays import Values

if TYPE_CHECKING:
    from gaitdisc.models.fused_steps import FusedSteps


class TorchSteps:
    """Adam with decoupled decay on any torch module.

    Decay acts on weight matrices only; weights stay float32.

    part, check: what it descends on, and is checked by
    precision: of the matrix products, `float32` or `bfloat16` (needs AVX-512 or a GPU: else torch has no LSTM)
    Source: Loshchilov and Hutter 2019, Decoupled weight decay regularization.
    """

    arithmetic = "torch"

    def __init__(
        self,
        network: nn.Module,
        part: ScaledSamples,
        check: ScaledSamples,
        schedule: Schedule,
        precision: str = "float32",
    ) -> None:
        self._network, self._part, self._check, self._batch = network, part, check, schedule.batch
        able = part.x.is_cuda or "AVX512" in torch.backends.cpu.get_cpu_capability()
        self._short = able and precision == "bfloat16"
        matrices = [p for p in network.parameters() if p.ndim > 1]
        others = [p for p in network.parameters() if p.ndim <= 1]
        groups = [{"params": matrices, "weight_decay": schedule.decay}, {"params": others, "weight_decay": 0.0}]
        self._adam = torch.optim.AdamW(groups, fused=True)

    def epoch(self, order: Tensor, rates: Values) -> None:
        """Step through all samples once, in an order (sample,), at the learning rate of each step (step,)."""
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
            return float(nn.functional.mse_loss(self._network(self._check.x), self._check.y))

    def weights(self) -> dict[str, Any]:
        """Copy of the weights as they are: a reference would follow the descent."""
        return copy.deepcopy(self._network.state_dict())

    def restore(self, weights: dict[str, Any]) -> None:
        """Give the network weights that it had before."""
        self._network.load_state_dict(weights)


@dataclass(frozen=True)
class Descent:
    """How the loss on the check part went, epoch by epoch."""

    losses: tuple[float, ...]  # mean squared error of the scaled outputs on the check part, after every epoch
    best_epoch: int  # epoch, from 1, whose weights the network has now
    arithmetic: str


def descend(
    network: nn.Module,
    part: ScaledSamples,
    check: ScaledSamples,
    schedule: Schedule,
    settings: TrainingSettings,
    progress: Callable[[float], None] = lambda _: None,
) -> Descent:
    """Train a network and give it back the weights that did best on the check part.

    Decay acts on weight matrices only. The best weights are kept as a copy: a reference would follow the descent.

    part, check: what it descends on, and is checked by after each epoch
    Source: Loshchilov and Hutter 2019, Decoupled weight decay regularization. The dissertation does not say how it
        trained.
    """
    steps: TorchSteps | FusedSteps | None = None
    if settings.arithmetic == "auto" and settings.precision == "float32":
        from gaitdisc.models.fused_steps import FusedSteps, can_be_fused

        if can_be_fused(network):
            steps = FusedSteps(cast(FeedForward, network), part, check, schedule)
    steps = steps or TorchSteps(network, part, check, schedule, settings.precision)
    order = torch.Generator().manual_seed(settings.seed)
    losses: list[float] = []
    best: Any = steps.weights()
    epochs = len(schedule.rates)
    for epoch in range(1, epochs + 1):
        steps.epoch(torch.randperm(len(part.x), generator=order), schedule.rates[epoch - 1])
        losses.append(steps.loss())
        if not math.isfinite(losses[-1]):
            raise TrainingError(
                "the training loss must stay finite",
                f"it was {losses[-1]} after epoch {epoch} of {epochs} at learning rate {schedule.rates[0, 0]:g}",
                "Use another seed or a tenth of the learning rate. Check the findings for samples far out of range.",
            )
        if losses[-1] <= min(losses):
            best = steps.weights()
        progress(epoch / epochs)
        if settings.patience and epoch - losses.index(min(losses)) > settings.patience:
            break
    steps.restore(best)
    network.eval()
    return Descent(tuple(losses), losses.index(min(losses)) + 1, steps.arithmetic)
