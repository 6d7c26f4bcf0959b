"""Where a forecast begins that has nothing but the measurement: by windows, or by a Kalman filter under the model."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from typing import Literal

import numpy as np
from numpy.typing import NDArray

from gaitdisc.errors import ShapeError
from gaitdisc.model import Model

from .augmented_run import on_states, with_learned_rates
from .record import Approach, Record, flow

SPREAD = 1e-1  # alpha of the sigma points
MEMBERS, INFLATION = 60, 1.02  # of an ensemble
Step = Callable[[NDArray[np.float64]], NDArray[np.float64]]
WINDOWS = (10, 20, 40, 80, 160, 320)  # samples, of which the longest that the shorter ones agree with is taken
AGREEMENT = 2.5  # standard errors to either side; with the windows chosen on seeds 101 to 104, that no table holds
MOST_STEPS = 5  # of Levenberg and Marquardt
LEAST_GAIN = 1e-6  # of a step, as a share of the sum of squares
NOISE_FLOOR = 1e-9  # of a channel's standard deviation: rounding
Run = Callable[..., tuple[NDArray[np.float64], NDArray[np.float64]]]
MOST_STATES = 12  # of a fit by differences; a field begins at its last smoothed sample
Filter = Literal["unscented", "ensemble"]
LAST = 600  # samples that are filtered
STEPS = 4  # of Runge-Kutta, between two samples
PROCESS_NOISE = (0.0, 1e-4, 1e-3, 1e-2, 1e-1)  # of a state's standard deviation after a second
FIRST_OFF = 3.0  # standard deviations of the noise, by which the first smoothed sample may be off


@dataclass(frozen=True, eq=False)
class Filtered:
    """States and what they let one see."""

    states: NDArray[np.float64]  # (sample, state), after each measurement
    sd: NDArray[np.float64]  # (sample, state), their standard deviations
    likelihood: float  # logarithm of the density of what was measured, each sample given those before


@dataclass(frozen=True, eq=False)
class Uncertainty:
    """Noise that a filter assumes."""

    first: NDArray[np.float64]  # (state,), standard deviation of the first state, or its covariance (state, state)
    step: NDArray[np.float64]  # (state,), that each step adds
    measured: float | NDArray[np.float64]  # float or (channel,), of what is measured


def unscented_kalman(
    turn: Step, seen: Step, y: NDArray[np.float64], start: NDArray[np.float64], noise: Uncertainty
) -> Filtered:
    """Unscented Kalman filter.

    Source: Julier and Uhlmann 2004, Proc. IEEE 92:401; scaled sigma points with alpha 0.1, beta 2, kappa 0.
    """
    n = len(start)
    scale = SPREAD**2 * n
    mean = np.r_[1 - n / scale, np.full(2 * n, 0.5 / scale)]
    spread = np.r_[mean[0] + 1 - SPREAD**2 + 2, mean[1:]]
    x, p = np.array(start, float), noise.first if noise.first.ndim == 2 else np.diag(noise.first**2)
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
        size = np.broadcast_to(noise.measured, value.shape)
        variance = (found - guess).T * spread @ (found - guess) + np.diag(size**2)
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
) -> Filtered:
    """Ensemble Kalman filter, every member moved towards a measurement with noise of its own.

    Source: Evensen 1994, J. Geophys. Res. 99:10143; Burgers, van Leeuwen, Evensen 1998, Mon. Weather Rev. 126:1719.
        The spread is multiplied by 1.02 at each sample (Anderson and Anderson 1999, Mon. Weather Rev. 127:2741).
    """
    rng = np.random.default_rng(0)
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


@dataclass(frozen=True, eq=False)
class EstimatedStart:
    """A state with its uncertainty."""

    state: NDArray[np.float64]  # (state,), at the last sample of the record
    sd: NDArray[np.float64]  # (state,), standard error from the noise alone; NaN where no window could be fitted
    samples: int  # of the window; 0 where no window could be fitted and the state is the first guess


def estimated_start(
    run: Run, time: NDArray[np.float64], measured: NDArray[np.float64], guess: NDArray[np.float64]
) -> EstimatedStart:
    """Fit the model's run to the last samples of a record, and take where it ends.

    The run begins some samples before the end, where a zero-phase filter is not yet disturbed by the end of the record;
    its first state is fitted to the measurement by least squares. A longer window averages more noise and gathers more
    of the model's own error: of the windows that double in length the longest is taken whose end agrees, within 2.5
    standard errors in every state, with the ends of all shorter ones.

    Source: Goldenshluger and Nemirovski 1997, Math. Methods Stat. 6:135 (windows whose intervals intersect).
    """
    noise = np.maximum((measured - guess[:, : measured.shape[1]]).std(axis=0), NOISE_FLOOR * measured.std(axis=0))
    best = EstimatedStart(guess[-1], np.full(guess.shape[1], np.nan), 0)
    low, high = np.full(guess.shape[1], -np.inf), np.full(guess.shape[1], np.inf)
    if measured.shape[1] == guess.shape[1]:
        low, high = measured[-1] - AGREEMENT * noise, measured[-1] + AGREEMENT * noise
    for samples in WINDOWS:
        first = len(time) - 1 - samples
        if first < 0:
            break

        def missed(state: NDArray[np.float64], first: int = first) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
            states, channels = run(state, time[first:])
            return states[-1], ((channels - measured[first:]) / noise).ravel()

        with np.errstate(all="ignore"):
            state, sd = _fitted_end(missed, guess[first])
        low, high = np.maximum(low, state - AGREEMENT * sd), np.minimum(high, state + AGREEMENT * sd)
        if not np.all(low <= high):  # not so either where the run diverged
            break
        best = EstimatedStart(state, sd, samples)
    return best


def _fitted_end(missed: Run, guess: NDArray[np.float64]) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
    """Last state of the run that fits a window best, and its standard error; NaN where the run diverged.

    missed: last state of the run from a first state, and its errors over the noise
    """
    lost = np.full(len(guess), np.nan), np.full(len(guess), np.nan)
    first, damping = np.array(guess, float), 1e-3
    end, error = missed(first)
    normal = end_slopes = np.eye(len(first))
    for _ in range(MOST_STEPS):
        if not np.isfinite(error).all():
            return lost
        steps = [1e-5 * max(1.0, abs(value)) for value in first]
        moved = [missed(first + step * axis) for step, axis in zip(steps, np.eye(len(first)), strict=True)]
        slopes, end_slopes = (
            np.column_stack([(there[part] - here) / step for there, step in zip(moved, steps, strict=True)])
            for part, here in ((1, error), (0, end))
        )
        if not np.isfinite(slopes).all():
            return lost
        normal, gradient, cost = slopes.T @ slopes, slopes.T @ error, float(error @ error)
        while damping < 1e6:
            step = np.linalg.lstsq(normal + damping * np.diag(np.diag(normal)), gradient, rcond=None)[0]
            tried = np.asarray(first - step, float)
            end_there, error_there = missed(tried)
            if float(error_there @ error_there) <= cost:  # never of NaN
                break
            damping *= 10
        else:
            break
        first, end, error, damping = tried, end_there, error_there, damping / 10
        if cost - float(error @ error) <= LEAST_GAIN * cost:
            break
    covariance = end_slopes @ np.linalg.pinv(normal) @ end_slopes.T
    return end, np.sqrt(np.diag(covariance))


def forecast_start(record: Record, learned: Model | None, approach: Approach) -> NDArray[np.float64]:
    """State at the end of the training part, estimated under the model that forecasts, (state,)."""
    system, time = record.system, record.time[: record.split]
    guess, measured = np.asarray(record.filtered), record.measured[: record.split]
    if len(system.channels) < len(system.states):  # the others are guessed by a run from the true start, an oracle
        first = system.start if system.assumed is None else system.assumed
        states = system.known.run(first[None], record.conditions.dt_s, record.split - 1)[0]
        guess = np.column_stack([guess, states[:, len(system.channels) :]])
    if record.conditions.published or len(system.states) > MOST_STATES:
        return guess[-1]
    dt_s, channels = record.conditions.dt_s, len(system.channels)

    def run(start: NDArray[np.float64], at: NDArray[np.float64]) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
        if learned is not None and approach == "dynamics":
            states = with_learned_rates(system.known, learned, start, at).values
            return states, states[:, :channels]
        states = system.known.run(start[None], dt_s, len(at) - 1)[0]
        seen = states[:, :channels] if learned is None else on_states(system, learned, start, at).values
        return states, seen

    return estimated_start(run, time, measured, guess).state


def filtered_start(record: Record, learned: Model, by: Filter) -> NDArray[np.float64]:
    """State at the end of the training part, by a Kalman filter under the known rates and what was learned, (state,).

    The noise is what smoothing took from the record. Of five sizes of process noise, which stands for what the learned
    model lacks, the one is taken under which the unscented filter finds the measurements likeliest.

    Source: Julier and Uhlmann 2004, Proc. IEEE 92:401; Evensen 1994, J. Geophys. Res. 99:10143; Mehra 1970, IEEE
        Trans. Autom. Control 15:175 (process noise from the innovations).
    """
    if len(record.system.channels) < len(record.system.states):
        raise ShapeError(
            f"a filter of learned rates needs all {len(record.system.states)} states measured",
            f"{len(record.system.channels)} are: {', '.join(record.system.channels)}",
            "Start from the windows: forecast_start.",
        )
    chosen = max(PROCESS_NOISE, key=lambda share: _filtered(record, learned, "unscented", share).likelihood)
    return np.asarray(_filtered(record, learned, by, chosen).states[-1])


def _filtered(record: Record, learned: Model, by: Filter, share: float) -> Filtered:
    """States of the last samples under process noise of a share of each state's size."""
    first = max(record.split - LAST, 0)
    y, smooth = record.measured[first : record.split], np.asarray(record.filtered)[first:]
    size = np.maximum((y - smooth).std(axis=0), 1e-9 * y.std(axis=0))
    dt = record.conditions.dt_s
    noise = Uncertainty(FIRST_OFF * size, share * y.std(axis=0) * np.sqrt(dt), size)

    def rates(states: NDArray[np.float64]) -> NDArray[np.float64]:
        return record.system.known(states) + learned(states)

    def turn(states: NDArray[np.float64]) -> NDArray[np.float64]:
        return flow(rates, states, dt, STEPS)

    run = unscented_kalman if by == "unscented" else ensemble_kalman
    with np.errstate(all="ignore"):
        return run(turn, lambda states: states, y, smooth[0], noise)
