"""Permutations of a test: how many, at which level, and the signs that they turn."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from gaitdisc.errors import ComparisonError


@dataclass(frozen=True)
class PermutationPlan:
    """How a permutation test is run."""

    alpha: float = 0.05  # chance of a false alarm anywhere in the stride and in any channel
    permutations: int = 2000  # most of them; where there are no more, all are taken
    seed: int = 0


USUAL = PermutationPlan()


def sign_flips(n: int, plan: PermutationPlan) -> tuple[NDArray[np.float64], bool]:
    """Signs of every permutation but that of the units as they are.

    returns signs (permutation, unit): 1 or -1; with all signs turned |t| is the same, so the first unit keeps its own

    >>> signs, exact = sign_flips(6, PermutationPlan())
    >>> signs.shape, exact
    ((31, 6), True)
    """
    exact = 2 ** (n - 1) <= plan.permutations
    if exact:
        turned = (np.arange(1, 2 ** (n - 1))[:, None] >> np.arange(n - 1)) & 1
    else:
        turned = np.random.default_rng(plan.seed).integers(0, 2, (plan.permutations - 1, n - 1))
    _check_count(len(turned) + 1, plan)
    signs = np.ones((len(turned), n))
    signs[:, 1:] -= 2.0 * turned
    return signs, exact


def _check_count(count: int, plan: PermutationPlan) -> None:
    if plan.alpha * count < 1:
        raise ComparisonError(
            f"a permutation test at level {plan.alpha:g} needs {int(np.ceil(1 / plan.alpha))} permutations or more",
            f"there are {count}",
            "Raise the number of permutations, or the level.",
        )
