"""First and second derivatives of filtered signals, and the trajectory made of them (Eqs. 4.1-4.4).

The operator is the smallest part of the error, the cut-off decides what is lost (docs/derivatives.md). So the operator
is the narrowest that is accurate to fourth order, five points wide, and the cut-off is a setting of the filter.
"""

from dataclasses import replace

import numpy as np
from numpy.typing import NDArray

from gaitdisc.errors import SamplingError
from gaitdisc.recording import Recording, Strides, Trajectory
from gaitdisc.recording.arrays import Values
from gaitdisc.recording.wrapping import unwrap
from gaitdisc.units import rate_unit

FIRST = (1 / 12, -8 / 12, 0.0, 8 / 12, -1 / 12)  # times 1 / step
SECOND = (-1 / 12, 16 / 12, -30 / 12, 16 / 12, -1 / 12)  # times 1 / step^2
REACH = len(FIRST) // 2


def derivative(values: Values, rate_hz: float, order: int = 1) -> Values:
    """First or second time derivative by five-point central differences.

    values (time, channel) [unit]: filtered; the difference quotient passes on what noise is left
    returns (time, channel) [unit/s or unit/s2]: NaN at the first and last two samples and within two samples of a
        missing one: no one-sided guess
    Source: Fornberg (1988), Math. Comp. 51, 699-706: weights of fourth order on five points. Errors: (w/rate)^4 / 30
        and (w/rate)^4 / 90 of a sine of angular frequency w.

    >>> t = np.arange(7) / 10
    >>> derivative(t[:, None] ** 2, 10.0, order=2).round(6).ravel()
    array([nan, nan,  2.,  2.,  2., nan, nan])
    """
    if order not in (1, 2):
        raise SamplingError("the order of a derivative must be 1 or 2", f"order is {order}", "Use order=1 or order=2.")
    if len(values) < len(FIRST):
        raise SamplingError(
            f"a derivative must have at least {len(FIRST)} samples", f"found {len(values)}", "Use a longer period."
        )
    weights = FIRST if order == 1 else SECOND
    count = len(values) - 2 * REACH
    values = np.where(np.isfinite(values), values, np.nan)
    inner = np.sum([w * values[k : k + count] for k, w in enumerate(weights) if w], axis=0)
    derivative = np.full(np.shape(values), np.nan)
    derivative[REACH:-REACH] = inner * rate_hz**order
    return np.where(np.isfinite(values), derivative, np.nan)


def differentiate_recording(recording: Recording, order: int = 1) -> Recording:
    """Recording of the time derivative of every channel, per second; suspect where one of the five samples is."""
    channels = tuple(replace(c, unit=rate_unit(c.unit, order)) for c in recording.channels)
    values = derivative(unwrap(recording).values, recording.rate_hz, order)
    return replace(recording, values=values, channels=channels, suspect=_widen(np.asarray(recording.suspect)))


def trajectory(filtered: Recording, strides: Strides) -> Trajectory:
    """State, velocity, acceleration and percent stride of a filtered recording.

    returns: `usable` where x, xdot and xddot are there and none of the five samples they rest on is suspect: not in
        filled gaps, not at the filter's edges, not on plateaus. phi is NaN outside of the strides
    Source: Ebers (2023), Eqs. 4.1-4.4. Differs: the operator, which the text does not state, and the marks.
    """
    x, rate = filtered.values, filtered.rate_hz
    goes_on = unwrap(filtered).values
    xdot, xddot = derivative(goes_on, rate, 1), derivative(goes_on, rate, 2)
    usable = np.isfinite(x) & np.isfinite(xdot) & np.isfinite(xddot) & ~_widen(np.asarray(filtered.suspect))
    phi = strides.phi(filtered.time)
    return Trajectory(
        filtered.time, x, xdot, xddot, phi, filtered.channels, usable, filtered.subject, filtered.condition
    )


def _widen(marks: NDArray[np.bool_]) -> NDArray[np.bool_]:
    wide = marks.copy()
    for shift in range(1, REACH + 1):
        wide[shift:] |= marks[:-shift]
        wide[:-shift] |= marks[shift:]
    return wide
