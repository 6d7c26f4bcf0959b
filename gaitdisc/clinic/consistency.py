"""How alike the cycles of a leg are: coefficient of multiple correlation (Kadaba et al. 1989)."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray


def multiple_correlation(curves: NDArray[np.float64]) -> float:
    """Adjusted coefficient of multiple correlation of cycles of one session; NaN where it is not defined.

    1 less the ratio of the variance about the mean curve to the variance about the grand mean, its root; not defined
    for one cycle, nor where cycles differ more from their mean curve than the curve does from its own mean.

    curves (cycle, phase): on even points
    Source: Kadaba MP, Ramakrishnan HK, Wootten ME et al. 1989, Repeatability of kinematic, kinetic, and
        electromyographic data.

    >>> round(multiple_correlation(np.array([[0.0, 2.0, 4.0], [1.0, 3.0, 5.0]])), 4)
    0.9258
    """
    cycles, points = curves.shape
    if cycles < 2:
        return float("nan")
    within = float(((curves - curves.mean(axis=0)) ** 2).sum()) / (points * (cycles - 1))
    whole = float(((curves - curves.mean()) ** 2).sum()) / (points * cycles - 1)
    if whole == 0.0 or within > whole:
        return float("nan")
    return float(np.sqrt(1.0 - within / whole))
