"""The one loop over epochs: Adam with decoupled decay, a cosine, and the best weights kept by copy."""

from __future__ import annotations

import copy
import math
from collections.abc import Callable
from dataclasses import dataclass

import torch
from torch import Tensor, nn

from gaitdisc.errors import TrainingError
from gaitdisc.networks.training_settings import TrainingSettings

LEAST_STEPS = 1000  # short recordings have few batches an epoch: they get more epochs


@dataclass(frozen=True)
class Descent:
    """How the loss on the check part went, epoch by epoch.

    Parameters
    ----------
    losses : tuple of float
        Mean squared error of the scaled outputs on the check part, after every epoch.
    best_epoch : int
        Epoch, from 1, whose weights the network has now.
    """

    losses: tuple[float, ...]
    best_epoch: int


def epochs_of(samples: int, settings: TrainingSettings) -> int:
    """Passes over a training part of that many samples: the epochs of the settings, or what 1,000 steps need.

    Parameters
    ----------
    samples : int
        Samples of the training part.
    settings : TrainingSettings
        Epochs and batch.

    Examples
    --------
    >>> epochs_of(21_000, TrainingSettings()), epochs_of(2_000, TrainingSettings())
    (20, 125)
    """
    return max(settings.epochs, math.ceil(LEAST_STEPS / math.ceil(samples / settings.batch)))


def check_loss(network: nn.Module, check: tuple[Tensor, Tensor]) -> float:
    """Mean squared error of the scaled outputs.

    Parameters
    ----------
    network : torch module
        Left in the mode in which nothing is dropped out.
    check : pair of Tensor ((sample, input), (sample, output))
        Scaled samples.
    """
    network.eval()
    with torch.no_grad():
        return float(nn.functional.mse_loss(network(check[0]), check[1]))


def descend(
    network: nn.Module,
    part: tuple[Tensor, Tensor],
    check: tuple[Tensor, Tensor],
    decay: float,
    settings: TrainingSettings,
    progress: Callable[[float], None] = lambda _: None,
) -> Descent:
    """Train a network and give it back the weights that did best on the check part.

    Decay acts on weight matrices only. The best weights are kept as a copy: a reference would follow the descent.

    Parameters
    ----------
    network : torch module
        Changed in place.
    part, check : pair of Tensor ((sample, input), (sample, output))
        Scaled samples to descend on, and to judge each epoch by.
    decay : float
        Decoupled weight decay, times the learning rate each step.
    settings : TrainingSettings
        Epochs, batch, learning rate, seed.
    progress : callable
        Called after every epoch with the fraction done.

    Returns
    -------
    Descent

    Raises
    ------
    TrainingError
        If the loss becomes infinite or NaN.

    References
    ----------
    Loshchilov and Hutter 2019, Decoupled weight decay regularization. The dissertation does not say how it trained.
    """
    x, y = part
    epochs = epochs_of(len(x), settings)
    steps = epochs * math.ceil(len(x) / settings.batch)
    matrices = [p for p in network.parameters() if p.ndim > 1]
    others = [p for p in network.parameters() if p.ndim <= 1]
    groups = [{"params": matrices, "weight_decay": decay}, {"params": others, "weight_decay": 0.0}]
    adam = torch.optim.AdamW(groups, lr=settings.learning_rate, fused=True)
    cosine = torch.optim.lr_scheduler.CosineAnnealingLR(adam, steps)
    order = torch.Generator().manual_seed(settings.seed)
    losses: list[float] = []
    best = copy.deepcopy(network.state_dict())
    for epoch in range(1, epochs + 1):
        network.train()
        shuffled = torch.randperm(len(x), generator=order).to(x.device)
        x_epoch, y_epoch = x[shuffled], y[shuffled]
        for start in range(0, len(x), settings.batch):
            rows = slice(start, start + settings.batch)
            adam.zero_grad()
            nn.functional.mse_loss(network(x_epoch[rows]), y_epoch[rows]).backward()
            adam.step()
            cosine.step()
        losses.append(check_loss(network, check))
        if not math.isfinite(losses[-1]):
            raise TrainingError(
                "training needs a loss that stays finite",
                f"it was {losses[-1]} after epoch {epoch} of {epochs} at learning rate {settings.learning_rate:g}",
                "Lower the learning rate, tenfold at first; the findings may also name samples far out of range.",
            )
        if losses[-1] <= min(losses):
            best = copy.deepcopy(network.state_dict())
        progress(epoch / epochs)
    network.load_state_dict(best)
    network.eval()
    return Descent(tuple(losses), losses.index(min(losses)) + 1)
