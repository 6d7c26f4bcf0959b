"""SHRED's latent state: its course in time, and how large it has to be beside the singular values (Fig. 5.1)."""

from __future__ import annotations

from collections.abc import Sequence
from functools import partial

import numpy as np
import pandas as pd
from numpy.typing import NDArray

from gaitdisc.errors import TrainingError
from gaitdisc.recording import Field, Samples
from gaitdisc.sensing.field_task import FieldTask
from gaitdisc.sensing.reconstruct_field import field_cells, prepare
from gaitdisc.sensing.reconstructor import Reconstructor
from gaitdisc.sensing.routes import Route

SIZES = (1, 2, 3, 5, 8, 12, 20, 32, 64)
COLUMNS = ("nodes", "split", "quantity", "relative_l2", "r2", "energy_left")


def latent_sizes(
    field: Field, route: Route, task: FieldTask, sizes: Sequence[int] = SIZES, epochs: int = 20
) -> pd.DataFrame:
    """Error of SHRED with recurrent layers of several sizes, beside what as many singular values leave.

    epochs: passes over the training part; more where 1,000 steps need more
    returns: nodes, split, quantity, relative_l2, r2, energy_left: share of the training part's energy beyond so many
        modes
    Source: Ebers 2023, section 5.2 and Fig. 5.1: both elbows are seen near 5, and a relation is conjectured.
    """
    from gaitdisc.networks.shred import Shred
    from gaitdisc.networks.trainer import train
    from gaitdisc.networks.training_settings import TrainingSettings

    ready = prepare(field, route, task)
    settings = TrainingSettings(epochs=epochs, batch=128, decays=(0.01,), seed=task.seed)
    rows = []
    for nodes in sizes:
        build = partial(Shred, sensors=len(ready.what.sensors), nodes=nodes)
        model = train(ready.training, build, settings, check=ready.check).network
        label = task.label(route.name, f"shred {nodes}")
        left = float(1 - np.sum(ready.targets.modes.energies[:nodes]))
        for cell in field_cells(field, ready, label, ready.targets.fields(model(ready.test.x), ready.test)):
            rows.append((nodes, task.rule, cell.quantity, cell.relative_l2, cell.r2, left))
    return pd.DataFrame(rows, columns=pd.Index(list(COLUMNS)))


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
