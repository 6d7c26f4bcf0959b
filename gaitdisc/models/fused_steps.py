"""Steps of the dissertation's network by compiled code on the CPU: products by BLAS, torch's numbers to rounding."""

import math
from typing import NamedTuple

import numpy as np
import torch
from numpy.typing import NDArray
from torch import Tensor, nn

from gaitdisc.compiled import compiled
from gaitdisc.models.networks import FeedForward
from gaitdisc.models.training_settings import ScaledSamples, Schedule
from gaitdisc.recording.arrays import Values

F32, Singles = np.float32, NDArray[np.float32]
LOG2_E = F32(1.4426950408889634)
LN_2_HIGH, LN_2_LOW = F32(0.693359375), F32(-2.12194440e-4)
BLOCK = 128
EXP_LEAST, EXP_MOST = F32(-87.0), F32(88.0)
BETA_1, BETA_2, ADAM_EPSILON = F32(0.9), F32(0.999), F32(1e-8)  # torch's, and those of Kingma and Ba 2015

# Without numpy's division and without fused multiply-add the compiler makes no vector code of these loops.
fast = compiled(error_model="numpy", fastmath={"contract"})
# One function each way in: with calls between compiled functions, a process that compiles and one that loads what was
# kept take different copies of what is called, and differ in the last bit.
inlined = compiled(error_model="numpy", fastmath={"contract"}, inline="always")


@inlined
def exponential(x: np.float32) -> np.float32:
    """Return e^x in float32, within 1e-7 of its value from -87 to 88, as vector code; NaN stays NaN.

    Beyond -87 and 88 it has the value that it has there. The library's own exponential would be called element by
    element.

    Source: Moshier, Cephes Mathematical Library, `expf`: Cody-Waite reduction and the polynomial of degree 5.

    >>> round(float(exponential(np.float32(1.0))), 6)
    2.718282
    """
    x = min(x, EXP_MOST)
    x = max(x, EXP_LEAST)
    k = np.floor(x * LOG2_E + F32(0.5))
    r = x - k * LN_2_HIGH - k * LN_2_LOW
    p = F32(1.9875691500e-4)
    p = p * r + F32(1.3981999507e-3)
    p = p * r + F32(8.3334519073e-3)
    p = p * r + F32(4.1665795894e-2)
    p = p * r + F32(1.6666665459e-1)
    p = p * r + F32(5.0000001201e-1)
    p = p * r * r + r + F32(1.0)
    return p * np.int32((np.int32(k) + 127) << 23).view(np.float32)


@inlined
def layers(weights: Singles, inputs: int, nodes: int, outputs: int):
    """Return the three matrices, then the three offsets: views into weights, or into their gradient (weight,).

    >>> [part.shape for part in layers(np.zeros(7880, np.float32), 49, 64, 8)]
    [(64, 49), (64, 64), (8, 64), (64,), (64,), (8,)]
    """
    first = nodes * inputs
    second = first + nodes * nodes
    third = second + outputs * nodes
    offset, last = third + nodes, third + 2 * nodes
    return (
        weights[:first].reshape(nodes, inputs),
        weights[first:second].reshape(nodes, nodes),
        weights[second:third].reshape(outputs, nodes),
        weights[third:offset],
        weights[offset:last],
        weights[last : last + outputs],
    )


@inlined
def _sigmoid(z, offset):
    for row in range(z.shape[0]):
        for node in range(z.shape[1]):
            z[row, node] = F32(1) / (F32(1) + exponential(-(z[row, node] + offset[node])))


@inlined
def _radial(n, offset, h):
    for row in range(n.shape[0]):
        for node in range(n.shape[1]):
            value = n[row, node] + offset[node]
            n[row, node] = value
            h[row, node] = exponential(-value * value)


@inlined
def _forward(weights, x, hidden, y):
    """Leave s, n, h in hidden[0..2], and outputs without their offset in y."""
    w1, w2, w3, b1, b2, _ = layers(weights, x.shape[1], hidden.shape[2], y.shape[1])
    s, n, h = hidden[0, : len(x)], hidden[1, : len(x)], hidden[2, : len(x)]
    np.dot(x, w1.T, s)
    _sigmoid(s, b1)
    np.dot(s, w2.T, n)
    _radial(n, b2, h)
    np.dot(h, w3.T, y)


@inlined
def _error(error, offset, y, offset_gradient, samples):
    share = F32(2.0 / (samples * y.shape[1]))
    offset_gradient[:] = F32(0)
    for row in range(error.shape[0]):
        for output in range(error.shape[1]):
            d = (error[row, output] + offset[output] - y[row, output]) * share
            error[row, output] = d
            offset_gradient[output] += d


@inlined
def _radial_backward(d, n, h, offset_gradient):
    offset_gradient[:] = F32(0)
    for row in range(d.shape[0]):
        for node in range(d.shape[1]):
            value = F32(-2) * d[row, node] * h[row, node] * n[row, node]
            d[row, node] = value
            offset_gradient[node] += value


@inlined
def _sigmoid_backward(d, s, offset_gradient):
    offset_gradient[:] = F32(0)
    for row in range(d.shape[0]):
        for node in range(d.shape[1]):
            value = d[row, node] * s[row, node] * (F32(1) - s[row, node])
            d[row, node] = value
            offset_gradient[node] += value


@inlined
def gradient(weights: Singles, into: Singles, x: Singles, y: Singles, hidden: Singles, samples: int) -> None:
    """What a block of samples adds to the gradient of a batch's mean squared error.

    weights, into (weight,): weights, and where their gradient goes
    x, y (sample, input), (sample, output): scaled samples of the block, contiguous
    hidden (5, at least sample, node): room to work in; its last length is the number of nodes
    samples: samples of the whole batch, over which the mean is taken
    """
    count, nodes = len(x), hidden.shape[2]
    _, w2, w3, _, _, b3 = layers(weights, x.shape[1], nodes, y.shape[1])
    g1, g2, g3, c1, c2, c3 = layers(into, x.shape[1], nodes, y.shape[1])
    s, n, h = hidden[0, :count], hidden[1, :count], hidden[2, :count]
    dn, dz = hidden[3, :count], hidden[4, :count]
    error = np.empty_like(y)
    _forward(weights, x, hidden, error)
    _error(error, b3, y, c3, samples)
    np.dot(error.T, h, g3)
    np.dot(error, w3, dn)
    _radial_backward(dn, n, h, c2)
    np.dot(dn.T, s, g2)
    np.dot(dn, w2, dz)
    _sigmoid_backward(dz, s, c1)
    np.dot(dz.T, x, g1)


@fast
def mean_squared_error(weights: Singles, x: Singles, y: Singles, nodes: int) -> float:
    """Mean squared error over samples and outputs."""
    hidden = np.empty((3, BLOCK, nodes), np.float32)
    outputs = np.empty((BLOCK, y.shape[1]), np.float32)
    offset = layers(weights, x.shape[1], nodes, y.shape[1])[5]
    total = 0.0
    for start in range(0, len(x), BLOCK):
        targets = y[start : start + BLOCK]
        _forward(weights, x[start : start + BLOCK], hidden, outputs[: len(targets)])
        for row in range(targets.shape[0]):
            for output in range(targets.shape[1]):
                d = outputs[row, output] + offset[output] - targets[row, output]
                total += d * d  # d * d is float32 as in torch: what overflows there is infinite here
    return total / y.size


@inlined
def _adam(weights, g, moments, matrices, pace):
    m, v = moments[0], moments[1]
    shrunk, size, spread = pace[0], pace[1], pace[2]
    for k in range(weights.size):
        m[k] = BETA_1 * m[k] + (F32(1) - BETA_1) * g[k]
        v[k] = BETA_2 * v[k] + (F32(1) - BETA_2) * g[k] * g[k]
    for k in range(matrices):
        weights[k] *= shrunk
    for k in range(weights.size):
        weights[k] -= size * m[k] / (math.sqrt(v[k]) * spread + ADAM_EPSILON)


@inlined
def _gather(values, rows, into):
    for k in range(rows.size):
        row = values[rows[k]]
        for column in range(row.size):
            into[k, column] = row[column]


class Batches(NamedTuple):
    """The steps of one pass over the samples.

    order (sample,): in which the samples are seen
    size: samples of a batch
    paces (step, 3): of each step: factor on the weight matrices (decoupled decay), step size over the bias correction
        of the mean, factor on the root of the mean square (its bias correction)
    """

    order: NDArray[np.int64]
    size: int
    paces: Singles


@fast
def descend_epoch(weights: Singles, moments: Singles, x: Singles, y: Singles, batches: Batches, nodes: int) -> None:
    """One pass over the samples, a step of Adam for each batch; weights and moments are changed in place.

    moments (2, weight): running means of the gradient and of its square
    """
    hidden = np.empty((5, BLOCK, nodes), np.float32)
    x_block, y_block = np.empty((BLOCK, x.shape[1]), np.float32), np.empty((BLOCK, y.shape[1]), np.float32)
    g, added = np.empty_like(weights), np.empty_like(weights)
    matrices = nodes * (x.shape[1] + nodes + y.shape[1])
    for step in range(len(batches.paces)):
        rows = batches.order[step * batches.size : (step + 1) * batches.size]
        g[:] = F32(0)
        for start in range(0, rows.size, BLOCK):
            block = rows[start : start + BLOCK]
            _gather(x, block, x_block)
            _gather(y, block, y_block)
            gradient(weights, added, x_block[: block.size], y_block[: block.size], hidden, rows.size)
            for k in range(g.size):
                g[k] += added[k]
        _adam(weights, g, moments, matrices, batches.paces[step])


class FusedSteps:
    """Adam with decoupled decay on a `FeedForward` in float32 on the CPU, with gradients written by hand.

    Same weights to start from, same order of samples, same steps as `TorchSteps`: the two differ by rounding. Nothing
    is dispatched between two matrix products, and what lies between them is one pass over memory.
    """

    def __init__(self, network: FeedForward, part: ScaledSamples, check: ScaledSamples, schedule: Schedule) -> None:
        self._network, self._schedule = network, schedule
        self._part, self._check = (tuple(t.contiguous().numpy() for t in pair) for pair in (part, check))
        self._nodes = network.radial.out_features
        self._weights = torch.cat([p.detach().reshape(-1) for p in matrices_then_offsets(network)]).numpy()
        self._moments = np.zeros((2, self._weights.size), np.float32)
        self._done = 0

    def epoch(self, order: Tensor, rates: Values) -> None:
        """Step through all samples once, as `TorchSteps.epoch`."""
        number = self._done + 1 + np.arange(len(rates))
        self._done += len(rates)
        paces = np.empty((len(rates), 3), np.float32)
        paces[:, 0] = 1 - rates * self._schedule.decay
        paces[:, 1] = rates / (1 - 0.9**number)
        paces[:, 2] = 1 / np.sqrt(1 - 0.999**number)
        x, y = self._part
        batches = Batches(order.numpy(), self._schedule.batch, paces)
        descend_epoch(self._weights, self._moments, x, y, batches, self._nodes)

    def loss(self) -> float:
        """Mean squared error of the scaled outputs on the check part."""
        x, y = self._check
        return float(mean_squared_error(self._weights, x, y, self._nodes))

    def weights(self) -> Singles:
        """Copy of the weights as they are: a reference would follow the descent."""
        return self._weights.copy()

    def restore(self, weights: Singles) -> None:
        """Give the network weights that it had before, from `weights`."""
        self._weights[:] = weights
        parameters = matrices_then_offsets(self._network)
        pieces = torch.from_numpy(weights).split([p.numel() for p in parameters])
        with torch.no_grad():
            for parameter, values in zip(parameters, pieces, strict=True):
                parameter.copy_(values.reshape(parameter.shape))


def matrices_then_offsets(network: FeedForward) -> tuple[Tensor, ...]:
    """Return the parameters in the order of the compiled code's one vector.

    >>> [tuple(p.shape) for p in matrices_then_offsets(FeedForward(3, 2, nodes=4))]
    [(4, 3), (4, 4), (2, 4), (4,), (4,), (2,)]
    """
    linear = (network.sigmoid, network.radial, network.readout)
    return (*(layer.weight for layer in linear), *(layer.bias for layer in linear))


def can_be_fused(network: nn.Module) -> bool:
    """Whether the compiled code computes this network: the dissertation's own, in float32, on the CPU.

    >>> can_be_fused(FeedForward(3, 2)), can_be_fused(FeedForward(3, 2).double()), can_be_fused(nn.Linear(3, 2))
    (True, False, False)
    """
    if type(network) is not FeedForward:  # a network made from it may compute something else
        return False
    return all(p.device.type == "cpu" and p.dtype == torch.float32 for p in network.parameters())
