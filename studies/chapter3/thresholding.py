"""Sparse regression: least squares whose small coefficients are dropped, again and again."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from gaitdisc.errors import TrainingError
from gaitdisc.recording import Samples

from .extra import chapter3_library
from .polynomials import written

THRESHOLDS = tuple(10.0**power for power in np.linspace(-3.0, -0.5, 16))  # of the output's size, where none is given
NEAR_BEST = 0.02  # of the least error on the inner block: the sparsest model so close is taken
GOOD_ENOUGH = 1e-4  # of the outputs' mean square: a hundredth of their size
SMALL = 0.05  # of the largest output: a smaller one is weighed as if it were so large
PASSES = 10  # of thresholding, as the published code
LEAST_APART = 1e-8  # of a term's length from its nearest sum of simpler terms: nearer, half of all digits are lost
NAMED = 1e-5  # of a term's length: what a simpler term must hold of it to be named

Sizes = tuple[NDArray[np.float64] | float, NDArray[np.float64] | float]
Rows = tuple[NDArray[np.float64], NDArray[np.float64]]


def sizes_of(columns: NDArray[np.float64], y: NDArray[np.float64]) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
    """What columns (term,) and outputs (output,) are divided by before a threshold acts on their coefficients."""
    size = np.sqrt(np.mean(y**2, axis=0))
    return np.sqrt(np.mean(columns**2, axis=0)), np.maximum(size, SMALL * size.max())


def chosen_threshold(before: Rows, inner: Rows, sizes: Sizes) -> float:
    """The largest threshold that is nearly as good on an inner block as the best one."""
    check, wanted = inner[0] / sizes[0], inner[1] / sizes[1]
    error = np.array([np.mean((check @ thresholded(before, sizes, each) - wanted) ** 2) for each in THRESHOLDS])
    near = np.flatnonzero(error <= max((1 + NEAR_BEST) * error.min(), GOOD_ENOUGH))
    return THRESHOLDS[int(near[-1])]


def in_axes(rows: Rows, powers: NDArray[np.int64], samples: Samples) -> Rows:
    """Columns and outputs in the axes of the columns: least squares finds the same in these few rows as in all."""
    columns, outputs = rows
    length = np.sqrt(np.sum(columns**2, axis=0))
    length[length == 0] = 1.0
    axes, triangle = np.linalg.qr(columns / length)
    near = np.flatnonzero(np.abs(np.diag(triangle)) < LEAST_APART)
    if len(near):
        k = int(near[0])
        of_simpler = np.linalg.solve(triangle[:k, :k], triangle[:k, k])
        names = [written(samples.inputs, row) for row in powers]
        amounts = np.where(np.abs(of_simpler) < NAMED, 0.0, of_simpler) * length[k] / length[:k]
        parts = [f"{value:.4g}*{name}" for value, name in zip(amounts, names[:k], strict=True) if value]
        relation = " + ".join(parts).replace("+ -", "- ").replace("*1 ", " ").removesuffix("*1") or "0"
        more = f", and {len(near) - 1} more of its terms are such sums" if len(near) > 1 else ""
        raise TrainingError(
            "SINDy needs terms that differ on the samples, or rounding decides which of them the model has",
            f"{samples.subject or 'the recording'}: {names[k]} = {relation} in all {len(columns)} samples{more}",
            "Record what breaks the relation (another start, another amplitude), leave an input away, or lower the "
            "degree.",
        )
    return triangle * length, axes.T @ outputs


def thresholded(triangle: Rows, sizes: Sizes, threshold: float) -> NDArray[np.float64]:
    """Coefficients (term, output) of columns and outputs divided by their sizes, PySINDy's STLSQ."""
    import warnings

    accurate = {"solver": "svd"}  # the normal equations would lose twice as many digits
    optimizer = chapter3_library("pysindy").STLSQ(threshold=threshold, alpha=0.0, max_iter=PASSES, ridge_kw=accurate)
    with warnings.catch_warnings():
        warnings.simplefilter("ignore")  # that nothing is left, which the coefficients say themselves
        optimizer.fit(triangle[0] / sizes[0], triangle[1] / sizes[1])
    return np.asarray(optimizer.coef_, float).T
