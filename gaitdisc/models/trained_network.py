"""A trained network: a model with its names, scales and weights; and how many threads it and its training take."""

from collections.abc import Callable, Iterator, Mapping
from contextlib import contextmanager
from dataclasses import dataclass
from typing import Any

import numpy as np
import scipy.linalg.blas  # noqa: F401 numba multiplies with scipy's BLAS: what is to be limited must be loaded
import torch
from numpy.typing import NDArray
from threadpoolctl import threadpool_limits
from torch import nn

from gaitdisc.recording import Scale
from gaitdisc.recording.arrays import Values

WEIGHT = "weight:"  # before the name of each weight among the arrays of a network


@dataclass(frozen=True, eq=False)
class TrainedNetwork:
    """Named inputs to named outputs, in their units; a `gaitdisc.model.Model`."""

    inputs: tuple[str, ...]
    outputs: tuple[str, ...]
    x_scale: Scale
    y_scale: Scale
    network: nn.Module  # takes and gives scaled numbers; on the CPU

    def weights(self) -> dict[str, NDArray[Any]]:
        """Copy of every weight, by the name it has in the torch module."""
        return {name: tensor.detach().cpu().numpy().copy() for name, tensor in self.network.state_dict().items()}

    def arrays(self) -> dict[str, NDArray[Any]]:
        """Scales and weights by name, as `restore_network` takes them."""
        scales = {"x_mean": self.x_scale.mean, "x_sd": self.x_scale.sd}
        scales |= {"y_mean": self.y_scale.mean, "y_sd": self.y_scale.sd}
        return scales | {WEIGHT + name: values for name, values in self.weights().items()}

    def __call__(self, x: Values) -> Values:
        """Outputs (sample, output) for inputs (sample, input); NaN where an input is NaN."""
        return self.y_scale.unscaled(self._run(self.network, self.x_scale.scaled(np.asarray(x, float))))

    def latent(self, x: Values) -> Values:
        """Latent state (sample, node) of a recurrent network for inputs (sample, input)."""
        return self._run(getattr(self.network, "latent"), self.x_scale.scaled(np.asarray(x, float)))  # noqa: B009

    def decoded(self, latent: Values) -> Values:
        """Outputs (sample, output) that a recurrent network decodes from latent states (sample, node)."""
        return self.y_scale.unscaled(self._run(getattr(self.network, "decoder"), latent))  # noqa: B009

    def _run(self, part: Callable[[torch.Tensor], torch.Tensor], values: Values) -> Values:
        self.network.eval()
        with torch.no_grad(), torch_threads(1):
            return part(torch.from_numpy(values.astype(np.float32))).double().numpy()


def restore_network(
    inputs: tuple[str, ...], outputs: tuple[str, ...], arrays: Mapping[str, NDArray[Any]], network: nn.Module
) -> TrainedNetwork:
    """Trained network of its arrays; network: of its architecture, whose weights are replaced."""
    weights = {name.removeprefix(WEIGHT): values for name, values in arrays.items() if name.startswith(WEIGHT)}
    try:
        network.load_state_dict({name: torch.from_numpy(values) for name, values in weights.items()})
    except RuntimeError as error:
        raise ValueError(f"the weights do not fit a {type(network).__name__}") from error
    scales = Scale(arrays["x_mean"], arrays["x_sd"]), Scale(arrays["y_mean"], arrays["y_sd"])
    return TrainedNetwork(inputs, outputs, *scales, network.eval())


@contextmanager
def torch_threads(count: int) -> Iterator[None]:
    """Let torch use that many threads on the CPU, and as many as before when the block ends.

    >>> with torch_threads(1):
    ...     torch.get_num_threads()
    1
    """
    before = torch.get_num_threads()
    torch.set_num_threads(count)
    try:
        yield
    finally:
        torch.set_num_threads(before)


@contextmanager
def pin_threads(count: int) -> Iterator[None]:
    """Let torch and every BLAS use that many threads on the CPU, and as many as before when the block ends.

    Matrices of 64 columns are slower on two threads than on one, and two trainings beside each other slower still.

    >>> from threadpoolctl import threadpool_info
    >>> with pin_threads(1):
    ...     {pool["num_threads"] for pool in threadpool_info() if pool["user_api"] == "blas"}
    {1}
    """
    with torch_threads(count), threadpool_limits(count, user_api="blas"):
        yield
