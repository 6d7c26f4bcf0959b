"""Sparse identification of nonlinear dynamics, plain and in weak form: a few polynomial terms."""

from __future__ import annotations

import importlib
import math
import warnings
from dataclasses import dataclass
from types import ModuleType

import numpy as np
from numpy.typing import NDArray

from gaitdisc.errors import TrainingError
from gaitdisc.recording import Samples

THRESHOLDS = tuple(10.0**power for power in np.linspace(-3.0, -0.5, 16))  # of the output's size, where none is given
NEAR_BEST = 0.02  # of the least error on the inner block: the sparsest model so close is taken
GOOD_ENOUGH = 1e-4  # of the outputs' mean square: a hundredth of their size
SMALL = 0.05  # of the largest output: a smaller one is weighed as if it were so large
PASSES = 10  # of thresholding, as the published code
LEAST_APART = 1e-8  # of a term's length from its nearest sum of simpler terms: nearer, half of all digits are lost
NAMED = 1e-5  # of a term's length: what a simpler term must hold of it to be named
Sizes = tuple[NDArray[np.float64] | float, NDArray[np.float64] | float]
Rows = tuple[NDArray[np.float64], NDArray[np.float64]]
SEAM_S = 0.3  # as Trajectory.split: zero-lag filters look ahead over the seam
LEAST_BEFORE_INNER = 20
WINDOW_S, OVERLAP = 0.5, 8  # of test functions; how many begin within the length of one


def chapter3_library(name: str) -> ModuleType:
    """Library of the extra `chapter3`."""
    try:
        with warnings.catch_warnings():
            warnings.simplefilter("ignore")  # of optional parts of theirs that are not used here
            return importlib.import_module(name)
    except ImportError as error:
        raise TrainingError(
            f"this method needs the library {name}",
            f"it cannot be imported ({error})",
            "Install the extra: pip install 'gaitdisc[chapter3]'.",
        ) from error


def written(inputs: tuple[str, ...], powers: NDArray[np.int64]) -> str:
    """Return a term of the library as a simulation file writes it."""
    parts = [name if power == 1 else f"{name}**{power}" for name, power in zip(inputs, powers, strict=True) if power]
    return "*".join(parts) or "1"


def library(inputs: int, degree: int) -> NDArray[np.int64]:
    """Powers of every product of the inputs up to a degree, (term, input), the constant first."""
    from sklearn.preprocessing import PolynomialFeatures

    return PolynomialFeatures(degree).fit(np.zeros((1, inputs))).powers_


def products(x: NDArray[np.float64], powers: NDArray[np.int64]) -> NDArray[np.float64]:
    """Columns of the library, (sample, term)."""
    columns = np.ones((len(x), len(powers)))
    for k, name in np.argwhere(powers):
        columns[:, k] *= x[:, name] ** int(powers[k, name])
    return columns


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
    accurate = {"solver": "svd"}  # the normal equations would lose twice as many digits
    optimizer = chapter3_library("pysindy").STLSQ(threshold=threshold, alpha=0.0, max_iter=PASSES, ridge_kw=accurate)
    with warnings.catch_warnings():
        warnings.simplefilter("ignore")  # that nothing is left, which the coefficients say themselves
        optimizer.fit(triangle[0] / sizes[0], triangle[1] / sizes[1])
    return np.asarray(optimizer.coef_, float).T


@dataclass(frozen=True, eq=False)
class Sindy:
    """Sums of products of the inputs; a `gaitdisc.model.Model`."""

    inputs: tuple[str, ...]
    outputs: tuple[str, ...]
    powers: NDArray[np.int64]  # (term, input), of each term of the library
    # (term, output) [output's unit over term's unit], zero where a term is not in the model
    coefficients: NDArray[np.float64]
    threshold: float

    def __call__(self, x: NDArray[np.float64]) -> NDArray[np.float64]:
        """Outputs (sample, output) for inputs (sample, input)."""
        return products(x, self.powers) @ self.coefficients

    def terms(self, output: str) -> dict[str, float]:
        """Terms of one output with their coefficients, as a simulation file writes them."""
        column = self.coefficients[:, self.outputs.index(output)]
        return {written(self.inputs, row): float(column[k]) for k, row in enumerate(self.powers) if column[k]}


def fit_sindy(samples: Samples, degree: int = 3, threshold: float | None = None, bags: int = 0, seed: int = 0) -> Sindy:
    """Fit polynomial terms and drop the small ones, again and again (sequentially thresholded least squares).

    With a threshold given, it acts on the coefficients in their units, as in the published code. Without one, columns
    and outputs are divided by their size first, and of `THRESHOLDS` the largest is taken whose error on the last 15 %
    of the samples (contiguous, 0.3 s apart) is within 2 % of the least, or below 1e-4 of the outputs'
    mean square; an output smaller than a twentieth of the largest one is weighed as a twentieth of it.

    Source: Brunton, Proctor, Kutz 2016, PNAS 113:3932; Fasel et al. 2022, Proc. R. Soc. A 478:20210904 for the bags.
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
    triangle = _triangle(samples, powers)  # what all samples cannot distinguish is refused before a part of them is
    sizes = np.ones(len(powers)), np.ones(len(samples.outputs))
    if threshold is None:
        before, inner = samples.last_block(0.15, SEAM_S)
        before.trainable(max(LEAST_BEFORE_INNER, len(powers)))
        sizes = sizes_of(products(samples.x, powers), samples.y)
        threshold = chosen_threshold(_triangle(before, powers), (products(inner.x, powers), inner.y), sizes)
    found = thresholded(triangle, sizes, threshold)
    if bags:
        rng = np.random.default_rng(seed)
        bagged = [samples.rows(rng.integers(len(samples), size=len(samples))) for _ in range(bags)]
        found = np.median([thresholded(_triangle(each, powers), sizes, threshold) for each in bagged], axis=0)
        found[np.abs(found) < threshold] = 0.0
    return Sindy(samples.inputs, samples.outputs, powers, found * sizes[1] / sizes[0][:, None], threshold)


def _triangle(samples: Samples, powers: NDArray[np.int64]) -> Rows:
    """Library and outputs of samples in the axes of the library."""
    return in_axes((products(samples.x, powers), samples.y), powers, samples)


def fit_weak_sindy(samples: Samples, degree: int = 3) -> Sindy:
    """Fit polynomial terms to rates that were never computed: both sides are averaged over windows first.

    The samples' outputs are what the inputs' rates are known to be; the terms are what the rates lack. Multiplied by a
    test function that vanishes at its window's ends and integrated, the rate becomes the input itself against the test
    function's slope (integration by parts), so that noise is averaged where a derivative would multiply it.

    Source: Messenger and Bortz 2021, Multiscale Model. Simul. 19:1474; the threshold is chosen as in `fit_sindy`, by
        the last 15 % of the windows.
    """
    powers = library(len(samples.inputs), degree)
    tests, slopes = _test_functions(samples.time, len(powers))
    columns = tests @ products(samples.x, powers)
    y = -slopes @ samples.x - tests @ samples.y
    triangle, sizes = in_axes((columns, y), powers, samples), sizes_of(columns, y)
    last = len(y) - round(0.15 * len(y))
    before = last - OVERLAP  # windows that share no sample with the inner ones
    first = in_axes((columns[:before], y[:before]), powers, samples)
    threshold = chosen_threshold(first, (columns[last:], y[last:]), sizes)
    found = thresholded(triangle, sizes, threshold)
    return Sindy(samples.inputs, samples.outputs, powers, found * sizes[1] / sizes[0][:, None], threshold)


def _test_functions(time: NDArray[np.float64], terms: int) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
    """Test functions and their slopes, each with the weights of the trapezoidal rule, (window, sample)."""
    dt = float(time[1] - time[0])
    half = max(round(WINDOW_S / dt / 2), 4)
    step = max(2 * half // OVERLAP, 1)
    centres = np.arange(half, len(time) - half, step)
    least = 2 * (terms + OVERLAP)
    if len(centres) < least:
        raise TrainingError(
            f"the weak form of {terms} terms needs {least} windows of {WINDOW_S:g} s",
            f"the record of {len(time)} samples holds {len(centres)}",
            "Record longer, shorten the windows, or lower the degree.",
        )
    s = np.arange(-half, half + 1) / half
    shape, slope = (1 - s**2) ** 4, -8 * s * (1 - s**2) ** 3 / (half * dt)
    tests, slopes = np.zeros((2, len(centres), len(time)))
    for row, centre in enumerate(centres):
        tests[row, centre - half : centre + half + 1] = dt * shape
        slopes[row, centre - half : centre + half + 1] = dt * slope
    return tests, slopes
