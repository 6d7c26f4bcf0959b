"""Random effects: what disturbances of unknown numbers add to a residual, by restricted likelihood.

Start states are projected out and constants are estimated; the disturbances are integrated out.
Source: Patterson and Thompson 1971, Biometrika 58, 545 (restricted likelihood); Harville 1977, J. Am. Stat. Assoc. 72,
320 (mixed models).
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from gaitdisc.discovery.fitted import Fitted, start_basis, without

Array = NDArray[np.float64]


@dataclass(frozen=True)
class RandomEffects:
    """A residual and the slopes of constants, along the principal axes of independent random effects."""

    products: Array  # (1 + free, 1 + free), of the residual and the slopes, those of the prior among them
    along: Array  # (segment, effect, 1 + free), their products with each principal effect
    strength: Array  # (segment, effect), sum of squares that a principal effect of unit size adds

    def likelihood(self, variance: float, numbers: int, least: float = 0.0) -> tuple[float, float]:
        """Return minus twice the log likelihood, up to a constant, and the residual's variance that is likeliest.

        variance: of each effect, over the residual's
        numbers: independent ones in the residual
        least: that the residual's variance is known to have
        """
        weights = variance / (1 + variance * self.strength)
        normal = self.products - np.einsum("seb,se,sec->bc", self.along, weights, self.along)
        constants = np.linalg.lstsq(normal[1:, 1:], normal[1:, 0], rcond=1e-12)[0]
        squares = float(normal[0, 0] - normal[0, 1:] @ constants)
        level = max(squares / numbers, least)
        volume = float(np.log1p(variance * self.strength).sum())
        return volume + numbers * float(np.log(level)) + squares / level, level


def random_effects(fit: Fitted, effects: Array) -> RandomEffects:
    """Return the residual of a fit beside random effects.

    effects (segment, number, effect): what each changes of `white`
    """
    left, slopes = fit.projected
    flat = np.column_stack(fit.stacked)
    effects = without(start_basis(fit.slopes[..., : fit.starts.shape[1]]), effects)
    strength, axes = np.linalg.eigh(np.swapaxes(effects, 1, 2) @ effects)
    along = np.swapaxes(effects @ axes, 1, 2) @ np.concatenate([left[..., None], slopes], axis=2)
    return RandomEffects(flat.T @ flat, along, np.maximum(strength, 0.0))
