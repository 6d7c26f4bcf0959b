"""How large SHRED's latent state has to be, beside the singular values (Fig. 5.1)."""

from __future__ import annotations

from collections.abc import Sequence
from functools import partial

import numpy as np
import pandas as pd

from gaitdisc.recording import Field

from .field_task import FieldTask
from .reconstruct_field import field_cells, prepare
from .routes import Route

SIZES = (1, 2, 3, 5, 8, 12, 20, 32, 64)
COLUMNS = ("nodes", "split", "quantity", "relative_l2", "r2", "energy_left")


def latent_sizes(
    field: Field, route: Route, task: FieldTask, sizes: Sequence[int] = SIZES, epochs: int = 20
) -> pd.DataFrame:
    """Error of SHRED with recurrent layers of several sizes, beside what as many singular values leave.

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
