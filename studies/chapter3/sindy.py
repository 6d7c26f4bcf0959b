"""Sparse identification of nonlinear dynamics: a few polynomial terms, each with its coefficient."""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from gaitdisc.errors import TrainingError
from gaitdisc.recording import Samples
from gaitdisc.recording.arrays import read_only

from .polynomials import library, products, written
from .thresholding import Rows, Sizes, chosen_threshold, in_axes, sizes_of, thresholded

SEAM_S = 0.3  # as Trajectory.split: zero-lag filters look ahead over the seam
LEAST_BEFORE_INNER = 20


@dataclass(frozen=True, eq=False)
class Sindy:
    """Sums of products of the inputs; a `gaitdisc.model.Model`."""

    inputs: tuple[str, ...]
    outputs: tuple[str, ...]
    powers: NDArray[np.int64]  # (term, input), of each term of the library
    # (term, output) [output's unit over term's unit], zero where a term is not in the model
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
    if threshold is None:
        return _of_chosen_threshold(samples, powers, bags, seed)
    found = _thresholded(samples, powers, (1.0, 1.0), threshold, (bags, seed))
    return Sindy(samples.inputs, samples.outputs, powers, found, threshold)


def _of_chosen_threshold(samples: Samples, powers: NDArray[np.int64], bags: int, seed: int) -> Sindy:
    _triangle(samples, powers)  # what all samples cannot distinguish is refused before a part of them is
    before, inner = samples.last_block(0.15, SEAM_S)
    before.trainable(max(LEAST_BEFORE_INNER, len(powers)))
    sizes = sizes_of(products(samples.x, powers), samples.y)
    threshold = chosen_threshold(_triangle(before, powers), (products(inner.x, powers), inner.y), sizes)
    found = _thresholded(samples, powers, sizes, threshold, (bags, seed))
    return Sindy(samples.inputs, samples.outputs, powers, found * sizes[1] / sizes[0][:, None], threshold)


def _thresholded(
    samples: Samples, powers: NDArray[np.int64], sizes: Sizes, threshold: float, draws: tuple[int, int]
) -> NDArray[np.float64]:
    """Coefficients (term, output) of terms and outputs divided by their sizes."""
    triangle, (bags, seed) = _triangle(samples, powers), draws
    if not bags:
        return thresholded(triangle, sizes, threshold)
    rng = np.random.default_rng(seed)
    bagged = [samples.rows(rng.integers(len(samples), size=len(samples))) for _ in range(bags)]
    middle = np.median([thresholded(_triangle(each, powers), sizes, threshold) for each in bagged], axis=0)
    return np.where(np.abs(middle) < threshold, 0.0, middle)


def _triangle(samples: Samples, powers: NDArray[np.int64]) -> Rows:
    """Library and outputs of samples in the axes of the library."""
    return in_axes((products(samples.x, powers), samples.y), powers, samples)
