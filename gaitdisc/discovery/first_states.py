"""First guess of the states of a record, from which the fit of the start states begins."""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from gaitdisc.discovery.observation_map import RANK, ObservationMap
from gaitdisc.discovery.own_states import driven_by_others, run_twice
from gaitdisc.discovery.segments import Segments
from gaitdisc.signals.derivatives import savgol_filter
from gaitdisc.simulation.drive import Drive, Rows
from gaitdisc.simulation.measured import Measured
from gaitdisc.simulation.running import compile_simulation
from gaitdisc.simulation.simulation import Simulation

SHARE_OF_PERIOD = 0.2
OFTEN = 0.5  # of a trial's samples, at which the channels determine a state
FORGOTTEN = 0.1  # of the greatest difference that two starts of a hidden state make, left at a trial's end
TURNS = 4  # of rates and positions, where a channel sees both


@dataclass(frozen=True)
class StateGuess:
    """States of every trial, roughly."""

    states: NDArray[np.float64]  # (trial, sample, state), NaN beyond a trial's end

    def starts(self, segments: Segments) -> NDArray[np.float64]:
        """Return the guess at each segment's first sample (segment, state)."""
        return self.states[segments.trial, segments.begin].copy()

    def with_run(self, segments: Segments, states: NDArray[np.float64]) -> StateGuess:
        """Return the guess with a run put in its place where there is one.

        states (segment, sample, state): their states; those that effects bring along, after the others, are left out
        """
        return StateGuess(segments.put(self.states, states[..., : self.states.shape[2]]))


def guess_states(simulation: Simulation, measured: Measured, period: float, rate_of: dict[str, str]) -> StateGuess:
    """Guess the states: the observation map solved for them on smoothed channels, rates as slopes of positions.

    simulation: names, and observations: any expressions of states, inputs and time
    period: the motion's main period [s]
    returns: a state that the channels do not determine and that is no rate of one that they do follows its equation
        where it forgets its start within a trial, from its `initial`, or from where a run before ended; else it stays
        at its `initial`, or at 0, moved by what the channels say of it
    """
    machine, drive = compile_simulation(simulation), measured.drive
    observed, rate = measured.observed, drive.rate
    window = max(int(SHARE_OF_PERIOD * period * rate) // 2 * 2 + 1, 5)
    spread = np.nanstd(observed, axis=(0, 1))
    spread = np.where(spread > 0, spread, 1.0)
    pairs = [(machine.states.index(one), machine.states.index(other)) for one, other in rate_of.items()]
    initial = np.array([state.initial or 0.0 for state in simulation.states])
    out, hidden = np.full((*observed.shape[:2], len(machine.states)), np.nan), np.ones(len(machine.states), bool)
    for trial, record in enumerate(observed):
        length = int(measured.samples[trial])
        width = min(window, length // 2 * 2 - 1)
        whole = [_bridged(channel, np.isfinite(channel)) for channel in record[:length].T]
        smooth = np.column_stack([savgol_filter(one, width, 3) for one in whole]) / spread
        slope = np.column_stack([savgol_filter(one, width, 3, 1, 1 / rate) for one in whole]) / spread
        t = drive.time0[trial] + np.arange(length) / rate
        seeing = ObservationMap(machine, t, drive.inputs[trial, :length], spread)
        out[trial, :length], known = _states(seeing, (smooth, slope), np.tile(initial, (length, 1)), pairs, rate)
        hidden &= ~known
    if hidden.any() and not hidden.all() and isinstance(simulation, Simulation):
        out = _following(simulation, drive, out, hidden)
    return StateGuess(out)


def _following(
    simulation: Simulation, drive: Drive, states: NDArray[np.float64], hidden: NDArray[np.bool_]
) -> NDArray[np.float64]:
    """States (trial, sample, state), those that are hidden along their own equations, where they forget their start."""
    machine = compile_simulation(driven_by_others(simulation, tuple(np.flatnonzero(hidden).tolist())))
    driving = np.concatenate([np.nan_to_num(states[..., ~hidden]), drive.inputs], axis=2)
    trials = np.arange(len(states))
    runs = run_twice(machine, replace(drive, inputs=driving), Rows(trials, 0 * trials, states[:, 0, hidden]))
    apart = np.abs(runs[0] - runs[1])
    if not (apart[trials, drive.samples - 1] <= FORGOTTEN * apart.max(axis=1)).all():
        return states
    out = states.copy()
    said = [state.initial is not None for state, open_ in zip(simulation.states, hidden, strict=True) if open_]
    out[..., hidden] = np.where(np.isfinite(states[..., hidden]), np.where(said, *runs), np.nan)
    return out


def _states(
    seeing: ObservationMap,
    seen: tuple[NDArray[np.float64], NDArray[np.float64]],
    begin: NDArray[np.float64],
    pairs: list[tuple[int, int]],
    rate: float,
) -> tuple[NDArray[np.float64], NDArray[np.bool_]]:
    """States of one trial (sample, state), and which of them the channels say (state,).

    A rate that they leave open is the slope of its position.
    """
    smooth, slope = seen
    free = np.ones(begin.shape[1], bool)
    x, known = seeing.solved(smooth, begin, free)
    often = known.mean(axis=0) > OFTEN
    rates = [(one, other) for one, other in pairs if often[one] and not often[other]]
    free[[other for _, other in rates]] = False
    for _ in range(TURNS if rates else 0):
        slopes = seeing.jacobian(x)
        beside = (slopes * ~free) @ (np.gradient(x, axis=0) * rate)[..., None]  # what the rates' own change shows
        moving = np.linalg.pinv(slopes * free, rcond=RANK) @ ((slope - seeing.drift(x, rate))[..., None] - beside)
        for position, other in rates:
            x[:, other] = _bridged(moving[:, position, 0], known[:, position])
        if not slopes[:, :, ~free].any():
            break
        x, known = seeing.solved(smooth, np.where(free, begin, x), free)
    for state in np.flatnonzero(often):
        x[:, state] = _bridged(x[:, state], known[:, state])
    return x, often | ~free


def _bridged(values: NDArray[np.float64], known: NDArray[np.bool_]) -> NDArray[np.float64]:
    return values if known.all() else np.interp(np.arange(len(values)), np.flatnonzero(known), values[known])
