"""Variance accounted for in held-out walking, and the R2 that band-limited noise without any gait reaches."""

from collections.abc import Callable

import numpy as np
from numpy.typing import ArrayLike, NDArray

from gaitdisc.errors import ShapeError
from gaitdisc.recording.arrays import Values

ROUNDING = 1e-9  # of the largest value: a spread below it is rounding


def r2(measured: ArrayLike, predicted: ArrayLike) -> NDArray[np.float64]:
    """Coefficient of determination of every column: 1 - SSE / SST, with SST about the mean of the measured values.

    It is 1 for a perfect prediction, 0 for one as good as the mean, and has no lower bound. It is NaN if it is
    undefined; `why_no_r2` gives the reason.

    Parameters
    ----------
    measured, predicted : array_like (sample, column), or (sample,) [each column's unit]
        Held-out samples and their predictions. Rows and columns must be in the same order.

    Returns
    -------
    ndarray (column,)
        R2 of each column.

    Raises
    ------
    ShapeError
        If the shapes differ.

    References
    ----------
    Ebers 2023, section 4.2.3.

    Examples
    --------
    >>> r2(np.array([[0.0], [1.0], [2.0]]), np.array([[0.0], [1.0], [1.0]]))
    array([0.5])
    """
    measured, predicted = (
        values[:, None] if values.ndim == 1 else values
        for values in (np.asarray(array, float) for array in (measured, predicted))
    )
    meaningless = np.array([bool(reason) for reason in why_no_r2(measured, predicted)])
    y, f = (np.where(meaningless, 0.0, values) for values in (measured, predicted))
    sse = np.sum((y - f) ** 2, axis=0)
    sst = np.sum((y - y.mean(axis=0)) ** 2, axis=0) if len(y) else sse
    return np.where(meaningless, np.nan, 1.0 - sse / np.where(meaningless, 1.0, sst))


def why_no_r2(measured: Values, predicted: Values) -> tuple[str, ...]:
    """Reason for every column why it has no coefficient of determination; empty where it has one.

    measured, predicted (sample, column) [each column's unit]: as for `r2`

    >>> why_no_r2(np.full((3, 1), 0.5), np.zeros((3, 1)))
    ('the measured values do not vary: 0.5 in all 3 samples',)
    """
    if np.ndim(measured) != 2 or np.shape(measured) != np.shape(predicted):
        raise ShapeError(
            "for R², measured and predicted values must have the same shape (sample, column)",
            f"their shapes are {np.shape(measured)} and {np.shape(predicted)}",
            "Give one prediction per sample and column.",
        )
    return tuple(_reason(y, f) for y, f in zip(measured.T, predicted.T, strict=True))


def _reason(measured: Values, predicted: Values) -> str:
    if len(measured) < 2:
        return f"too few samples (n = {len(measured)})"
    missing = int(np.sum(~np.isfinite(measured) | ~np.isfinite(predicted)))
    if missing:
        return f"values are missing in {missing} of {len(measured)} samples"
    if measured.std() <= ROUNDING * np.abs(measured).max():
        return f"the measured values do not vary: {measured[0]:.6g} in all {len(measured)} samples"
    return ""


Filtered = Callable[[Values], tuple[Values, Values, Values]]
EDGE = 0.05  # share left away at either end, where filters ring


def simulate_null(filtered: Filtered, samples: int, walks: int = 40, seed: int = 0) -> float:
    """R2 of a linear regression of x'' on x and x' in noise that went through the filters of the measurement.

    The spectrum of a low-passed signal ties x'' to x, whatever was measured: a flat band has corr^2(x, x'') = 5/9. A
    model of gait has learned something only where its R2 is above this.

    filtered: takes white noise (sample, walk) and gives x, x', x'' of any one length, filtered and differentiated as
        the measurement was: 6 Hz low-pass for angles; high-pass, rectify, low-pass for EMG
    samples: length of a walk of noise, at the rate that `filtered` takes

    >>> def oscillation(noise):
    ...     t = np.linspace(0, 50, len(noise))[:, None] + noise[:1]
    ...     return np.sin(t), np.cos(t), -np.sin(t)
    >>> round(simulate_null(oscillation, 500, walks=4), 6)
    1.0
    """
    noise = np.random.default_rng(seed).standard_normal((samples, walks))
    x, xdot, xddot = filtered(noise)
    edge = int(EDGE * len(x))
    middle = slice(edge, len(x) - edge)
    reached = []
    for k in range(walks):
        columns = np.column_stack([x[middle, k], xdot[middle, k], np.ones(len(x[middle]))])
        solution = np.linalg.lstsq(columns, xddot[middle, k], rcond=None)[0]
        reached.append(float(r2(xddot[middle, k][:, None], (columns @ solution)[:, None])[0]))
    return float(np.mean(reached))
