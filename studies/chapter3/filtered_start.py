"""Where a forecast begins, by data assimilation: a Kalman filter of the last samples under the model that forecasts."""

from __future__ import annotations

from typing import Literal

import numpy as np
from numpy.typing import NDArray

from gaitdisc.errors import ShapeError
from gaitdisc.model import Model

from .error_signal import flow
from .kalman import Filtered, Uncertainty, ensemble_kalman, unscented_kalman
from .record import Record

Filter = Literal["unscented", "ensemble"]
LAST = 600  # samples that are filtered
STEPS = 4  # of Runge-Kutta, between two samples
PROCESS_NOISE = (0.0, 1e-4, 1e-3, 1e-2, 1e-1)  # of a state's standard deviation after a second
FIRST = 3.0  # standard deviations of the noise, by which the first smoothed sample may be off


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
    noise = Uncertainty(FIRST * size, share * y.std(axis=0) * np.sqrt(dt), size)

    def rates(states: NDArray[np.float64]) -> NDArray[np.float64]:
        return record.system.known(states) + learned(states)

    def turn(states: NDArray[np.float64]) -> NDArray[np.float64]:
        return flow(rates, states, dt, STEPS)

    run = unscented_kalman if by == "unscented" else ensemble_kalman
    with np.errstate(all="ignore"):
        return run(turn, lambda states: states, y, smooth[0], noise)
