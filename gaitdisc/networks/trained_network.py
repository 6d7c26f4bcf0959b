"""A trained network: a model with its names, its scales and its weights."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass
from typing import Any

import numpy as np
import torch
from numpy.typing import NDArray
from torch import nn

from gaitdisc.networks.threads import torch_threads
from gaitdisc.recording import Scale


@dataclass(frozen=True, eq=False)
class TrainedNetwork:
    """Named inputs to named outputs, in their units; a `gaitdisc.model.Model`."""

    inputs: tuple[str, ...]
    outputs: tuple[str, ...]
    x_scale: Scale
    y_scale: Scale
    network: nn.Module  # takes and gives scaled numbers; on the CPU

    @property
    def ignored(self) -> tuple[str, ...]:
        """Inputs that did not vary in training and therefore weigh nothing."""
        return tuple(name for name, still in zip(self.inputs, self.x_scale.constant, strict=True) if still)

    def weights(self) -> dict[str, NDArray[Any]]:
        """Copy of every weight, by the name it has in the torch module."""
        return {name: tensor.detach().cpu().numpy().copy() for name, tensor in self.network.state_dict().items()}

    def __call__(self, x: NDArray[np.float64]) -> NDArray[np.float64]:
        """Outputs (sample, output) for inputs (sample, input); NaN where an input is NaN."""
        return self.y_scale.unscaled(self._run(self.network, self.x_scale.scaled(np.asarray(x, float))))

    def latent(self, x: NDArray[np.float64]) -> NDArray[np.float64]:
        """Latent state (sample, node) of a recurrent network for inputs (sample, input)."""
        return self._run(getattr(self.network, "latent"), self.x_scale.scaled(np.asarray(x, float)))  # noqa: B009

    def decoded(self, latent: NDArray[np.float64]) -> NDArray[np.float64]:
        """Outputs (sample, output) that a recurrent network decodes from latent states (sample, node)."""
        return self.y_scale.unscaled(self._run(getattr(self.network, "decoder"), latent))  # noqa: B009

    def _run(self, part: Callable[[torch.Tensor], torch.Tensor], values: NDArray[np.float64]) -> NDArray[np.float64]:
        self.network.eval()
        with torch.no_grad(), torch_threads(1):
            return part(torch.from_numpy(values.astype(np.float32))).double().numpy()


def with_weights(network: nn.Module, weights: Mapping[str, NDArray[Any]]) -> nn.Module:
    """Network, changed in place, with weights by the names that they have in the torch module."""
    try:
        network.load_state_dict({name: torch.from_numpy(values) for name, values in weights.items()})
    except RuntimeError as error:
        raise ValueError(f"its weights do not fit a {type(network).__name__}") from error
    return network.eval()
