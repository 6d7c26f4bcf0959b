"""The scale of a set of columns: what a fit subtracts and divides by."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from gaitdisc.recording.arrays import read_only

RELATIVE_FLOOR = 1e-9  # a column that varies by less than this of its size is constant
ABSOLUTE_FLOOR = 1e-12  # deg, m, V and their rates: rounding, never a signal


@dataclass(frozen=True, eq=False)
class Scale:
    """Mean and standard deviation of every column, as the training part has them."""

    mean: NDArray[np.float64]  # (column,) [each column's unit], what is subtracted
    # (column,) [each column's unit], what is divided by; infinite for a constant column, which thereby becomes 0
    # wherever it is used, also where it is not constant any more
    sd: NDArray[np.float64]

    def __post_init__(self) -> None:
        """Freeze the numbers."""
        object.__setattr__(self, "mean", read_only(self.mean))
        object.__setattr__(self, "sd", read_only(self.sd))

    @property
    def constant(self) -> NDArray[np.bool_]:
        """True for each column that did not vary, (column,)."""
        return ~np.isfinite(self.sd)

    def scaled(self, values: NDArray[np.float64]) -> NDArray[np.float64]:
        """Without unit: zero mean and unit standard deviation where the scale comes from.

        values (sample, column) [each column's unit]: in the order of the scale
        """
        return (values - self.mean) / self.sd

    def unscaled(self, scaled: NDArray[np.float64]) -> NDArray[np.float64]:
        """Back in the columns' units; a constant column gets its constant.

        scaled (sample, column): without unit
        """
        return scaled * np.where(self.constant, 0.0, self.sd) + self.mean


def scale_of(values: NDArray[np.float64]) -> Scale:
    """Scale of the columns of a training part.

    values (sample, column) [each column's unit]: finite, or NaN where a value is missing; a column that is missing
        throughout is constant

    >>> scale = scale_of(np.array([[0.0, 7.0], [2.0, 7.0]]))
    >>> scale.mean, scale.sd, scale.constant
    (array([1., 7.]), array([ 1., inf]), array([False,  True]))
    """
    mean, sd = values.mean(axis=0), values.std(axis=0)
    for column in np.flatnonzero(np.isnan(mean)):
        known = values[~np.isnan(values[:, column]), column]
        mean[column], sd[column] = (known.mean(), known.std()) if len(known) else (0.0, 0.0)
    still = sd <= ABSOLUTE_FLOOR + RELATIVE_FLOOR * np.nanmax(np.abs(values), axis=0, initial=0.0)
    return Scale(mean, np.where(still, np.inf, sd))
