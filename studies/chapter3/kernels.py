"""Stationary kernels of scaled inputs, one where they meet."""

from __future__ import annotations

from typing import Literal

import numpy as np
from numpy.typing import NDArray

KernelKind = Literal["squared_exponential", "matern_3_2", "matern_5_2"]
KERNELS: tuple[KernelKind, ...] = ("squared_exponential", "matern_3_2", "matern_5_2")


def kernel(
    kind: KernelKind, a: NDArray[np.float64], b: NDArray[np.float64], lengths: NDArray[np.float64]
) -> NDArray[np.float64]:
    """Covariance of a process of size one between points (a's point, b's point).

    Source: Rasmussen and Williams 2006, Gaussian Processes for Machine Learning, Eqs. 4.9 and 4.17.
    """
    a, b = a / lengths, b / lengths
    apart = np.maximum(np.sum(a**2, axis=1)[:, None] + np.sum(b**2, axis=1) - 2 * a @ b.T, 0.0)
    if kind == "squared_exponential":
        return np.exp(-0.5 * apart)
    if kind == "matern_3_2":
        far = np.sqrt(3 * apart)
        return (1 + far) * np.exp(-far)
    far = np.sqrt(5 * apart)
    return (1 + far + far**2 / 3) * np.exp(-far)
