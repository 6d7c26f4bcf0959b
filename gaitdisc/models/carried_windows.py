"""SHRED read live: every window that is under way carries its state, and none is read again."""

from typing import NamedTuple

import numpy as np
from scipy.special import expit

from gaitdisc.models.networks import Shred
from gaitdisc.models.trained_network import TrainedNetwork
from gaitdisc.recording.arrays import Values


class Linear(NamedTuple):
    """A linear layer: what is read times `weights` (input, output), and `offsets` (output,)."""

    weights: Values
    offsets: Values


class CarriedWindows:
    """Every window that is under way, one reading further at each call; gives what the torch network gives.

    A window has `count` readings, `spacing` samples apart, and begins with a state of zero. At any time one window of
    each age is under way in each of `spacing` phases. A new reading belongs to those of one phase: all of them go one
    step as one matrix product, the oldest is then whole and is decoded, and a new one begins. The products are as many
    as in one window that is read again, but side by side, where that would be `count` of them one after the other.

    A reading that is NaN makes every window NaN that holds it, unless the network was made for that (`masked`).

    count, spacing: readings of a window, and samples from one to the next
    """

    def __init__(self, network: TrainedNetwork, count: int, spacing: int) -> None:
        shred = network.network
        assert isinstance(shred, Shred)  # nothing else is given
        self._cell, self._masked = shred.cell, shred.masked
        named = {name: np.ascontiguousarray(values.T, float) for name, values in network.weights().items()}
        # of each recurrent layer: what it makes of what is read (input, gate * node), and of its state (node, ...)
        self._layers = [
            [Linear(named[f"recurrent.weight_{of}_l{k}"], named[f"recurrent.bias_{of}_l{k}"]) for of in ("ih", "hh")]
            for k in range(shred.recurrent.num_layers)
        ]
        self._decoder = [
            Linear(named[f"decoder.{name}.weight"], named[f"decoder.{name}.bias"])
            for name in ("first", "second", "readout")
        ]
        self._mean = network.x_scale.mean.reshape(count, -1)
        self._sd = network.x_scale.sd.reshape(count, -1)
        self._y_scale = network.y_scale
        # (phase, layer, age, node): the state of a window that has `age` readings, before the next one
        shape = (spacing, len(self._layers), count, shred.recurrent.hidden_size)
        self._states, self._cells = (np.full(shape, np.nan) for _ in range(2))
        self._states[:, :, 0] = self._cells[:, :, 0] = 0.0
        self._silent = np.zeros(spacing, int)  # readings of a phase since one that was known
        self._phase = 0

    def update(self, reading: Values) -> Values:
        """Outputs (output,) of the window that ends with a reading (sensor,), one sample on; NaN until it is whole."""
        read = (reading - self._mean) / self._sd
        if self._masked:
            missing = np.isnan(read)
            self._silent[self._phase] = self._silent[self._phase] + 1 if np.isnan(reading).all() else 0
            read = np.hstack([np.where(missing, 0.0, read), missing])
        for layer, (of_input, of_state) in enumerate(self._layers):
            states, cells = self._states[self._phase, layer], self._cells[self._phase, layer]
            if self._cell == "gru":
                read = gru_step(read, states, of_input, of_state)
            else:
                read, new_cells = lstm_step(read, states, cells, of_input, of_state)
                cells[1:] = new_cells[:-1]
            states[1:] = read[:-1]
        if self._silent[self._phase] >= len(self._mean):
            read = np.full_like(read, np.nan)  # no reading at all: a state that nothing shows
        self._phase = (self._phase + 1) % len(self._states)
        return self._y_scale.unscaled(decoded(read[-1], *self._decoder))


def gru_step(read: Values, states: Values, of_input: Linear, of_state: Linear) -> Values:
    """States of a layer of gated recurrent units after one more reading, (window, node).

    read (window, input): what each window reads now
    states (window, node): before
    of_input, of_state (input, 3 node), (node, 3 node): to the reset gate, the update gate and the candidate
    Source: Cho et al. 2014; the reset gate acts after the product, as in torch.

    >>> one, none = Linear(np.ones((1, 3)), np.zeros(3)), Linear(np.zeros((1, 3)), np.zeros(3))
    >>> gru_step(np.zeros((1, 1)), np.ones((1, 1)), one, none)  # gates half open, candidate 0
    array([[0.5]])
    """
    a, b = read @ of_input.weights + of_input.offsets, states @ of_state.weights + of_state.offsets
    a, b = (part.reshape(len(part), 3, -1).swapaxes(0, 1) for part in (a, b))  # gate first
    reset, update = expit(a[:2] + b[:2])
    candidate = np.tanh(a[2] + reset * b[2])
    return candidate + update * (states - candidate)


def lstm_step(read: Values, states: Values, cells: Values, of_input: Linear, of_state: Linear) -> tuple[Values, Values]:
    """States and cells of a layer of long short-term memory after one more reading, each (window, node).

    of_input, of_state (input, 4 node), (node, 4 node): to input gate, forget gate, candidate, output gate
    Source: Hochreiter and Schmidhuber 1997, with the forget gate of Gers et al. 2000, as in torch.

    >>> one, none = Linear(np.ones((1, 4)), np.zeros(4)), Linear(np.zeros((1, 4)), np.zeros(4))
    >>> lstm_step(np.zeros((1, 1)), np.ones((1, 1)), np.ones((1, 1)), one, none)[1]
    array([[0.5]])
    """
    sums = read @ of_input.weights + states @ of_state.weights + of_input.offsets + of_state.offsets
    take, keep, candidate, give = sums.reshape(len(sums), 4, -1).swapaxes(0, 1)
    new_cells = expit(keep) * cells + expit(take) * np.tanh(candidate)
    return expit(give) * np.tanh(new_cells), new_cells


def decoded(features: Values, first: Linear, second: Linear, readout: Linear) -> Values:
    """Scaled outputs of a shallow decoder for one sample, (output,).

    features (node,): what the first of the two rectified layers reads

    >>> one, none = np.ones((1, 1)), np.zeros(1)
    >>> decoded(np.array([-3.0]), Linear(one, none), Linear(-one, none + 1), Linear(one, none))
    array([1.])
    """
    for layer in (first, second):
        features = np.maximum(features @ layer.weights + layer.offsets, 0.0)
    return features @ readout.weights + readout.offsets
