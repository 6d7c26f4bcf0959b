"""Kalman filters with the bias of a measurement among the states: the well-founded rival of a residual model."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from gaitdisc.recording.arrays import read_only

SPREAD = 1e-1  # alpha of the sigma points
Step = Callable[[NDArray[np.float64]], NDArray[np.float64]]


@dataclass(frozen=True, eq=False)
class Filtered:
    """States and what they let one see.

    Parameters
    ----------
    states : ndarray (sample, state)
        After each measurement.
    sd : ndarray (sample, state)
        Their standard deviations.
    """

    states: NDArray[np.float64]
    sd: NDArray[np.float64]

    def __post_init__(self) -> None:
        """Freeze the numbers."""
        object.__setattr__(self, "states", read_only(self.states))
        object.__setattr__(self, "sd", read_only(self.sd))


@dataclass(frozen=True, eq=False)
class Uncertainty:
    """Noise that a filter assumes.

    Parameters
    ----------
    first : ndarray (state,)
        Standard deviation of the first state.
    step : ndarray (state,)
        That each step adds.
    """

    first: NDArray[np.float64]
    step: NDArray[np.float64]
    measured: float


def linear_kalman(
    turn: NDArray[np.float64], seen: NDArray[np.float64], y: NDArray[np.float64], start: NDArray[np.float64],
    noise: Uncertainty,
) -> Filtered:  # fmt: skip
    """Kalman filter.

    Parameters
    ----------
    turn : ndarray (state, state)
        One sample on.
    seen : ndarray (state,)
        Of one measured channel.
    y : ndarray (sample,)
        Measured.
    start : ndarray (state,)
        First state.

    References
    ----------
    Kalman 1960, J. Basic Eng. 82:35.

    Examples
    --------
    >>> noise = Uncertainty(np.ones(1), np.zeros(1), 1.0)
    >>> linear_kalman(np.eye(1), np.ones(1), np.ones(99), np.zeros(1), noise).states[-1].round(2)
    array([0.99])
    """
    x, p = np.array(start, float), np.diag(noise.first**2)
    states, sd = np.empty((len(y), len(x))), np.empty((len(y), len(x)))
    for k, value in enumerate(y):
        if k:
            x, p = turn @ x, turn @ p @ turn.T + np.diag(noise.step**2)
        gain = p @ seen / (seen @ p @ seen + noise.measured**2)
        x = x + gain * (value - seen @ x)
        p = p - np.outer(gain, seen @ p)
        states[k], sd[k] = x, np.sqrt(np.diag(p))
    return Filtered(states, sd)


def unscented_kalman(
    turn: Step, seen: Step, y: NDArray[np.float64], start: NDArray[np.float64], noise: Uncertainty
) -> Filtered:
    """Unscented Kalman filter.

    Parameters
    ----------
    y : ndarray (sample,)
        Measured.
    start : ndarray (state,)
        First state.

    References
    ----------
    Julier and Uhlmann 2004, Proc. IEEE 92:401; scaled sigma points with alpha 0.1, beta 2, kappa 0.

    Examples
    --------
    >>> noise = Uncertainty(np.ones(1), np.zeros(1), 1.0)
    >>> unscented_kalman(lambda x: x, lambda x: x[:, 0], np.ones(99), np.zeros(1), noise).states[-1].round(2)
    array([0.99])
    """
    n = len(start)
    scale = SPREAD**2 * n
    mean = np.full(2 * n + 1, 0.5 / scale)
    mean[0] = 1 - n / scale
    spread = mean.copy()
    spread[0] += 1 - SPREAD**2 + 2
    x, p = np.array(start, float), np.diag(noise.first**2)
    states, sd = np.empty((len(y), n)), np.empty((len(y), n))
    for k, value in enumerate(y):
        if k:
            points = turn(_sigma_points(x, p, scale))
            x = mean @ points
            p = (points - x).T * spread @ (points - x) + np.diag(noise.step**2)
        points = _sigma_points(x, p, scale)
        found = seen(points)
        guess = float(mean @ found)
        variance = float(spread @ (found - guess) ** 2) + noise.measured**2
        across = (points - x).T * spread @ (found - guess)
        x = x + across / variance * (value - guess)
        p = p - np.outer(across, across) / variance
        states[k], sd[k] = x, np.sqrt(np.diag(p))
    return Filtered(states, sd)


def _sigma_points(x: NDArray[np.float64], p: NDArray[np.float64], scale: float) -> NDArray[np.float64]:
    root = np.linalg.cholesky(scale * (p + 1e-15 * np.eye(len(x)))).T
    return np.vstack([x, x + root, x - root])
