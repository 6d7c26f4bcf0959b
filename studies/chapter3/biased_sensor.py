"""Kalman filters that have a sensor's bias among their states: their forecast, and the gain that they find."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from functools import partial
from itertools import product

import numpy as np
from numpy.typing import NDArray
from scipy.optimize import least_squares

from .cell import NOISES
from .record import Conditions, Record, System, recorded
from .starts import PROCESS_NOISE, Step, Uncertainty, unscented_kalman

ORACLE = "true start and noise (oracle)"
FILTERS = ("unscented, gain", f"unscented, gain, {ORACLE}", f"linear, offset, {ORACLE}")
OFF = "gain found, off in its SD"
FITTED = 500  # samples, to which an unknown start is fitted before the filter begins


def filter_numbers(systems: Mapping[str, System], wanted: bool) -> Iterator[tuple]:
    """Every filter's numbers, each with its row, its gain and noise, and how it is computed from a seed."""
    for system, noise, name in product(systems.values() if wanted else (), NOISES[1:], FILTERS):
        for row, gain in (("less error", False), (OFF, True))[: 1 + name.startswith("unscented")]:
            column = f"gain {system.observation[0, 0]:g}"
            yield f"{name}: {row}", column, noise, partial(of_filter, system, noise, name, gain)


def of_filter(system: System, noise: float, name: str, gain: bool, seed: int) -> float:
    """How much less error a filter's forecast has [%], or how far off its gain is in its own standard deviation."""
    record = recorded(system, Conditions(noise, seed, duration_s=20.0))
    end, sd = filtered(record, name)
    return float((1 + end[2] - system.observation[0, 0]) / sd) if gain else forecast_gain(record, name, end)


def model_of(record: Record, name: str) -> tuple[Step, Step]:
    """A step of position, speed and bias, and what is measured of them: with a gain, or linear with an offset."""

    def turn(points: NDArray[np.float64]) -> NDArray[np.float64]:
        return np.column_stack([record.system.known.run(points[:, :2], record.conditions.dt_s, 1)[:, 1], points[:, 2]])

    if name.startswith("unscented"):
        return turn, lambda points: (1 + points[:, 2]) * points[:, 0]
    slopes = np.column_stack([(turn(np.eye(3)[[k]] * 1e-4) - turn(np.zeros((1, 3))))[0] / 1e-4 for k in range(3)])
    return lambda points: points @ slopes.T, lambda points: points[:, 0] + points[:, 2]


def filtered(record: Record, name: str) -> tuple[NDArray[np.float64], float]:
    """Position, speed and bias at the end of the training part, and the standard deviation of the bias.

    Where neither start nor noise is known, both are fitted with the bias to the first five seconds, and the filter
    begins there with the covariance of the fit; noise is what smoothing takes away, the likeliest of five the process
    noise.
    """
    turn, seen = model_of(record, name)
    y, smooth = record.measured[: record.split, 0], np.asarray(record.filtered)[:, 0]
    if name.endswith(ORACLE):
        sd = max(float(np.std(record.measured[:, 0] - record.truth @ record.system.observation[0])), 1e-6)
        step = np.full(3, 1e-6) if name.startswith("unscented") else np.array([1e-5, 1e-4, 2e-4])  # it follows a gain
        begun, noise = np.array([*record.system.start, 0.0]), Uncertainty(np.array([1e-6, 1e-6, 0.2]), step, sd)
        found = unscented_kalman(turn, seen, y, begun, noise)
        return found.states[-1], float(found.sd[-1, 2])

    def ran(first: NDArray[np.float64]) -> NDArray[np.float64]:
        states = record.system.known.run(first[None, :2], record.conditions.dt_s, FITTED)[0]
        return np.column_stack([states, np.full(len(states), first[2])])

    sd, size = max(float((y - smooth).std()), 1e-6), float(np.abs(smooth).max())
    first = np.array([smooth[0], np.gradient(smooth, record.conditions.dt_s)[:20].mean(), 0.0])
    fit = least_squares(lambda x: (seen(ran(x)) - y[: FITTED + 1]) / sd, first, x_scale=[size, size, 0.1])
    slopes = np.column_stack([(ran(fit.x + 1e-6 * axis)[-1] - ran(fit.x)[-1]) / 1e-6 for axis in np.eye(3)])
    covariance = slopes @ np.linalg.inv(fit.jac.T @ fit.jac) @ slopes.T
    step = y.std() * np.sqrt(record.conditions.dt_s) * np.array([1.0, 1.0, 0.0])
    tried = [
        unscented_kalman(turn, seen, y[FITTED:], ran(fit.x)[-1], Uncertainty(covariance, share * step, sd))
        for share in PROCESS_NOISE
    ]
    found = max(tried, key=lambda each: each.likelihood)
    return found.states[-1], float(found.sd[-1, 2])


def forecast_gain(record: Record, name: str, end: NDArray[np.float64]) -> float:
    """How much less error the forecast of what is measured has than the known model's from the true state [%]."""
    turn, seen = model_of(record, name)
    truth, points = record.target(forecast=True)[:, 0], [end]
    while len(points) < len(truth):
        points.append(turn(points[-1][None])[0])
    known = record.system.known.run(record.start(forecast=True)[None], record.conditions.dt_s, len(truth) - 1)[0, :, 0]
    left, before = (float(np.sqrt(np.mean((each - truth) ** 2))) for each in (seen(np.array(points)), known))
    return 100 * (1 - left / before)
