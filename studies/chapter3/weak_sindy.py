"""Sparse identification of nonlinear dynamics in weak form: terms found without a derivative of noisy data."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from gaitdisc.errors import TrainingError
from gaitdisc.recording import Samples

from .polynomials import library, products
from .sindy import Sindy
from .thresholding import chosen_threshold, in_axes, sizes_of, thresholded

WINDOW_S, OVERLAP = 0.5, 8  # of test functions; how many begin within the length of one


def fit_weak_sindy(samples: Samples, degree: int = 3, window_s: float = WINDOW_S) -> Sindy:
    """Fit polynomial terms to rates that were never computed: both sides are averaged over windows first.

    The samples' outputs are what the inputs' rates are known to be; the terms are what the rates lack. Multiplied by a
    test function that vanishes at its window's ends and integrated, the rate becomes the input itself against the test
    function's slope (integration by parts), so that noise is averaged where a derivative would multiply it.

    Source: Messenger and Bortz 2021, Multiscale Model. Simul. 19:1474; the threshold is chosen as in `fit_sindy`, by
        the last 15 % of the windows.
    """
    powers = library(len(samples.inputs), degree)
    tests, slopes = _test_functions(samples.time, window_s, len(powers))
    columns = tests @ products(samples.x, powers)
    y = -slopes @ samples.x - tests @ samples.y
    in_axes((columns, y), powers, samples)
    last = len(y) - round(0.15 * len(y))
    before = last - OVERLAP  # windows that share no sample with the inner ones
    sizes = sizes_of(columns, y)
    threshold = chosen_threshold(
        in_axes((columns[:before], y[:before]), powers, samples), (columns[last:], y[last:]), sizes
    )
    found = thresholded(in_axes((columns, y), powers, samples), sizes, threshold)
    return Sindy(samples.inputs, samples.outputs, powers, found * sizes[1] / sizes[0][:, None], threshold)


def _test_functions(
    time: NDArray[np.float64], window_s: float, terms: int
) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
    """Test functions and their slopes, each with the weights of the trapezoidal rule, (window, sample)."""
    dt = float(time[1] - time[0])
    half = max(round(window_s / dt / 2), 4)
    step = max(2 * half // OVERLAP, 1)
    centres = np.arange(half, len(time) - half, step)
    least = 2 * (terms + OVERLAP)
    if len(centres) < least:
        raise TrainingError(
            f"the weak form of {terms} terms needs {least} windows of {window_s:g} s",
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
