"""Errors of a reconstruction, each under its own name: RMSE, relative L2 and R2 are three different things."""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
import pandas as pd
from numpy.typing import NDArray

from gaitdisc.channel import Channel
from gaitdisc.errors import SamplingError
from gaitdisc.recording import Samples
from gaitdisc.recording.arrays import Values, autocorrelation_time
from gaitdisc.statistics.r2 import r2

DRAWS = 1000
LEVEL, INTERVAL_LEVEL = 0.95, 0.9  # of an error over trials; of the interval of a state


@dataclass(frozen=True, eq=False)
class Reconstructed:
    """What was measured and what was reconstructed, window by window, with the stride that each belongs to."""

    windows: Samples
    stride: NDArray[np.int_]  # (window,), number of the stride, -1 outside of strides
    states: Values  # (window, state), reconstructed by a model

    @property
    def strides(self) -> int:
        """Strides with test windows, in part or whole: the number of independent samples is of this order."""
        return len(np.unique(self.stride[self.stride >= 0]))


def stride_numbers(trials: Sequence[Samples]) -> NDArray[np.int_]:
    """Number of the stride of each window, counted through all trials.

    >>> phi = np.array([90.0, 5.0, 50.0, 2.0, np.nan])
    >>> s = Samples(phi[:, None], phi[:, None], ("a",), ("b",), np.arange(5.0), phi)
    >>> stride_numbers([s]).tolist()
    [0, 1, 1, 2, -1]
    """
    numbers, first = [], 0
    for trial in trials:
        if not len(trial):
            continue
        known = np.isfinite(trial.phi)
        number = np.full(len(trial), -1)
        phi, time = trial.phi[known], trial.time[known]
        new = (np.diff(phi) < 0) | (np.diff(time) > 1.0)
        number[known] = first + np.concatenate([[0], np.cumsum(new)])[: len(phi)]
        first = number.max(initial=first - 1) + 1
        numbers.append(number)
    return np.concatenate(numbers)


def state_errors(tested: Reconstructed, channels: Sequence[Channel], seed: int = 0) -> pd.DataFrame:
    """Error of every state: RMSE in its unit, relative L2, and R2.

    returns: state, unit, rmse [unit], low and high (95 % interval of the RMSE, strides drawn with
        replacement; NaN with fewer than three strides), relative_l2 [1] (norm of the error by norm of the measured
        values about zero, Eq. 2.21, which the dissertation calls MSE), r2 [1] about the mean of the test part
    """
    measured, error = tested.windows.y, tested.states - tested.windows.y
    low, high = _interval(error**2, tested.stride, seed)
    with np.errstate(divide="ignore", invalid="ignore"):
        relative = np.linalg.norm(error, axis=0) / np.linalg.norm(measured, axis=0)
    return pd.DataFrame(
        {
            "state": [channel.name for channel in channels],
            "unit": [channel.unit for channel in channels],
            "rmse": np.sqrt(np.mean(error**2, axis=0)),
            "low": low,
            "high": high,
            "relative_l2": relative,
            "r2": r2(measured, tested.states),
        }
    )


def angle_columns(channels: Sequence[Channel]) -> list[int]:
    """Columns that are angles.

    >>> angle_columns([Channel("pelvis_tx", "translation", "m"), Channel("knee_angle_r", "angle", "deg", "r")])
    [1]
    """
    return [k for k, channel in enumerate(channels) if channel.unit == "deg"]


def angles_error(tested: Reconstructed, channels: Sequence[Channel], sensors: Values) -> dict[str, float]:
    """One number for all angles that no sensor (window, sensor) [deg] measures, by each of the three names.

    returns: `rmse_deg` over windows and angles, `relative_l2`, `r2` (median of angles), `relative_l2_whole` with the
        sensors as states without error, as in Table 5.2. NaN without angles
    """
    angles = angle_columns(channels)
    if not angles:
        return dict.fromkeys(("rmse_deg", "relative_l2", "r2", "relative_l2_whole"), float("nan"))
    measured, states = tested.windows.y[:, angles], tested.states[:, angles]
    norm = float(np.linalg.norm(states - measured))
    measured_norm, read = float(np.linalg.norm(measured)), float(np.linalg.norm(sensors))
    return {
        "rmse_deg": float(np.sqrt(np.mean((states - measured) ** 2))),
        "relative_l2": norm / measured_norm,
        "r2": float(np.nanmedian(r2(measured, states))),
        "relative_l2_whole": norm / float(np.hypot(measured_norm, read)),
    }


def phase_curves(tested: Reconstructed, states: Sequence[str], points: int = 51) -> pd.DataFrame:
    """Over the stride: state, percent, measured, measured_sd, reconstructed, rmse of the windows in the bin."""
    inside = tested.stride >= 0
    phi, y, estimates = tested.windows.phi[inside], tested.windows.y[inside], tested.states[inside]
    edges = np.linspace(0, 100, points + 1)
    bins = np.clip(np.digitize(phi, edges) - 1, 0, points - 1)
    rows = []
    for k in np.unique(bins):
        here = bins == k
        for column, state in enumerate(states):
            m, f = y[here, column], estimates[here, column]
            rmse = float(np.sqrt(np.mean((f - m) ** 2)))
            rows.append((state, float(edges[k] + edges[1] / 2), m.mean(), m.std(), f.mean(), rmse))
    return pd.DataFrame(
        rows, columns=pd.Index(["state", "percent", "measured", "measured_sd", "reconstructed", "rmse"])
    )


def _interval(squares: Values, stride: NDArray[np.int_], seed: int) -> tuple[Values, Values]:
    """Bounds of the root mean square when whole strides are drawn with replacement."""
    names, index = np.unique(stride, return_inverse=True)
    sums = np.zeros((len(names), squares.shape[1]))
    np.add.at(sums, index, squares)
    counts = np.bincount(index).astype(float)
    if len(names) < 3:
        return np.full(squares.shape[1], np.nan), np.full(squares.shape[1], np.nan)
    drawn = np.random.default_rng(seed).multinomial(len(names), np.full(len(names), 1 / len(names)), DRAWS)
    means = np.sqrt((drawn @ sums) / (drawn @ counts)[:, None])
    low, high = np.quantile(means, [(1 - LEVEL) / 2, (1 + LEVEL) / 2], axis=0)
    return low, high


def half_widths(errors: Values, level: float = INTERVAL_LEVEL) -> Values:
    """Half width of the interval of every state: the split conformal quantile of the absolute errors.

    With n independent errors, the one of rank (n + 1) `level` covers a further error with a probability of `level`.
    Windows of one walk are not independent: the rank is taken for as many errors as theirs are worth
    (`effective_number`). The gait may drift all the same: the coverage is measured, not promised.

    errors (window, state) [each state's unit]: of a model on windows that it was not fitted to, in order of time
    returns (state,) [each state's unit]
    Source: Vovk, Gammerman and Shafer 2005, Algorithmic learning in a random world; Lei et al. 2018 (split conformal).
        The effective number is our addition: without it the 90 % interval of walks of 60 s covered 86 %.

    >>> half_widths(np.tile([1.0, -2.0, 3.0, -4.0, 5.0, -6.0, 7.0, -8.0, 9.0], 3)[:, None], 0.9)
    array([9.])
    """
    n, sizes = len(errors), np.sort(np.abs(errors), axis=0)
    if int(np.ceil((n + 1) * level - 1e-9)) > n:
        least = int(np.ceil(level / (1 - level) - 1e-9))
        raise SamplingError(
            f"for an interval of {100 * level:g} %, there must be at least {least} validation windows",
            f"the number of windows is {n}",
            "Record longer, or use a lower level.",
        )
    ranks = np.ceil(n * level * (1 + 1 / effective_number(errors)) - 1e-9).astype(int)
    return sizes[np.minimum(ranks, n) - 1, np.arange(sizes.shape[1])]


def effective_number(errors: Values) -> Values:
    """Independent errors that those of every state are worth, (state,): between 1 and their number.

    The number of windows by the integrated autocorrelation of the absolute errors, summed up to its first zero.

    errors (window, state) [each state's unit]: in order of time

    >>> errors = np.random.default_rng(0).normal(size=(400, 1))
    >>> bool(300 < effective_number(np.repeat(errors, 10, axis=0))[0] < 500)
    True
    """
    n = len(errors)
    return np.clip(n / autocorrelation_time(np.abs(errors)), 1.0, n)


def coverage(errors: Values, half: Values) -> Values:
    """Share (state,) of errors (window, state) inside half widths (state,) of `half_widths`, on test windows.

    >>> coverage(np.array([[1.0], [-3.0]]), np.array([2.0]))
    array([0.5])
    """
    return np.mean(np.abs(errors) <= half, axis=0)
