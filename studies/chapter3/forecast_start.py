"""Where a forecast begins that has nothing but the measurement: the state that a model reaches at its end."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from gaitdisc.model import Model

from .augmented_run import on_states, with_learned_rates
from .error_signal import Approach
from .estimated_start import estimated_start
from .record import Record

MOST_STATES = 12  # of a fit by differences; a field begins at its last smoothed sample


def forecast_start(record: Record, learned: Model | None, approach: Approach) -> NDArray[np.float64]:
    """State at the end of the training part, estimated from the measurement under the model that forecasts, (state,)."""
    system, time = record.system, record.time[: record.split]
    guess, measured = _smoothed_states(record), record.measured[: record.split]
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


def _smoothed_states(record: Record) -> NDArray[np.float64]:
    """Smoothed measurement of the training part; states that are not measured, as the known model runs them."""
    system = record.system
    if len(system.channels) == len(system.states):
        return np.asarray(record.filtered)
    first = system.start if system.assumed is None else system.assumed
    run = system.known.run(first[None], record.conditions.dt_s, record.split - 1)[0]
    return np.column_stack([record.filtered, run[:, len(system.channels) :]])
