"""One step of many gated recurrent states at once, in double precision: two matrix products, all else compiled here."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from gaitdisc.compiled import compiled

Array = NDArray[np.float64]


@compiled(error_model="numpy")
def gru_step(read: Array, states: Array, weights: tuple[Array, Array], offsets: tuple[Array, Array]) -> Array:
    """States of a layer of gated recurrent units after one more reading, (window, node).

    read (window, input): what each window reads now
    states (window, node): before
    weights ((input, 3 node), (node, 3 node)): of what is read, and of the state: reset gate, update gate, candidate
    offsets pair of (3 node,): of the two
    Source: Cho et al. 2014; the reset gate acts after the product, as in torch.

    >>> one, two, none = np.ones((1, 3)), np.zeros((1, 3)), np.zeros(3)
    >>> gru_step(np.zeros((1, 1)), np.ones((1, 1)), (one, two), (none, none))  # gates half open, candidate 0
    array([[0.5]])
    """
    nodes = states.shape[1]
    a = np.dot(read, weights[0])
    b = np.dot(states, weights[1])
    after = np.empty_like(states)
    for window in range(len(states)):
        for k in range(nodes):
            i, j = nodes + k, 2 * nodes + k
            reset = 1 / (1 + np.exp(-(a[window, k] + offsets[0][k] + b[window, k] + offsets[1][k])))
            update = 1 / (1 + np.exp(-(a[window, i] + offsets[0][i] + b[window, i] + offsets[1][i])))
            candidate = np.tanh(a[window, j] + offsets[0][j] + reset * (b[window, j] + offsets[1][j]))
            after[window, k] = candidate + update * (states[window, k] - candidate)
    return after


@compiled(error_model="numpy")
def lstm_step(
    read: Array, states: tuple[Array, Array], weights: tuple[Array, Array], offsets: tuple[Array, Array]
) -> tuple[Array, Array]:
    """States and cells of a layer of long short-term memory after one more reading, each (window, node).

    read (window, input): what each window reads now
    states ((window, node), (window, node)): states and cells before
    weights ((input, 4 node), (node, 4 node)): of what is read, and of the state: input gate, forget gate, candidate,
        output gate
    offsets pair of (4 node,): of the two
    Source: Hochreiter and Schmidhuber 1997, with the forget gate of Gers et al. 2000, as in torch.

    >>> one, two, none = np.ones((1, 4)), np.zeros((1, 4)), np.zeros(4)
    >>> lstm_step(np.zeros((1, 1)), (np.ones((1, 1)), np.ones((1, 1))), (one, two), (none, none))[1]
    array([[0.5]])
    """
    before, cells = states
    nodes = before.shape[1]
    sums = np.dot(read, weights[0]) + np.dot(before, weights[1])
    after, kept = np.empty_like(before), np.empty_like(cells)
    for window in range(len(before)):
        for k in range(nodes):
            gates = sums[window]
            take = 1 / (1 + np.exp(-(gates[k] + offsets[0][k] + offsets[1][k])))
            i, j, o = nodes + k, 2 * nodes + k, 3 * nodes + k
            keep = 1 / (1 + np.exp(-(gates[i] + offsets[0][i] + offsets[1][i])))
            candidate = np.tanh(gates[j] + offsets[0][j] + offsets[1][j])
            give = 1 / (1 + np.exp(-(gates[o] + offsets[0][o] + offsets[1][o])))
            kept[window, k] = keep * cells[window, k] + take * candidate
            after[window, k] = give * np.tanh(kept[window, k])
    return after, kept


@compiled(error_model="numpy")
def decoded(features: Array, weights: tuple[Array, Array, Array], offsets: tuple[Array, Array, Array]) -> Array:
    """Scaled outputs of a shallow decoder for one sample, (output,).

    features (node,): what the first layer reads
    weights three of (input, output): of the two rectified layers, and of the linear one
    offsets three of (output,): of these

    >>> one = np.ones((1, 1))
    >>> decoded(np.array([-3.0]), (one, -one, one), (np.zeros(1), np.ones(1), np.zeros(1)))
    array([1.])
    """
    first = np.maximum(np.dot(features, weights[0]) + offsets[0], 0.0)
    second = np.maximum(np.dot(first, weights[1]) + offsets[1], 0.0)
    return np.dot(second, weights[2]) + offsets[2]
