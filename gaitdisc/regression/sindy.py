"""Sparse identification of nonlinear dynamics: a few polynomial terms, each with its coefficient."""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from gaitdisc.errors import TrainingError
from gaitdisc.recording import Samples
from gaitdisc.recording.arrays import read_only
from gaitdisc.regression.extra import chapter3_library

THRESHOLDS = tuple(10.0**power for power in np.linspace(-3.0, -0.5, 16))  # of the output's size, where none is given
NEAR_BEST = 0.02  # of the least error on the inner block: the sparsest model so close is taken
GOOD_ENOUGH = 1e-4  # of the outputs' mean square: a hundredth of their size
SMALL = 0.05  # of the largest output: a smaller one is weighed as if it were so large
SEAM_S = 0.3  # as Trajectory.split: zero-lag filters look ahead over the seam
LEAST_BEFORE_INNER = 20
PASSES = 10  # of thresholding, as the published code
LEAST_APART = 1e-8  # of a term's length from its nearest sum of simpler terms: nearer, half of all digits are lost
NAMED = 1e-5  # of a term's length: what a simpler term must hold of it to be named


@dataclass(frozen=True, eq=False)
class Sindy:
    """Sums of products of the inputs; a `gaitdisc.model.Model`.

    Parameters
    ----------
    powers : ndarray of int (term, input)
        Of each term of the library.
    coefficients : ndarray (term, output) [output's unit over term's unit]
        Zero where a term is not in the model.
    """

    inputs: tuple[str, ...]
    outputs: tuple[str, ...]
    powers: NDArray[np.int64]
    coefficients: NDArray[np.float64]
    threshold: float

    def __post_init__(self) -> None:
        """Freeze the numbers."""
        object.__setattr__(self, "powers", read_only(self.powers, np.int64))
        object.__setattr__(self, "coefficients", read_only(self.coefficients))

    def __call__(self, x: NDArray[np.float64]) -> NDArray[np.float64]:
        """Outputs (sample, output) for inputs (sample, input)."""
        return products(x, self.powers) @ self.coefficients

    def terms(self, output: str) -> dict[str, float]:
        """Terms of one output with their coefficients, as a simulation file writes them."""
        column = self.coefficients[:, self.outputs.index(output)]
        return {written(self.inputs, row): float(column[k]) for k, row in enumerate(self.powers) if column[k]}

    def expression(self, output: str) -> str:
        """Return one output as an expression that a simulation file understands."""
        return " + ".join(f"{value:.8g}*{term}" for term, value in self.terms(output).items()) or "0"


def fit_sindy(samples: Samples, degree: int = 3, threshold: float | None = None, bags: int = 0, seed: int = 0) -> Sindy:
    """Fit polynomial terms and drop the small ones, again and again (sequentially thresholded least squares).

    With a threshold given, it acts on the coefficients in their units, as in the published code. Without one, columns
    and outputs are divided by their size first, and of `THRESHOLDS` the largest is taken whose error on the last 15 %
    of the samples (contiguous, 0.3 s apart) is within 2 % of the least, or below 1e-4 of the outputs'
    mean square; an output smaller than a twentieth of the largest one is weighed as a twentieth of it.

    Parameters
    ----------
    bags : int
        Fits on samples drawn with replacement, whose median is taken; 0 for one plain fit.

    References
    ----------
    Brunton, Proctor, Kutz 2016, PNAS 113:3932; Fasel et al. 2022, Proc. R. Soc. A 478:20210904 for the bags.

    Examples
    --------
    >>> t = np.arange(200) / 20
    >>> x = np.column_stack([np.sin(t), np.cos(np.sqrt(2) * t)])
    >>> s = Samples(x, -0.01 * x[:, :1] ** 3, ("x", "y"), ("v",), t, t)
    >>> fit_sindy(s, threshold=0.005).expression("v")
    '-0.01*x**3'
    """
    terms = math.comb(len(samples.inputs) + degree, degree)
    if len(samples) < terms:
        raise TrainingError(
            f"a library of degree {degree} in {len(samples.inputs)} inputs has {terms} terms and needs as many samples",
            f"there are {len(samples)}, {terms - len(samples)} too few",
            "Record longer, or lower the degree.",
        )
    powers = library(len(samples.inputs), degree)
    samples.trainable(len(powers))
    if threshold is None:
        return _of_chosen_threshold(samples, powers, bags, seed)
    found = _thresholded(samples, powers, (1.0, 1.0), threshold, (bags, seed))
    return Sindy(samples.inputs, samples.outputs, powers, found, threshold)


Sizes = tuple[NDArray[np.float64] | float, NDArray[np.float64] | float]


def _of_chosen_threshold(samples: Samples, powers: NDArray[np.int64], bags: int, seed: int) -> Sindy:
    _triangle(samples, powers)  # what all samples cannot tell apart is refused before a part of them is
    before, inner = samples.last_block(0.15, SEAM_S)
    before.trainable(max(LEAST_BEFORE_INNER, len(powers)))
    size = np.sqrt(np.mean(samples.y**2, axis=0))
    size = np.maximum(size, SMALL * size.max())
    width = np.sqrt(np.mean(products(samples.x, powers) ** 2, axis=0))
    check, triangle = products(inner.x, powers) / width, _triangle(before, powers)
    error = np.array([
        np.mean((check @ _plain(triangle, (width, size), each) - inner.y / size) ** 2) for each in THRESHOLDS
    ])  # fmt: skip
    near = np.flatnonzero(error <= max((1 + NEAR_BEST) * error.min(), GOOD_ENOUGH))
    threshold = THRESHOLDS[int(near[-1])]
    found = _thresholded(samples, powers, (width, size), threshold, (bags, seed))
    return Sindy(samples.inputs, samples.outputs, powers, found * size / width[:, None], threshold)


def _thresholded(
    samples: Samples, powers: NDArray[np.int64], sizes: Sizes, threshold: float, draws: tuple[int, int]
) -> NDArray[np.float64]:
    """Coefficients (term, output) of terms and outputs divided by their sizes."""
    triangle, (bags, seed) = _triangle(samples, powers), draws
    if not bags:
        return _plain(triangle, sizes, threshold)
    rng = np.random.default_rng(seed)
    bagged = [samples.rows(rng.integers(len(samples), size=len(samples))) for _ in range(bags)]
    middle = np.median([_plain(_triangle(each, powers), sizes, threshold) for each in bagged], axis=0)
    return np.where(np.abs(middle) < threshold, 0.0, middle)


Triangle = tuple[NDArray[np.float64], NDArray[np.float64]]


def _triangle(samples: Samples, powers: NDArray[np.int64]) -> Triangle:
    """Library and outputs in the axes of the library: least squares finds the same in these few rows as in all."""
    columns = products(samples.x, powers)
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
            f"{samples.subject or 'the recording'}: {names[k]} = {relation} in all {len(samples)} samples{more}",
            "Record what breaks the relation (another start, another amplitude), leave an input away, or lower the "
            "degree.",
        )
    return triangle * length, axes.T @ samples.y


def _plain(triangle: Triangle, sizes: Sizes, threshold: float) -> NDArray[np.float64]:
    import warnings

    accurate = {"solver": "svd"}  # the normal equations would lose twice as many digits
    optimizer = chapter3_library("pysindy").STLSQ(threshold=threshold, alpha=0.0, max_iter=PASSES, ridge_kw=accurate)
    with warnings.catch_warnings():
        warnings.simplefilter("ignore")  # that nothing is left, which the coefficients say themselves
        optimizer.fit(triangle[0] / sizes[0], triangle[1] / sizes[1])
    return np.asarray(optimizer.coef_, float).T


def written(inputs: tuple[str, ...], powers: NDArray[np.int64]) -> str:
    """Return a term of the library as a simulation file writes it.

    Parameters
    ----------
    powers : ndarray of int (input,)
        Of the term.

    Examples
    --------
    >>> written(("x", "y"), np.array([2, 1]))
    'x**2*y'
    """
    parts = [name if power == 1 else f"{name}**{power}" for name, power in zip(inputs, powers, strict=True) if power]
    return "*".join(parts) or "1"


def library(inputs: int, degree: int) -> NDArray[np.int64]:
    """Powers of every product of the inputs up to a degree, (term, input), the constant first.

    Examples
    --------
    >>> library(2, 2).tolist()
    [[0, 0], [1, 0], [0, 1], [2, 0], [1, 1], [0, 2]]
    """
    from itertools import combinations_with_replacement

    rows = [
        np.bincount(np.array(chosen, int), minlength=inputs)
        for total in range(degree + 1)
        for chosen in combinations_with_replacement(range(inputs), total)
    ]
    return np.array(rows, np.int64)


def products(x: NDArray[np.float64], powers: NDArray[np.int64]) -> NDArray[np.float64]:
    """Columns of the library, (sample, term).

    Parameters
    ----------
    x : ndarray (sample, input)
        Inputs.
    powers : ndarray of int (term, input)
        From `library`.
    """
    columns = np.ones((len(x), len(powers)))
    for k, row in enumerate(powers):
        for name, power in enumerate(row):
            if power:
                columns[:, k] *= x[:, name] ** int(power)
    return columns
