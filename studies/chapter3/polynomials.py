"""Products of powers of the inputs: the library that sparse regression chooses terms from."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray


def written(inputs: tuple[str, ...], powers: NDArray[np.int64]) -> str:
    """Return a term of the library as a simulation file writes it."""
    parts = [name if power == 1 else f"{name}**{power}" for name, power in zip(inputs, powers, strict=True) if power]
    return "*".join(parts) or "1"


def library(inputs: int, degree: int) -> NDArray[np.int64]:
    """Powers of every product of the inputs up to a degree, (term, input), the constant first."""
    from itertools import combinations_with_replacement

    rows = [
        np.bincount(np.array(chosen, int), minlength=inputs)
        for total in range(degree + 1)
        for chosen in combinations_with_replacement(range(inputs), total)
    ]
    return np.array(rows, np.int64)


def products(x: NDArray[np.float64], powers: NDArray[np.int64]) -> NDArray[np.float64]:
    """Columns of the library, (sample, term)."""
    columns = np.ones((len(x), len(powers)))
    for k, row in enumerate(powers):
        for name, power in enumerate(row):
            if power:
                columns[:, k] *= x[:, name] ** int(power)
    return columns
