"""Noise that a record is measured with: normal, or as sensors often have it."""

from __future__ import annotations

from typing import Literal

import numpy as np
from numpy.typing import NDArray
from scipy.signal import lfilter

NoiseKind = Literal["normal", "student_t", "outliers", "coloured", "multiplicative"]
NOISE_KINDS: tuple[NoiseKind, ...] = ("normal", "student_t", "outliers", "coloured", "multiplicative")
FREEDOM = 3  # degrees of Student's t: its variance is finite, its fourth moment is not
OUTLYING, FARTHER = 0.02, 10.0  # share of the samples, and how many times farther these are thrown
MEMORY_S = 0.1  # after which coloured noise has forgotten all but 1/e


def drawn_noise(
    kind: NoiseKind, clean: NDArray[np.float64], size: NDArray[np.float64], dt_s: float, rng: np.random.Generator
) -> NDArray[np.float64]:
    """Noise of one standard deviation whatever its kind, (sample, channel)."""
    if kind == "student_t":
        return size / np.sqrt(FREEDOM / (FREEDOM - 2)) * rng.standard_t(FREEDOM, clean.shape)
    noise = size * rng.standard_normal(clean.shape)
    if kind == "outliers":
        far = np.where(rng.random(clean.shape) < OUTLYING, FARTHER, 1.0)
        return noise * far / np.sqrt(1 + OUTLYING * (FARTHER**2 - 1))
    if kind == "coloured":
        kept = np.exp(-dt_s / MEMORY_S)
        first = kept * size * rng.standard_normal((1, clean.shape[1]))
        return lfilter([np.sqrt(1 - kept**2)], [1.0, -kept], noise, axis=0, zi=first)[0]
    if kind == "multiplicative":
        return noise * np.abs(clean) / np.sqrt(np.mean(clean**2, axis=0))
    return noise
