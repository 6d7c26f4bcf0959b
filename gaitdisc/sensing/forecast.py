"""What a forecast has to beat: the state as it is now, and the mean stride carried on."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from gaitdisc.errors import StrideError
from gaitdisc.recording import Samples
from gaitdisc.results.reconstruction import FLOORS

PERSISTENCE, PHASE_AVERAGE = FLOORS
BASELINES = {
    PERSISTENCE: "all states as they were when the forecast was made: measured, not reconstructed from the sensors",
    PHASE_AVERAGE: "the mean stride of the fitted part, at the phase that the time since the last contact leads to",
}
POINTS, LEAST_FILLED = 100, 0.5


def persistence(trials: Sequence[Samples], ahead_s: float) -> NDArray[np.float64]:
    """States as they were `ahead_s` before, (window, state); NaN where that time has no window.

    trials: windows of each trial, in order of time; time and y are those of the state that is forecast
    ahead_s: from the last reading to that state [s]

    >>> t = np.arange(5) / 10
    >>> persistence([Samples(t[:, None], t[:, None], ("a",), ("a",), t, t)], 0.2).ravel().tolist()
    [nan, nan, 0.0, 0.1, 0.2]
    """
    forecast = []
    for trial in trials:
        before = trial.time - ahead_s
        row = np.clip(np.searchsorted(trial.time, before - 1e-6), 0, max(len(trial) - 1, 0))
        found = np.abs(trial.time[row] - before) < 1e-6
        forecast.append(np.where(found[:, None], trial.y[row], np.nan))
    return np.concatenate(forecast)


@dataclass(frozen=True, eq=False)
class PhaseAverage:
    """The mean stride of a fitted part, as a forecast."""

    curve: NDArray[np.float64]  # (phase, state) [each state's unit], mean in each percent of the stride
    stride_s: float  # mean duration of a stride [s]

    def forecast(self, trials: Sequence[Samples], ahead_s: float) -> NDArray[np.float64]:
        """States (window, state) `ahead_s` [s] after the last reading, at the expected phase; NaN before a contact.

        Phase is the time since the last known contact by the mean duration of a stride: percent stride is known later.
        """
        found = []
        for trial in trials:
            contacts = contact_times(trial)
            last = np.searchsorted(contacts, trial.time - ahead_s + 1e-9) - 1
            since = trial.time - np.append(contacts, np.nan)[last]  # -1, none yet, takes the NaN
            phase = np.where(last < 0, np.nan, since / self.stride_s % 1.0)
            known = np.isfinite(phase)
            values = np.full((len(trial), self.curve.shape[1]), np.nan)
            values[known] = self.curve[(phase[known] * POINTS).astype(int) % POINTS]
            found.append(values)
        return np.concatenate(found)


def phase_average(trials: Sequence[Samples]) -> PhaseAverage:
    """Mean stride of a fitted part; a percent without a sample lies between its neighbours.

    Strides of 71 samples each, all from a sample on, leave 29 percents empty however many there are.
    """
    durations = np.concatenate([np.diff(contact_times(trial)) for trial in trials])
    phi, y = (np.concatenate([getattr(trial, name) for trial in trials]) for name in ("phi", "y"))
    known = np.isfinite(phi)
    place = (phi[known] * POINTS / 100).astype(int) % POINTS
    counts = np.bincount(place, minlength=POINTS)
    filled = counts > 0
    if not len(durations) or filled.mean() < LEAST_FILLED:
        raise StrideError(
            "the mean stride needs strides in the fitted part",
            f"it has {len(durations)} and {int((counts == 0).sum())} of {POINTS} percents without a sample",
            "Record longer, or reconstruct the present (ahead 0).",
        )
    sums = np.zeros((POINTS, y.shape[1]))
    np.add.at(sums, place, y[known])
    at = np.flatnonzero(filled)
    means = sums[at] / counts[at, None]
    curve = np.column_stack([np.interp(np.arange(POINTS), at, column, period=POINTS) for column in means.T])
    return PhaseAverage(curve, float(np.median(durations)))


def contact_times(trial: Samples) -> NDArray[np.float64]:
    """Contacts by percent stride, in order [s].

    >>> t = np.arange(0.0, 3.0, 0.1)
    >>> s = Samples(t[:, None], t[:, None], ("a",), ("a",), t, 100 * ((t + 0.25) % 1.0))
    >>> contact_times(s).round(6).tolist()
    [-0.25, 0.75, 1.75, 2.75]
    """
    steps, rises = np.diff(trial.time), np.diff(trial.phi)
    within = (rises > 0) & (steps < 1.5 * np.median(steps)) if len(steps) else np.zeros(0, bool)
    duration = 100 * steps[within] / rises[within]
    begun = trial.time[1:][within] - trial.phi[1:][within] / 100 * duration
    both = np.sort(np.concatenate([begun, begun + duration]))
    if not len(both):
        return both
    groups = np.split(both, np.flatnonzero(np.diff(both) > 0.1 * np.median(duration)) + 1)
    last = trial.time[-1]
    return np.array([time for group in groups if (time := float(np.median(group))) <= last])
