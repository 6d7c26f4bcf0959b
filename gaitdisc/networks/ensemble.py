"""Networks of one kind from several seeds: their mean, and how far they are apart."""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from gaitdisc.networks.trained_network import TrainedNetwork, save_network
from gaitdisc.recording import Scale


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
