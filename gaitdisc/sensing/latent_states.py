"""SHRED's latent state and its course in time."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from gaitdisc.errors import TrainingError
from gaitdisc.recording import Samples
from gaitdisc.sensing.reconstructor import Reconstructor


def latent_states(done: Reconstructor, windows: Samples) -> NDArray[np.float64]:
    """Latent state of a fitted SHRED at the last reading of each window, (window, node) [1]."""
    from gaitdisc.networks.shred import Shred
    from gaitdisc.networks.trained_network import TrainedNetwork

    model = done.model
    if not isinstance(model, TrainedNetwork) or not isinstance(model.network, Shred):
        raise TrainingError(
            "a latent state is that of one recurrent network",
            f"the model is {done.kind!r}, which has none",
            "Fit 'shred', 'masked shred' or 'shred-text'.",
        )
    return model.latent(windows.x)


def leading(values: NDArray[np.float64], count: int = 3) -> NDArray[np.float64]:
    """Return the first principal components in time, each of standard deviation 1, (time, component) [1].

    The largest entry of each component's direction is positive, so that its sign does not rest on the decomposition.

    >>> t = np.linspace(0, 2 * np.pi, 100, endpoint=False)
    >>> found = leading(np.column_stack([3 * np.sin(t), np.cos(t)]), 2)
    >>> bool(np.allclose(found, np.sqrt(2) * np.column_stack([np.sin(t), np.cos(t)])))
    True
    """
    about = values - values.mean(axis=0)
    u, _, v = np.linalg.svd(about, full_matrices=False)
    signs = np.sign(v[np.arange(len(v)), np.argmax(np.abs(v), axis=1)])
    return (u * signs)[:, :count] * np.sqrt(len(values))
