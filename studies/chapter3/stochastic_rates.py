"""A system that is pushed at random: process noise, which no term explains."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from .system import Rates


@dataclass(frozen=True)
class StochasticRates:
    """Rates with a random push of every state between any two samples; a `system.Rates`."""

    rates: Rates
    # of each state: standard deviation of the pushes of a second [unit of the state/sqrt(s)]
    strength: tuple[float, ...]
    seed: int = 0

    def __call__(self, x: NDArray[np.float64]) -> NDArray[np.float64]:
        """Rates (point, state) at states (point, state), without the pushes."""
        return self.rates(x)

    def run(self, starts: NDArray[np.float64], dt_s: float, steps: int) -> NDArray[np.float64]:
        """States (start, steps + 1, state), all starts under the same pushes."""
        sizes = np.asarray(self.strength) * np.sqrt(dt_s)
        pushes = sizes * np.random.default_rng(self.seed).standard_normal((steps, len(sizes)))
        found = np.empty((len(starts), steps + 1, len(sizes)))
        found[:, 0] = starts
        for step, push in enumerate(pushes):
            found[:, step + 1] = self.rates.run(found[:, step], dt_s, 1)[:, 1] + push
        return found
