"""One cell of a field study: a route of sensors, a split and a model, and how far the reconstructed field is off."""

from __future__ import annotations

import json
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np
import pandas as pd
from numpy.typing import NDArray

from gaitdisc.recording.arrays import read_only
from gaitdisc.results.on_disk import DamagedError
from gaitdisc.results.sealed_json import read_sealed, sealed_text
from gaitdisc.whole_file import write_whole

BINS = 121
REACH_SD = 4.0  # of the field's own standard deviation: how far the bins of errors reach


@dataclass(frozen=True, eq=False)
class ErrorCounts:
    """How often an error of each size was made, over all points and test snapshots."""

    edges: NDArray[np.float64]  # (bin + 1,) [unit], of the bins; the outer two bins take what lies beyond
    counts: NDArray[np.int_]  # (bin,), values in each

    def __post_init__(self) -> None:
        """Freeze the numbers."""
        object.__setattr__(self, "edges", read_only(self.edges))
        object.__setattr__(self, "counts", read_only(self.counts, int))


@dataclass(frozen=True, eq=False)
class FieldCell:
    """How well one model reconstructs one quantity of a field."""

    field: str
    quantity: str
    unit: str
    route: str
    split: str
    model: str
    # norm of the error over the norm of the field about zero, of all test values at once (Eq. 2.21); 1 for a model
    # that says 0
    relative_l2: float
    rmse: float  # [unit], root mean square, mean and standard deviation of reconstructed minus measured
    bias: float  # [unit], root mean square, mean and standard deviation of reconstructed minus measured
    sd: float  # [unit], root mean square, mean and standard deviation of reconstructed minus measured
    # 1 - mean squared error over the mean squared distance from the training part's mean field; 0 for a model that says
    # that mean
    r2: float
    fitted: int
    tested: int
    seconds: float  # [s], processor time of the fit
    run: int  # number of the run, where one cell was computed several times with other seeds
    errors: ErrorCounts


def field_cells_table(cells: Sequence[FieldCell]) -> pd.DataFrame:
    """Numbers of all cells, one row each, without the counts of errors."""
    rows = [{name: value for name, value in vars(cell).items() if name != "errors"} for cell in cells]
    columns = [name for name in FieldCell.__dataclass_fields__ if name != "errors"]
    return pd.DataFrame(rows, columns=pd.Index(columns))


def error_counts(errors: NDArray[np.floating], sd: float) -> ErrorCounts:
    """Count errors by size."""
    edges = np.linspace(-REACH_SD * sd, REACH_SD * sd, BINS + 1)
    place = np.clip(np.searchsorted(edges, errors.ravel(), side="right") - 1, 0, BINS - 1)
    return ErrorCounts(edges, np.bincount(place, minlength=BINS))


def save_cells(cells: Sequence[FieldCell], made_by: Mapping[str, Any], path: Path) -> None:
    """Keep cells, so that a study that was stopped goes on."""
    rows = [
        {**vars(cell), "errors": {"edges": cell.errors.edges.tolist(), "counts": cell.errors.counts.tolist()}}
        for cell in cells
    ]
    write_whole(path, sealed_text({"made_by": dict(made_by), "cells": rows}))


def load_cells(made_by: Mapping[str, Any], path: Path) -> list[FieldCell] | None:
    """Cells that were kept, or None where there are none, other settings made them, or they were changed since."""
    try:
        held = read_sealed(path)
    except DamagedError:
        return None
    if held["made_by"] != json.loads(json.dumps(dict(made_by))):
        return None
    rows = [{"tested" if name == "judged" else name: value for name, value in row.items()} for row in held["cells"]]
    return [FieldCell(**{**row, "errors": ErrorCounts(**row["errors"])}) for row in rows]
