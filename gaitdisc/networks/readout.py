"""The last, linear layer of a network, solved instead of descended."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Protocol, cast

import numpy as np
import torch
from numpy.typing import NDArray
from torch import Tensor, nn

PENALTIES = (1e-5, 1e-4, 1e-3, 1e-2, 1e-1)


class WithReadout(Protocol):
    """A torch module whose last layer is linear and called `readout`."""

    readout: nn.Linear

    def features(self, x: Tensor) -> Tensor:
        """Return what the readout reads, (sample, node).

        x Tensor (sample, input): scaled inputs
        """
        ...


def solve_readout(network: nn.Module, part: tuple[Tensor, Tensor], penalty: float) -> None:
    """Replace the last layer by its ridge least squares solution for the features as they are.

    Minimises sum (y - W h - b)^2 / samples + penalty sum W^2, in double precision; b is not penalised.

    network: with `features` and a linear layer `readout`; its readout is changed in place
    part pair of Tensor ((sample, input), (sample, output)): scaled samples
    """
    parts = cast(WithReadout, network)
    network.eval()
    with torch.no_grad():
        squares = _squares(_features(network, part[0]), part[1].cpu().double().numpy())
        weights, offset = squares.solved(penalty)
        parts.readout.weight.copy_(torch.from_numpy(weights))
        parts.readout.bias.copy_(torch.from_numpy(offset))


def choose_penalty(
    network: nn.Module, part: tuple[Tensor, Tensor], check: tuple[Tensor, Tensor]
) -> tuple[float, float]:
    """Penalty of the readout that does best on a check part, and the mean squared error it reaches there.

    part, check pair of Tensor ((sample, input), (sample, output)): scaled samples to solve on, and to check by
    returns penalty, loss: one of `PENALTIES`; mean squared error of the scaled outputs
    """
    network.eval()
    squares = _squares(_features(network, part[0]), part[1].cpu().double().numpy())
    h, y = _features(network, check[0]), check[1].cpu().double().numpy()
    losses = []
    for penalty in PENALTIES:
        weights, offset = squares.solved(penalty)
        losses.append(float(np.mean((y - h @ weights.T - offset) ** 2)))
    best = int(np.argmin(losses))
    return PENALTIES[best], losses[best]


@dataclass(frozen=True, eq=False)
class _Squares:
    """Means and mean products of features and outputs: all that ridge regression needs, whatever the penalty."""

    h_mean: NDArray[np.float64]
    y_mean: NDArray[np.float64]
    h_h: NDArray[np.float64]
    h_y: NDArray[np.float64]

    def solved(self, penalty: float) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
        """Weights (output, node) and offset (output,)."""
        weights = np.asarray(np.linalg.solve(self.h_h + penalty * np.eye(len(self.h_h)), self.h_y).T, float)
        return weights, self.y_mean - weights @ self.h_mean


def _squares(h: NDArray[np.float64], y: NDArray[np.float64]) -> _Squares:
    h_mean, y_mean = np.asarray(h.mean(axis=0), float), np.asarray(y.mean(axis=0), float)
    h, y = h - h_mean, y - y_mean
    return _Squares(h_mean, y_mean, h.T @ h / len(h), h.T @ y / len(h))


def _features(network: nn.Module, x: Tensor) -> NDArray[np.float64]:
    with torch.no_grad():
        return cast(WithReadout, network).features(x).cpu().double().numpy()
