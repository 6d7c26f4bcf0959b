"""A trained network: a model with its names, its scales and its weights."""

from __future__ import annotations

import json
import zipfile
from collections.abc import Callable
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np
import torch
from numpy.typing import NDArray
from torch import nn

from gaitdisc.errors import SchemaError
from gaitdisc.networks.threads import torch_threads
from gaitdisc.recording import Scale
from gaitdisc.whole_file import whole_file

FORMAT = 1
WEIGHT = "weight:"


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


def save_network(network: TrainedNetwork, path: Path) -> None:
    """Save a trained network; what is loaded again equals it to the last bit.

    path: of an `.npz` file; written whole or not at all
    """
    names = {"format": FORMAT, "inputs": network.inputs, "outputs": network.outputs}
    arrays = {
        "names": np.array(json.dumps(names)),
        "x_mean": network.x_scale.mean,
        "x_sd": network.x_scale.sd,
        "y_mean": network.y_scale.mean,
        "y_sd": network.y_scale.sd,
        **{WEIGHT + name: values for name, values in network.weights().items()},
    }
    with whole_file(path) as part, part.open("wb") as file:
        np.savez(file, **arrays)


def load_network(path: Path, build: Callable[[int, int], nn.Module]) -> TrainedNetwork:
    """Load a network that `save_network` wrote.

    build: takes the number of inputs and of outputs and makes the torch module, as in training: `FeedForward`
    """
    try:
        with np.load(path, allow_pickle=False) as file:
            arrays = {name: file[name] for name in file.files}
        names = json.loads(str(arrays["names"]))
        scales = Scale(arrays["x_mean"], arrays["x_sd"]), Scale(arrays["y_mean"], arrays["y_sd"])
    except (OSError, ValueError, KeyError, EOFError, zipfile.BadZipFile) as error:
        raise _refusal(path, str(error)) from error
    if names["format"] != FORMAT:
        raise _refusal(path, f"it has format {names['format']}; this version reads {FORMAT}")
    network = build(len(names["inputs"]), len(names["outputs"]))
    weights = {key[len(WEIGHT) :]: torch.from_numpy(v) for key, v in arrays.items() if key.startswith(WEIGHT)}
    try:
        network.load_state_dict(weights)
    except RuntimeError as error:
        raise _refusal(path, f"its weights do not fit a {type(network).__name__}") from error
    network.eval()
    return TrainedNetwork(tuple(names["inputs"]), tuple(names["outputs"]), *scales, network)


def _refusal(path: Path, found: str) -> SchemaError:
    return SchemaError(
        f"{path.name} must be a trained network saved by gaitdisc",
        found,
        "Load it as the kind of network that was saved, or train it again.",
    )


@dataclass(frozen=True, eq=False)
class Ensemble:
    """Mean of networks that differ in their first weights and in the order of the samples; a `gaitdisc.model.Model`.

    Source: Lakshminarayanan, Pritzel and Blundell 2017, Simple and scalable predictive uncertainty estimation using
        deep ensembles; without its variance head and adversarial training.
    """

    members: tuple[TrainedNetwork, ...]  # at least one; of the same inputs, outputs and scales

    @property
    def inputs(self) -> tuple[str, ...]:
        """Names of the inputs, in order."""
        return self.members[0].inputs

    @property
    def outputs(self) -> tuple[str, ...]:
        """Names of the outputs, in order."""
        return self.members[0].outputs

    @property
    def x_scale(self) -> Scale:
        """Scale of the inputs in the training part."""
        return self.members[0].x_scale

    @property
    def y_scale(self) -> Scale:
        """Scale of the outputs in the training part."""
        return self.members[0].y_scale

    def __call__(self, x: NDArray[np.float64]) -> NDArray[np.float64]:
        """Mean outputs (sample, output) for inputs (sample, input)."""
        return np.mean([member(x) for member in self.members], axis=0)

    def spread(self, x: NDArray[np.float64]) -> NDArray[np.float64]:
        """Standard deviation among the members, (sample, output) [each output's unit].

        It shows where the members disagree, which is not the whole of the error: what all of them miss is not in it.

        x (sample, input) [each input's unit]: as for the model itself
        """
        return np.std([member(x) for member in self.members], axis=0)


def save_ensemble(ensemble: Ensemble, path: Path) -> None:
    """Save every member beside the others: `weights.npz` becomes `weights_1.npz` and so on.

    path: of the `.npz` file that a single network would have
    """
    for number, member in enumerate(ensemble.members, 1):
        save_network(member, member_path(path, number))


def member_path(path: Path, number: int) -> Path:
    """File of one member.

    path: of the `.npz` file that a single network would have

    >>> member_path(Path("weights.npz"), 2).name
    'weights_2.npz'
    """
    return path.with_name(f"{path.stem}_{number}{path.suffix}")
