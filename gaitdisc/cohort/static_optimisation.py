"""Which muscles share a moment: static optimisation around a habit, for all phases of a stride at once.

At every phase the activations a minimise  dear |a - habit|^2 + |missing moment|^2 / softness  within their bounds,
where the missing moment is what the muscles leave of the wanted one. The problem is convex with three multipliers m,
one a joint: a = clip(habit + capacity m / dear), missing = softness m. Newton's method on the multipliers, all phases
together, ends after a few steps, because the equations are linear between changes of the set of muscles that stand at
a bound.
"""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

SOFTNESS = 1e-4  # of the squared strength of a typical joint: what is missing stays below a percent where it can
STEPS, HALVINGS = 60, 20
NEARLY = 1e-7  # of the largest moment


def shared(
    wanted: NDArray[np.float64],
    capacity: NDArray[np.float64],
    habit: NDArray[np.float64],
    least: NDArray[np.float64],
    dear: NDArray[np.float64],
) -> NDArray[np.float64]:
    """Activations (phase, muscle) nearest to `habit` that give moments (phase, joint); `dear` is each muscle's cost."""
    soft = SOFTNESS * float(np.mean(np.sum(capacity**2, axis=1)))
    small = NEARLY * (1.0 + np.abs(wanted).max())
    multiplier, found = np.zeros_like(wanted), np.clip(habit, least, 1.0)
    unsolved = np.arange(len(wanted))  # phases whose equations do not hold yet
    for _ in range(STEPS):
        task = wanted[unsolved], capacity[unsolved], habit[unsolved], least[unsolved], dear, soft
        found[unsolved], missing = _at(multiplier[unsolved], *task)
        keep = np.abs(missing).max(axis=1) > small
        unsolved, missing, task = unsolved[keep], missing[keep], (*(part[keep] for part in task[:4]), dear, soft)
        if not len(unsolved):
            break
        free = (found[unsolved] > task[3]) & (found[unsolved] < 1.0)
        slope = np.matmul((task[1] * (free / dear)[:, :, None]).transpose(0, 2, 1), task[1]) + soft * np.eye(3)
        multiplier[unsolved] += _step(
            np.linalg.solve(slope, missing[:, :, None])[:, :, 0], multiplier[unsolved], missing, task
        )
    return found


def _step(step, multiplier, missing, task):
    """Newton's step, halved at every phase until the equations hold better."""
    size = np.sum(missing**2, axis=1)
    for _ in range(HALVINGS):
        worse = np.sum(_at(multiplier + step, *task)[1] ** 2, axis=1) > size
        if not worse.any():
            break
        step[worse] *= 0.5
    return step


def _at(multiplier, wanted, capacity, habit, least, dear, soft):
    """Activations of the multipliers, and what is left of the equations."""
    found = np.clip(habit + np.matmul(capacity, multiplier[:, :, None])[:, :, 0] / dear, least, 1.0)
    return found, wanted - np.matmul(found[:, None], capacity)[:, 0] - soft * multiplier
