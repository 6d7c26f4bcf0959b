"""A learned model laid out as tables of numbers, so that compiled code can evaluate it inside the integrator."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from gaitdisc.errors import TrainingError
from gaitdisc.model import Model

from .by_output import ByOutput
from .dmd import Dmd
from .gaussian_process import GaussianProcess
from .kernels import KERNELS as KERNEL_KINDS
from .learned_rates import KERNELS, LAYERS, PRODUCTS, TIMES
from .sindy import Sindy

Tables = tuple[NDArray[np.float64], ...]
TABLES = 6


@dataclass(frozen=True, eq=False)
class LearnedTerm:
    """Features and weights."""

    kind: int
    tables: Tables  # each ndarray, six matrices


def learned_term(model: Model, times: NDArray[np.float64]) -> LearnedTerm:
    """Lay out a learned model."""
    if isinstance(model, Sindy):
        return LearnedTerm(PRODUCTS, _six(model.powers, model.coefficients))
    if isinstance(model, GaussianProcess):
        scale = np.vstack([model.scale.mean, 1 / model.scale.sd])
        kind = np.array([[KERNEL_KINDS.index(model.kind)]])
        return LearnedTerm(KERNELS, _six(model.centres, model.weights, 1 / model.lengths, scale, model.offset, kind))
    if isinstance(model, Dmd):
        return LearnedTerm(TIMES, _six(model(times[:, None])))
    return LearnedTerm(LAYERS, _six(*_layers(model)))


def _layers(model: Model) -> Tables:
    """Weights with offsets in a last column, network under network; the scale of the outputs goes into the readout."""
    from gaitdisc.networks.trained_network import TrainedNetwork

    networks = model.models if isinstance(model, ByOutput) else (model,)
    first, second, third, offset, scale = [], [], [], [], np.empty((2, 0))
    for network in networks:
        if not isinstance(network, TrainedNetwork) or "radial.weight" not in network.weights():
            raise TrainingError(
                "a learned term is a Sindy, a Dmd, a GaussianProcess, or trained FeedForwards",
                f"found {type(network).__name__}",
                "Fit one of these.",
            )
        weights = {name: np.asarray(values, float) for name, values in network.weights().items()}
        for rows, each in zip((first, second), LAYER_NAMES, strict=True):
            rows.append(np.column_stack([weights[f"{each}.weight"], weights[f"{each}.bias"]]))
        size = np.where(network.y_scale.constant, 0.0, network.y_scale.sd)
        third.append(weights["readout.weight"] * size[:, None])
        offset.append(weights["readout.bias"] * size + network.y_scale.mean)
        scale = np.vstack([network.x_scale.mean, 1 / network.x_scale.sd])  # all have seen the same inputs
    return np.vstack(first), np.vstack(second), np.vstack(third), scale, np.concatenate(offset)


LAYER_NAMES = ("sigmoid", "radial")


def _six(*tables: NDArray) -> Tables:
    full = [np.ascontiguousarray(np.atleast_2d(np.array(table, float))) for table in tables]
    return tuple(full + [np.zeros((1, 1))] * (TABLES - len(full)))
