"""Intervals around what a model tells, from its errors on windows that it was not fitted to."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from gaitdisc.errors import SamplingError

LEVEL = 0.9


def half_widths(errors: NDArray[np.float64], level: float = LEVEL) -> NDArray[np.float64]:
    """Half width of the interval of every state: the split conformal quantile of the absolute errors.

    With n independent errors the interval covers a further one with a probability of at least `level`. Windows of one
    walk depend on each other, and the gait may drift: the coverage is therefore measured, not promised.

    Parameters
    ----------
    errors : ndarray (window, state) [each state's unit]
        Of a model on the check part.
    level : float
        Wanted coverage, between 0 and 1.

    Returns
    -------
    ndarray (state,) [each state's unit]

    Raises
    ------
    SamplingError
        If there are too few errors for that level.

    References
    ----------
    Vovk, Gammerman and Shafer 2005, Algorithmic learning in a random world; Lei et al. 2018 (split conformal).

    Examples
    --------
    >>> half_widths(np.arange(-9.0, 10.0)[:, None], 0.9)
    array([9.])
    """
    n = len(errors)
    rank = int(np.ceil((n + 1) * level - 1e-9))
    if rank > n:
        least = int(np.ceil(level / (1 - level) - 1e-9))
        raise SamplingError(
            f"an interval of {100 * level:g} % needs at least {least} checked windows",
            f"there are {n}",
            "Record longer, or take a lower level.",
        )
    return np.sort(np.abs(errors), axis=0)[rank - 1]


def coverage(errors: NDArray[np.float64], half: NDArray[np.float64]) -> NDArray[np.float64]:
    """Share of errors inside the interval, (state,).

    Parameters
    ----------
    errors : ndarray (window, state) [each state's unit]
        On judged windows.
    half : ndarray (state,) [each state's unit]
        From `half_widths`.

    Examples
    --------
    >>> coverage(np.array([[1.0], [-3.0]]), np.array([2.0]))
    array([0.5])
    """
    return np.mean(np.abs(errors) <= half, axis=0)
