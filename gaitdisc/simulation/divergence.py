"""Where a simulation that blows up does so: trial, time, state, and the parameter that drives it."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from gaitdisc.simulation.compiled_simulation import Compiled
from gaitdisc.simulation.drive import Drive, Rows
from gaitdisc.simulation.refusal import SimulationError

SLOW_HZ = 2.0  # samples a second, below which a time in milliseconds is likelier than a record so coarse
_NUDGE = 1e-2  # of a parameter, to see what drives the rate


@dataclass(frozen=True)
class Divergence:
    """The last that is known of a row."""

    row: int
    trial: int
    time: float  # of its last finite sample [s]
    state: str  # that changes fastest there, relative to its size
    value: float
    parameter: str  # that the state's rate depends on most there; empty where it depends on none


def divergences(
    compiled: Compiled, drive: Drive, rows: Rows, states: NDArray[np.float64], ok: NDArray[np.bool_]
) -> tuple[Divergence, ...]:
    """Where each row that did not stay finite was last seen.

    states (row, step, state): from `Compiled.run`
    ok (row,): from `Compiled.run`
    """
    return tuple(_divergence(compiled, drive, rows, states, int(row)) for row in np.flatnonzero(~ok))


def refuse_divergence(
    compiled: Compiled, drive: Drive, rows: Rows, states: NDArray[np.float64], ok: NDArray[np.bool_]
) -> None:
    """Refuse a run of which a row did not stay finite."""
    if np.all(ok):
        return
    first, *others = divergences(compiled, drive, rows, states, ok)
    more = f"; so do {len(others)} more of {len(ok)} runs" if others else ""
    driven = f"{first.parameter!r}, which affects its rate most, and " if first.parameter else ""
    late = " (time is in seconds, not in milliseconds)" if drive.rate < SLOW_HZ else ""
    raise SimulationError(
        "every state of a simulation must stay within 1e6",
        f"{compiled.simulation.title!r} diverges in trial {first.trial + 1} after t = {first.time:.4g} s, first in "
        f"{first.state!r} (last value {first.value:.3g}){more}",
        f"Check {driven}the initial state. Samples {1 / drive.rate:.4g} s apart may also be too coarse for this "
        f"motion{late}.",
    )


def _divergence(compiled: Compiled, drive: Drive, rows: Rows, states: NDArray[np.float64], row: int) -> Divergence:
    finite = np.isfinite(states[row]).all(axis=1)
    last = int(np.argmin(finite)) - 1 if not finite.all() else len(finite) - 1
    last = max(last, 0)
    trial, sample = int(rows.trial[row]), int(rows.begin[row]) + last
    x = np.nan_to_num(states[row, last])
    t = np.array([drive.time0[trial] + sample / drive.rate])
    u = drive.inputs[trial, min(sample, int(drive.samples[trial]) - 1)][None]
    values = (
        compiled.defaults if rows.values is None else np.atleast_2d(rows.values)[row if rows.values.ndim > 1 else 0]
    )
    # signals without their delay, which is near enough to say what is fast
    now = dict(zip(compiled.inputs, u[0], strict=True)) | dict(zip(compiled.states, x, strict=True))
    late = np.array([[float(now[signal]) for signal, _ in compiled.right_hand_side.delays]])
    with np.errstate(all="ignore"):
        rates = compiled.rates(t, x[None], u, values, late)[0]
        speed = np.abs(np.nan_to_num(rates, nan=np.inf, posinf=np.inf)) / (1e-6 + np.abs(x))
    fastest = int(np.argmax(speed if speed.max() > 0 else ~np.isfinite(states[row, last])))
    moved = np.repeat(values[None], len(values), axis=0) * (1 + _NUDGE * np.eye(len(values)))
    if len(values):
        alike = [np.repeat(each, len(values), axis=0) for each in (t, x[None], u, late)]
        with np.errstate(all="ignore"):
            change = np.abs(compiled.rates(alike[0], alike[1], alike[2], moved, alike[3])[:, fastest] - rates[fastest])
        change = np.nan_to_num(change, nan=0.0, posinf=0.0)
    else:
        change = np.zeros(1)
    parameter = compiled.parameters[int(np.argmax(change))] if change.max() > 0 else ""
    return Divergence(row, trial, float(t[0]), compiled.states[fastest], float(x[fastest]), parameter)
