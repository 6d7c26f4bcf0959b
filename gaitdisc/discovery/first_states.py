"""First guess of the states of a record, from which the fit of the start states begins."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from gaitdisc.discovery.segments import Segments
from gaitdisc.signals.local_polynomial import savgol_filter
from gaitdisc.simulation.simulation import Simulation

SHARE_OF_PERIOD = 0.2


@dataclass(frozen=True)
class StateGuess:
    """States of every trial, roughly.

    Parameters
    ----------
    states : ndarray (trial, sample, state)
        NaN beyond a trial's end.
    """

    states: NDArray[np.float64]

    def starts(self, segments: Segments) -> NDArray[np.float64]:
        """Return the guess at each segment's first sample (segment, state).

        Parameters
        ----------
        segments : Segments
            The runs.
        """
        return self.states[segments.trial, segments.begin].copy()

    def with_run(self, segments: Segments, states: NDArray[np.float64]) -> StateGuess:
        """Return the guess with a run put in its place where there is one.

        Parameters
        ----------
        segments : Segments
            The runs.
        states : ndarray (segment, sample, state)
            Their states.
        """
        better = self.states.copy()
        better[segments.trial[:, None], segments.begin[:, None] + np.arange(segments.length)] = states
        return StateGuess(better)


def guess_states(
    simulation: Simulation, observed: NDArray[np.float64], rate: float, period: float, rate_of: dict[str, str]
) -> StateGuess:
    """Guess the states: measured ones smoothed, rates as the slope of what they are the rate of.

    Parameters
    ----------
    simulation : Simulation
        Names and observations.
    observed : ndarray (trial, sample, channel)
        In the order of the simulation's observations.
    rate : float
        Samples a second [Hz].
    period : float
        The motion's main period [s].
    rate_of : dict of str to str
        Position-like state -> its rate.

    Returns
    -------
    StateGuess
        A state that is neither measured nor a rate begins at its `initial`, or at 0.
    """
    names = [state.name for state in simulation.states]
    window = max(int(SHARE_OF_PERIOD * period * rate) // 2 * 2 + 1, 5)
    out = np.full((*observed.shape[:2], len(names)), np.nan)
    channels = {text.strip(): number for number, (_, text) in enumerate(simulation.observations)}
    for trial, record in enumerate(observed):
        length = int(np.isfinite(record).any(axis=1).sum())
        width = min(window, length // 2 * 2 - 1)
        for number, state in enumerate(simulation.states):
            out[trial, :length, number] = state.initial or 0.0
        for number, name in enumerate(names):
            if name in channels:
                seen = _filled(record[:length, channels[name]])
                out[trial, :length, number] = savgol_filter(seen, width, 3)
                if name in rate_of and rate_of[name] not in channels:
                    out[trial, :length, names.index(rate_of[name])] = savgol_filter(seen, width, 3, 1, 1 / rate)
    return StateGuess(out)


def _filled(seen: NDArray[np.float64]) -> NDArray[np.float64]:
    known = np.isfinite(seen)
    return np.interp(np.arange(len(seen)), np.flatnonzero(known), seen[known])
