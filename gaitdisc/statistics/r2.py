"""Coefficient of determination: variance accounted for in held-out walking."""

from __future__ import annotations

import numpy as np
from numpy.typing import ArrayLike, NDArray

from gaitdisc.errors import ShapeError

ROUNDING = 1e-9  # of the largest value: a spread below it is rounding


def r2(measured: ArrayLike, predicted: ArrayLike) -> NDArray[np.float64]:
    """Coefficient of determination of every column, 1 - SSE / SST, SST about the mean of the measured part itself.

    It is 1 for a perfect prediction, 0 for one as good as the mean, and has no lower bound. It is NaN where it means
    nothing; `why_no_r2` says why.

    Parameters
    ----------
    measured, predicted : array_like (sample, column), or (sample,) [each column's unit]
        Held-out samples, and what a model says of them. Rows and columns are taken as they stand.

    Returns
    -------
    ndarray (column,)

    Raises
    ------
    ShapeError
        If the two differ in shape.

    References
    ----------
    Ebers 2023, section 4.2.3.

    Examples
    --------
    >>> r2(np.array([[0.0], [1.0], [2.0]]), np.array([[0.0], [1.0], [1.0]]))
    array([0.5])
    """
    measured, predicted = (_columns(values) for values in (measured, predicted))
    meaningless = np.array([bool(reason) for reason in why_no_r2(measured, predicted)])
    y, f = (np.where(meaningless, 0.0, values) for values in (measured, predicted))
    sse = np.sum((y - f) ** 2, axis=0)
    sst = np.sum((y - y.mean(axis=0)) ** 2, axis=0) if len(y) else sse
    return np.where(meaningless, np.nan, 1.0 - sse / np.where(meaningless, 1.0, sst))


def _columns(values: ArrayLike) -> NDArray[np.float64]:
    array = np.asarray(values, float)
    return array[:, None] if array.ndim == 1 else array


def why_no_r2(measured: NDArray[np.float64], predicted: NDArray[np.float64]) -> tuple[str, ...]:
    """Reason for every column why it has no coefficient of determination; empty where it has one.

    measured, predicted (sample, column) [each column's unit]: as for `r2`

    >>> why_no_r2(np.full((3, 1), 0.5), np.zeros((3, 1)))
    ('the measured part does not vary: 0.5 in all 3 samples',)
    """
    if np.ndim(measured) != 2 or np.shape(measured) != np.shape(predicted):
        raise ShapeError(
            "R2 needs measured and predicted of one shape (sample, column)",
            f"found {np.shape(measured)} and {np.shape(predicted)}",
            "Give one prediction a sample and column.",
        )
    return tuple(_reason(y, f) for y, f in zip(measured.T, predicted.T, strict=True))


def _reason(measured: NDArray[np.float64], predicted: NDArray[np.float64]) -> str:
    if len(measured) < 2:
        return f"{len(measured)} samples are too few"
    missing = int(np.sum(~np.isfinite(measured) | ~np.isfinite(predicted)))
    if missing:
        return f"{missing} of {len(measured)} samples are missing"
    if measured.std() <= ROUNDING * np.abs(measured).max():
        return f"the measured part does not vary: {measured[0]:.6g} in all {len(measured)} samples"
    return ""
