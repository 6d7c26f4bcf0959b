"""One cell of a field study: a route of sensors, a split and a model, and how far the told field is off."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
import pandas as pd
from numpy.typing import NDArray

from gaitdisc.recording.arrays import read_only

BINS = 121
REACH_SD = 4.0  # of the field's own standard deviation: how far the bins of errors reach


@dataclass(frozen=True, eq=False)
class ErrorCounts:
    """How often an error of each size was made, over all points and judged snapshots.

    Parameters
    ----------
    edges : ndarray (bin + 1,) [unit]
        Of the bins; the outer two bins take what lies beyond.
    counts : ndarray (bin,)
        Values in each.
    """

    edges: NDArray[np.float64]
    counts: NDArray[np.int_]

    def __post_init__(self) -> None:
        """Freeze the numbers."""
        object.__setattr__(self, "edges", read_only(self.edges))
        object.__setattr__(self, "counts", read_only(self.counts, int))


@dataclass(frozen=True, eq=False)
class FieldCell:
    """What one model told of one quantity of a field.

    Parameters
    ----------
    field, quantity, unit : str
        Names, and the quantity's unit.
    route, split, model : str
        What was varied.
    relative_l2 : float
        Norm of the error over the norm of the field about zero, of all judged values at once (Eq. 2.21); 1 for a model
        that says 0.
    rmse, bias, sd : float [unit]
        Root mean square, mean and standard deviation of told minus measured.
    r2 : float
        1 - mean squared error over the mean squared distance from the training part's mean field; 0 for a model that
        says that mean.
    fitted, judged : int
        Windows.
    seconds : float [s]
        Processor time of the fit.
    run : int
        Number of the run, where one cell was computed several times with other seeds.
    errors : ErrorCounts
        For the histograms.
    """

    field: str
    quantity: str
    unit: str
    route: str
    split: str
    model: str
    relative_l2: float
    rmse: float
    bias: float
    sd: float
    r2: float
    fitted: int
    judged: int
    seconds: float
    run: int
    errors: ErrorCounts


def field_cells_table(cells: Sequence[FieldCell]) -> pd.DataFrame:
    """Numbers of all cells, one row each, without the counts of errors.

    Parameters
    ----------
    cells : sequence of FieldCell
        Of any study.
    """
    rows = [{name: value for name, value in vars(cell).items() if name != "errors"} for cell in cells]
    columns = [name for name in FieldCell.__dataclass_fields__ if name != "errors"]
    return pd.DataFrame(rows, columns=pd.Index(columns))


def error_counts(errors: NDArray[np.floating], sd: float) -> ErrorCounts:
    """Count errors by size.

    Parameters
    ----------
    errors : ndarray, any shape [unit]
        Told minus measured.
    sd : float [unit]
        Of the field; the bins reach four of it to each side.

    Examples
    --------
    >>> error_counts(np.array([0.0, 99.0]), 1.0).counts[[60, 120]].tolist()
    [1, 1]
    """
    edges = np.linspace(-REACH_SD * sd, REACH_SD * sd, BINS + 1)
    place = np.clip(np.searchsorted(edges, errors.ravel(), side="right") - 1, 0, BINS - 1)
    return ErrorCounts(edges, np.bincount(place, minlength=BINS))


def shares_within(cell: FieldCell) -> dict[str, float]:
    """Share of errors of each sign and size, as a Gaussian of the same mean and spread would have them.

    Parameters
    ----------
    cell : FieldCell
        Of any model.

    Returns
    -------
    dict
        `within one sd`: a Gaussian has .683; more means a sharper peak and longer tails.
    """
    middles = (cell.errors.edges[1:] + cell.errors.edges[:-1]) / 2
    inside = np.abs(middles - cell.bias) <= cell.sd
    return {"within one sd": float(cell.errors.counts[inside].sum() / cell.errors.counts.sum())}
