"""Small networks to the end of their descent: Levenberg-Marquardt with Bayesian regularisation."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from gaitdisc.models.trained_network import TrainedNetwork
from gaitdisc.recording import Samples, fit_scale

NODES = 10  # of either hidden layer, as in the published code of chapter 3
MOST_WEIGHED = 300  # samples, evenly in time, that noise and weights are weighed on: neighbours share their noise
LEAST_SAMPLES = 50
STEPS, LAST_STEPS = 100, 40  # with the weighing renewed after each, and on all samples
FIRST_DAMPING, EASED, MOST_DAMPING = 5e-3, 4.0, 1e12
SETTLED = 1e-6  # of the objective, in one step
NOTHING = 1e-2  # weights that the samples determine: below, there is nothing but noise


class _Weighing(NamedTuple):
    """Precision of the weights and of the noise (MacKay's alpha and beta)."""

    weights: float
    noise: float


def train_bayesian(samples: Samples, nodes: int = NODES, seed: int = 0) -> TrainedNetwork:
    """Train a `FeedForward` of one output by second-order steps, its weight decay weighed by the evidence.

    Minimises noise * sum (y - f(x, w))^2 + weights * sum w^2 (scaled samples) by Levenberg-Marquardt steps. `weights`
    and `noise` are what makes at most 300 samples, evenly in time, likeliest, renewed after each step; then the
    weights descend on all samples with both as they are. No sample is held back.

    Source: MacKay 1992, Neural Computation 4:415 and 4:448; Foresee and Hagan 1997, ICNN 3:1930. The published code of
        chapter 3 trains logsig-radbas-purelin layers of ten nodes so (MATLAB's `trainbr`).
    """
    samples.trainable(LEAST_SAMPLES)
    x_scale, y_scale = fit_scale(samples.x), fit_scale(samples.y)
    x, y = x_scale.scaled(samples.x), y_scale.scaled(samples.y)[:, 0]
    some = np.unique(np.linspace(0, len(x) - 1, min(MOST_WEIGHED, len(x))).astype(int))
    weights, weighing = _descended(x[some], y[some], _drawn(x.shape[1], nodes, seed), None)
    weights, _ = _descended(x, y, weights, weighing)
    return TrainedNetwork(samples.inputs, samples.outputs, x_scale, y_scale, _module(weights, x.shape[1], nodes))


def _drawn(inputs: int, nodes: int, seed: int) -> NDArray[np.float64]:
    """First weights, wide enough that the layers bend within the samples: (nodes (inputs + nodes + 3) + 1,)."""
    draw = np.random.default_rng(seed).standard_normal
    sigmoid, radial = 1.5 * draw((nodes, inputs)), 1.5 / np.sqrt(nodes) * draw((nodes, nodes))
    parts = (sigmoid, draw(nodes), radial, 0.5 * draw(nodes), 0.3 * draw(nodes), np.zeros(1))
    return np.concatenate([part.ravel() for part in parts])


def _descended(
    x: NDArray[np.float64], y: NDArray[np.float64], weights: NDArray[np.float64], weighing: _Weighing | None
) -> tuple[NDArray[np.float64], _Weighing]:
    """Weights after the steps, and the weighing, which is renewed after each step where none is given."""
    renewed, damping = weighing is None, FIRST_DAMPING
    now = weighing or _Weighing(0.01, 1.0)
    found, slopes = _outputs(weights, x)
    error = y - found
    for _ in range(STEPS if renewed else LAST_STEPS):
        squares, pull = slopes.T @ slopes, slopes.T @ error
        before = now.noise * error @ error + now.weights * weights @ weights
        while damping < MOST_DAMPING:
            curved = now.noise * squares + (now.weights + damping * now.noise) * np.eye(len(weights))
            tried = weights + np.linalg.solve(curved, now.noise * pull - now.weights * weights)
            found, tried_slopes = _outputs(tried, x)
            error = y - found
            after = now.noise * error @ error + now.weights * tried @ tried
            if after < before:
                break
            damping *= EASED
        else:
            break
        damping, weights, slopes = max(damping / EASED, 1 / MOST_DAMPING), tried, tried_slopes
        if renewed:
            now = _weighed(slopes, error, weights, now)
        elif before - after < SETTLED * before:
            break
    return weights, now


def _weighed(
    slopes: NDArray[np.float64], error: NDArray[np.float64], weights: NDArray[np.float64], now: _Weighing
) -> _Weighing:
    """Weighing that makes the samples likeliest, from the number of weights that they determine (gamma)."""
    stiff = np.maximum(np.linalg.eigvalsh(now.noise * slopes.T @ slopes), 0.0)
    determined = float(np.sum(stiff / (stiff + now.weights)))
    if determined < NOTHING:
        return now
    return _Weighing(determined / float(weights @ weights), max(len(error) - determined, 1.0) / float(error @ error))


def _parts(weights: NDArray[np.float64], inputs: int) -> list[NDArray[np.float64]]:
    """Weights and offsets of the three layers, from the row that holds them all."""
    nodes = round((np.sqrt((inputs + 3) ** 2 + 4 * (len(weights) - 1)) - inputs - 3) / 2)
    ends = np.cumsum([nodes * inputs, nodes, nodes * nodes, nodes, nodes])
    sigmoid, sigmoid_offset, radial, *others = np.split(weights, ends)
    return [sigmoid.reshape(nodes, inputs), sigmoid_offset, radial.reshape(nodes, nodes), *others]


def _outputs(weights: NDArray[np.float64], x: NDArray[np.float64]) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
    """Output (sample,), and its slope in every weight (sample, weight)."""
    sigmoid, sigmoid_offset, radial, radial_offset, readout, offset = _parts(weights, x.shape[1])
    with np.errstate(over="ignore"):
        first = 1 / (1 + np.exp(-(x @ sigmoid.T + sigmoid_offset)))
    n = first @ radial.T + radial_offset
    second = np.exp(-n * n)
    of_radial = -2 * n * second * readout
    of_sigmoid = (of_radial @ radial) * first * (1 - first)
    each = [(of_sigmoid[:, :, None] * x[:, None]), of_sigmoid, of_radial[:, :, None] * first[:, None], of_radial]
    slopes = [part.reshape(len(x), -1) for part in (*each, second, np.ones(len(x)))]
    return second @ readout + offset, np.concatenate(slopes, axis=1)


def _module(weights: NDArray[np.float64], inputs: int, nodes: int):
    import torch

    from gaitdisc.models.networks import FeedForward

    network = FeedForward(inputs, 1, nodes)
    names = [f"{layer}.{part}" for layer in ("sigmoid", "radial", "readout") for part in ("weight", "bias")]
    parts = _parts(weights, inputs)
    parts[4] = parts[4][None]
    state = {name: torch.from_numpy(np.array(part, np.float32)) for name, part in zip(names, parts, strict=True)}
    network.load_state_dict(state)
    return network.eval()
