"""State at the end of a noisy record, estimated under the model that is to forecast from there."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from gaitdisc.recording.arrays import read_only

WINDOWS = (10, 20, 40, 80, 160, 320)  # samples, of which the longest that the shorter ones agree with is taken
AGREEMENT = 2.5  # standard errors to either side; with the windows chosen on seeds 101 to 104, that no table holds
MOST_STEPS = 5  # of Levenberg and Marquardt
LEAST_GAIN = 1e-6  # of a step, as a share of the sum of squares
NOISE_FLOOR = 1e-9  # of a channel's standard deviation: rounding
Run = Callable[[NDArray[np.float64], NDArray[np.float64]], tuple[NDArray[np.float64], NDArray[np.float64]]]


@dataclass(frozen=True, eq=False)
class EstimatedStart:
    """A state with its uncertainty."""

    state: NDArray[np.float64]  # (state,), at the last sample of the record
    sd: NDArray[np.float64]  # (state,), standard error from the noise alone; NaN where no window could be fitted
    samples: int  # of the window; 0 where no window could be fitted and the state is the first guess

    def __post_init__(self) -> None:
        """Freeze the numbers."""
        object.__setattr__(self, "state", read_only(self.state))
        object.__setattr__(self, "sd", read_only(self.sd))


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
        with np.errstate(all="ignore"):
            state, sd = _fitted_end(run, time[first:], (measured[first:], noise), guess[first])
        low, high = np.maximum(low, state - AGREEMENT * sd), np.minimum(high, state + AGREEMENT * sd)
        if not np.all(low <= high):  # not so either where the run diverged
            break
        best = EstimatedStart(state, sd, samples)
    return best


def _fitted_end(
    run: Run,
    time: NDArray[np.float64],
    seen: tuple[NDArray[np.float64], NDArray[np.float64]],
    guess: NDArray[np.float64],
) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
    """Last state of the run that fits a window best, and its standard error; NaN where the run diverged."""
    lost = np.full(len(guess), np.nan), np.full(len(guess), np.nan)
    measured, noise = seen

    def missed(first: NDArray[np.float64]) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
        states, channels = run(first, time)
        return states[-1], ((channels - measured) / noise).ravel()

    first, damping = np.array(guess, float), 1e-3
    end, error = missed(first)
    normal = end_slopes = np.eye(len(first))
    for _ in range(MOST_STEPS):
        if not np.isfinite(error).all():
            return lost
        slopes, end_slopes = _slopes(missed, first, end, error)
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


def _slopes(
    missed: Callable[[NDArray[np.float64]], tuple[NDArray[np.float64], NDArray[np.float64]]],
    first: NDArray[np.float64],
    end: NDArray[np.float64],
    error: NDArray[np.float64],
) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
    """Derivatives of the errors and of the last state with respect to the first, by differences."""
    slopes, end_slopes = np.empty((len(error), len(first))), np.empty((len(end), len(first)))
    for k in range(len(first)):
        step = 1e-5 * max(1.0, abs(first[k]))
        end_there, error_there = missed(first + step * np.eye(len(first))[k])
        slopes[:, k], end_slopes[:, k] = (error_there - error) / step, (end_there - end) / step
    return slopes, end_slopes
