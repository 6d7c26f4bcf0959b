"""Kalman filters: linear, unscented, and of an ensemble, whose states may hold the bias of a measurement."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from gaitdisc.recording.arrays import read_only

SPREAD = 1e-1  # alpha of the sigma points
MEMBERS, INFLATION = 60, 1.02  # of an ensemble
Step = Callable[[NDArray[np.float64]], NDArray[np.float64]]


@dataclass(frozen=True, eq=False)
class Filtered:
    """States and what they let one see."""

    states: NDArray[np.float64]  # (sample, state), after each measurement
    sd: NDArray[np.float64]  # (sample, state), their standard deviations
    likelihood: float  # logarithm of the density of what was measured, each sample given those before

    def __post_init__(self) -> None:
        """Freeze the numbers."""
        object.__setattr__(self, "states", read_only(self.states))
        object.__setattr__(self, "sd", read_only(self.sd))


@dataclass(frozen=True, eq=False)
class Uncertainty:
    """Noise that a filter assumes."""

    first: NDArray[np.float64]  # (state,), standard deviation of the first state
    step: NDArray[np.float64]  # (state,), that each step adds
    measured: float | NDArray[np.float64]  # float or (channel,), of what is measured


def linear_kalman(
    turn: NDArray[np.float64], seen: NDArray[np.float64], y: NDArray[np.float64], start: NDArray[np.float64],
    noise: Uncertainty,
) -> Filtered:  # fmt: skip
    """Kalman filter.

    Source: Kalman 1960, J. Basic Eng. 82:35.
    """
    x, p = np.array(start, float), np.diag(noise.first**2)
    states, sd = np.empty((len(y), len(x))), np.empty((len(y), len(x)))
    likelihood = 0.0
    for k, value in enumerate(y):
        if k:
            x, p = turn @ x, turn @ p @ turn.T + np.diag(noise.step**2)
        variance = float(seen @ p @ seen + noise.measured**2)
        gain, missed = p @ seen / variance, float(value - seen @ x)
        likelihood += _log_density(np.array([missed]), np.array([[variance]]))
        x = x + gain * missed
        p = p - np.outer(gain, seen @ p)
        states[k], sd[k] = x, np.sqrt(np.diag(p))
    return Filtered(states, sd, likelihood)


def unscented_kalman(
    turn: Step, seen: Step, y: NDArray[np.float64], start: NDArray[np.float64], noise: Uncertainty
) -> Filtered:
    """Unscented Kalman filter.

    Source: Julier and Uhlmann 2004, Proc. IEEE 92:401; scaled sigma points with alpha 0.1, beta 2, kappa 0.
    """
    n = len(start)
    scale = SPREAD**2 * n
    mean = np.full(2 * n + 1, 0.5 / scale)
    mean[0] = 1 - n / scale
    spread = mean.copy()
    spread[0] += 1 - SPREAD**2 + 2
    x, p = np.array(start, float), np.diag(noise.first**2)
    values = np.reshape(np.asarray(y, float), (len(y), -1))
    states, sd, likelihood = np.empty((len(y), n)), np.empty((len(y), n)), 0.0
    for k, value in enumerate(values):
        if k:
            points = turn(_sigma_points(x, p, scale))
            x = mean @ points
            p = (points - x).T * spread @ (points - x) + np.diag(noise.step**2)
        points = _sigma_points(x, p, scale)
        found = np.reshape(seen(points), (len(points), -1))
        guess = mean @ found
        variance = (found - guess).T * spread @ (found - guess) + np.diag(
            np.broadcast_to(noise.measured, value.shape) ** 2
        )
        across = (points - x).T * spread @ (found - guess)
        gain = np.linalg.solve(variance, across.T).T
        likelihood += _log_density(value - guess, variance)
        x = x + gain @ (value - guess)
        p = p - gain @ across.T
        p = 0.5 * (p + p.T)
        states[k], sd[k] = x, np.sqrt(np.diag(p))
    return Filtered(states, sd, likelihood)


def ensemble_kalman(
    turn: Step,
    seen: Step,
    y: NDArray[np.float64],
    start: NDArray[np.float64],
    noise: Uncertainty,
    members: int = MEMBERS,
    seed: int = 0,
) -> Filtered:
    """Ensemble Kalman filter, every member moved towards a measurement with noise of its own.

    Source: Evensen 1994, J. Geophys. Res. 99:10143; Burgers, van Leeuwen, Evensen 1998, Mon. Weather Rev. 126:1719.
        The spread is multiplied by 1.02 at each sample (Anderson and Anderson 1999, Mon. Weather Rev. 127:2741).
    """
    rng = np.random.default_rng(seed)
    crowd = start + noise.first * rng.standard_normal((members, len(start)))
    values = np.reshape(np.asarray(y, float), (len(y), -1))
    states, sd, likelihood = np.empty((len(y), len(start))), np.empty((len(y), len(start))), 0.0
    for k, value in enumerate(values):
        if k:
            crowd = turn(crowd) + noise.step * rng.standard_normal(crowd.shape)
            crowd = crowd.mean(axis=0) + INFLATION * (crowd - crowd.mean(axis=0))
        found = np.reshape(seen(crowd), (members, -1))
        size = np.broadcast_to(noise.measured, value.shape)
        apart, guess = crowd - crowd.mean(axis=0), found.mean(axis=0)
        variance = (found - guess).T @ (found - guess) / (members - 1) + np.diag(size**2)
        gain = np.linalg.solve(variance, (apart.T @ (found - guess) / (members - 1)).T).T
        likelihood += _log_density(value - guess, variance)
        crowd = crowd + (value + size * rng.standard_normal(found.shape) - found) @ gain.T
        states[k], sd[k] = crowd.mean(axis=0), crowd.std(axis=0, ddof=1)
    return Filtered(states, sd, likelihood)


def _log_density(missed: NDArray[np.float64], variance: NDArray[np.float64]) -> float:
    """Logarithm of a normal density of errors (channel,) with covariance (channel, channel)."""
    _, size = np.linalg.slogdet(2 * np.pi * variance)
    return float(-0.5 * (size + missed @ np.linalg.solve(variance, missed)))


def _sigma_points(x: NDArray[np.float64], p: NDArray[np.float64], scale: float) -> NDArray[np.float64]:
    root = np.linalg.cholesky(scale * (p + 1e-15 * np.eye(len(x)))).T
    return np.vstack([x, x + root, x - root])
