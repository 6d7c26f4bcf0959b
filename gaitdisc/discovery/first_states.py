"""First guess of the states of a record, from which the fit of the start states begins.

The observation map y = h(x, u, t) of a simulation is solved for the states at each sample of the record. States that an
effect brings along no channel shows. Along the states of the record each is a differential equation driven by measured
signals; its course over whole trials gives the start of every run.
"""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from gaitdisc.discovery.noise import savgol_filter
from gaitdisc.discovery.shooting import Shooting
from gaitdisc.recording.arrays import Values
from gaitdisc.simulation.compiled_simulation import SUBSTEPS, Compiled, Drive, Rows
from gaitdisc.simulation.measured import Measured
from gaitdisc.simulation.parts import Input
from gaitdisc.simulation.program import at_points, leaf_columns
from gaitdisc.simulation.running import compile_simulation
from gaitdisc.simulation.simulation import Simulation

SHARE_OF_PERIOD = 0.2
OFTEN = 0.5  # of a trial's samples, at which the channels determine a state
FORGOTTEN = 0.1  # of the greatest difference that two starts of a hidden state make, left at a trial's end
TURNS = 4  # of rates and positions, where a channel sees both
SOLVING_TURNS = 30
HALVINGS = 6
NUDGE = 1e-6
RANK = 1e-6  # singular values below this share of the largest count as none
DETERMINED = 0.9  # of a state's unit vector that lies in the row space of the Jacobian
SOLVED = 1e-3  # of a channel's spread, below which no other beginning is tried
LEFT = 0.5  # of a channel's spread, beyond which a sample is not solved


def guess_states(simulation: Simulation, measured: Measured, period: float, rate_of: dict[str, str]) -> Values:
    """Guess the states: the observation map solved for them on smoothed channels, rates as slopes of positions.

    period: the motion's main period [s]
    returns (trial, sample, state): NaN beyond a trial's end. A state that the channels do not determine and that is no
        rate of one that they do follows its equation where it forgets its start within a trial, from its `initial`, or
        from where a run before ended; else it stays at its `initial`, or at 0, moved by what the channels say of it
    """
    machine, drive = compile_simulation(simulation), measured.drive
    observed, rate = measured.observed, drive.rate
    window = max(int(SHARE_OF_PERIOD * period * rate) // 2 * 2 + 1, 5)
    spread = np.nanstd(observed, axis=(0, 1))
    spread = np.where(spread > 0, spread, 1.0)
    rates = {machine.states.index(state): machine.states.index(other) for state, other in rate_of.items()}
    initial = np.array([state.initial or 0.0 for state in simulation.states])
    out, hidden = np.full((*observed.shape[:2], len(machine.states)), np.nan), np.ones(len(machine.states), bool)
    for trial, record in enumerate(observed):
        length = int(measured.samples[trial])
        width = min(window, length // 2 * 2 - 1)
        whole = [_bridge(channel, np.isfinite(channel)) for channel in record[:length].T]
        smooth = np.column_stack([savgol_filter(trial, width, 3) for trial in whole]) / spread
        slope = np.column_stack([savgol_filter(trial, width, 3, 1, 1 / rate) for trial in whole]) / spread
        t = drive.time0[trial] + np.arange(length) / rate
        seeing = ObservationMap(machine, t, drive.inputs[trial, :length], spread)
        out[trial, :length], known = _states(seeing, smooth, slope, np.tile(initial, (length, 1)), rates, rate)
        hidden &= ~known
    if hidden.any() and not hidden.all() and isinstance(simulation, Simulation):
        return _following(simulation, drive, out, hidden)
    return out


def _following(simulation: Simulation, drive: Drive, states: Values, hidden: NDArray[np.bool_]) -> Values:
    """States (trial, sample, state), those that are hidden along their own equations, where they forget their start."""
    machine = compile_simulation(isolate_equations(simulation, np.flatnonzero(hidden).tolist()))
    driving = np.concatenate([np.nan_to_num(states[..., ~hidden]), drive.inputs], axis=2)
    trials = np.arange(len(states))
    runs = run_twice(machine, replace(drive, inputs=driving), Rows(trials, 0 * trials, states[:, 0, hidden]))
    apart = np.abs(runs[0] - runs[1])
    if not (apart[trials, drive.samples - 1] <= FORGOTTEN * apart.max(axis=1)).all():
        return states
    out = states.copy()
    given = [state.initial is not None for state, open_ in zip(simulation.states, hidden, strict=True) if open_]
    out[..., hidden] = np.where(np.isfinite(states[..., hidden]), np.where(given, *runs), np.nan)
    return out


def _states(
    seeing: ObservationMap, smooth: Values, slope: Values, begin: Values, rates: dict[int, int], rate: float
) -> tuple[Values, NDArray[np.bool_]]:
    """States of one trial (sample, state), and which of them the channels say (state,).

    A rate that they leave open is the slope of its position.
    """
    free = np.ones(begin.shape[1], bool)
    x, known = seeing.solved(smooth, begin, free)
    often = known.mean(axis=0) > OFTEN
    open_ones = {state: other for state, other in rates.items() if often[state] and not often[other]}
    free[[*open_ones.values()]] = False
    for _ in range(TURNS if open_ones else 0):
        slopes = seeing.jacobian(x)
        beside = (slopes * ~free) @ (np.gradient(x, axis=0) * rate)[..., None]  # what the rates' own change shows
        moving = np.linalg.pinv(slopes * free, rcond=RANK) @ ((slope - seeing.drift(x, rate))[..., None] - beside)
        for position, other in open_ones.items():
            x[:, other] = _bridge(moving[:, position, 0], known[:, position])
        if not slopes[:, :, ~free].any():
            break
        x, known = seeing.solved(smooth, np.where(free, begin, x), free)
    for state in np.flatnonzero(often):
        x[:, state] = _bridge(x[:, state], known[:, state])
    return x, often | ~free


def _bridge(values: Values, known: NDArray[np.bool_]) -> Values:
    return values if known.all() else np.interp(np.arange(len(values)), np.flatnonzero(known), values[known])


def with_own_states(shooting: Shooting, machine: Compiled, values: Values, starts: Values) -> Values:
    """Return start states (segment, state) with those of the effects' own states, where these are not yet among them.

    starts (segment, state): of the simulation as read, first; what follows is replaced
    """
    if shooting.past is None or len(machine.states) == shooting.past.shape[2]:
        return starts[:, : len(machine.states)]
    segments = shooting.segments
    added = follow(shooting, machine.simulation, values[None])[0][segments.trial, segments.begin]
    return np.concatenate([starts[:, : shooting.past.shape[2]], added], axis=1)


def follow(shooting: Shooting, simulation: Simulation, values: Values) -> Values:
    """Return the effects' own states along those of the record (version, trial, sample, own state)."""
    assert shooting.past is not None
    drive = shooting.measured.drive
    past = np.zeros(shooting.past.shape)  # unknown samples bridged by straight lines, zero beyond the end
    for trial, length in enumerate(drive.samples):
        for state, seen in enumerate(shooting.past[trial, :length].T):
            known = np.isfinite(seen)
            if known.any():
                past[trial, :length, state] = _bridge(seen, known)
    inputs = np.concatenate([past, drive.inputs], axis=2)
    along = Drive(drive.rate, drive.time0, inputs, drive.samples)
    added = range(shooting.past.shape[2], len(simulation.states))
    machine = compile_simulation(isolate_equations(simulation, added))
    trials, versions = len(drive.samples), len(values)
    trial = np.tile(np.arange(trials), versions)
    starts = np.tile([state.initial or 0.0 for state in machine.simulation.states], (len(trial), 1))
    rows = Rows(trial, 0 * trial, starts, np.repeat(values, trials, axis=0))
    runs = np.nan_to_num(run_twice(machine, along, rows, shooting.substeps)[1], nan=0.0, posinf=0.0, neginf=0.0)
    return runs.reshape(versions, trials, runs.shape[1], -1)


def run_twice(machine: Compiled, drive: Drive, rows: Rows, substeps: int = SUBSTEPS) -> tuple[Values, Values]:
    """Run over whole trials, and again from where each ended, its start forgotten; both (row, sample, state)."""
    steps = int(drive.samples.max()) - 1
    first, _ = machine.run(drive, rows, steps, substeps=substeps)
    ends = first[np.arange(len(rows.trial)), drive.samples[rows.trial] - 1]
    again = replace(rows, starts=np.nan_to_num(ends, nan=0.0, posinf=0.0, neginf=0.0))
    return first, machine.run(drive, again, steps, substeps=substeps)[0]


def isolate_equations(simulation: Simulation, numbers: Iterable[int]) -> Simulation:
    """Return the equations of some of the states, the others being inputs before the rest; nothing acts at ports."""
    states, equations = [simulation.states[number] for number in numbers], dict(simulation.equations)
    others = [state for state in simulation.states if state not in states]
    return replace(
        simulation,
        states=tuple(states),
        inputs=(*(Input(state.name, state.unit) for state in others), *simulation.inputs),
        parameters=tuple(replace(parameter, low=None, high=None) for parameter in simulation.parameters),
        equations=tuple((state.name, equations[state.name]) for state in states),
        ports=(),
        definitions=(*((port.name, "0") for port in simulation.ports), *simulation.definitions),
        observations=(),
        sensors=(),
        effects=(),
    )


@dataclass(frozen=True)
class ObservationMap:
    """What a simulation observes at states (sample, state) of one trial, over each channel's spread, without delays."""

    machine: Compiled
    t: Values  # (sample,), time [s]
    u: Values  # (sample, input), inputs
    spread: Values  # (channel,), of the measured channels [each channel's unit]

    def at(self, x: Values) -> Values:
        """Return the channels that states give (sample, channel)."""
        machine, program = self.machine, self.machine.observation
        signals = dict(zip((*machine.states, *machine.inputs), (*x.T, *self.u.T), strict=True))
        late = np.column_stack([signals[name] for name, _ in program.delays]) if program.delays else None
        with np.errstate(all="ignore"):
            seen = at_points(program, leaf_columns(self.t, x, self.u, machine.defaults), late, len(x))
        return seen.T / self.spread

    def jacobian(self, x: Values) -> Values:
        """Return the slopes of the channels by the states (sample, channel, state); zero where there is none."""
        sizes = NUDGE * np.maximum(np.abs(x).max(axis=0), 1.0)
        pairs = zip(sizes, np.diag(sizes), strict=True)
        columns = [(self.at(x + nudge) - self.at(x - nudge)) / (2 * size) for size, nudge in pairs]
        return np.nan_to_num(np.stack(columns, axis=2), nan=0.0, posinf=0.0, neginf=0.0)

    def drift(self, x: Values, rate: float) -> Values:
        """Return how fast channels change while the states rest, through inputs and time (sample, channel) [1/s]."""
        number = np.arange(len(x))
        after, before = np.minimum(number + 1, len(x) - 1), np.maximum(number - 1, 0)
        ahead, behind = (replace(self, t=self.t[at], u=self.u[at]).at(x) for at in (after, before))
        return np.nan_to_num((ahead - behind) * rate / np.maximum(after - before, 1)[:, None])

    def solved(self, seen: Values, begin: Values, free: NDArray[np.bool_]) -> tuple[Values, NDArray[np.bool_]]:
        """Return the states that give what is seen, by Gauss-Newton, nearest to where the search begins.

        What the channels do not determine stays as it began (pseudo-inverse).

        seen (sample, channel): measured, over each channel's spread
        begin (sample, state): where the search begins
        free (state,): states that may move
        returns states (sample, state): the best of the searches from there, and from 1 to either side, where a slope
            may be zero at 0
        returns determined (sample, state): whether the channels determine the state
        """
        x = self._descend(seen, begin, free)
        left = self._left(seen, x)
        for shift in (1.0, -1.0):
            if (left < SOLVED**2).all():
                break
            other = self._descend(seen, begin + shift * free, free)
            better = (left >= SOLVED**2) & (self._left(seen, other) < left / 2)
            x = np.where(better[:, None], other, x)
            left = self._left(seen, x)
        slopes = self.jacobian(x) * free
        space = np.linalg.pinv(slopes, rcond=RANK) @ slopes
        whole = np.diagonal(space, axis1=1, axis2=2) > DETERMINED
        return x, whole & (left < LEFT**2)[:, None]

    def _descend(self, seen: Values, x: Values, free: NDArray[np.bool_]) -> Values:
        """Gauss-Newton at all samples side by side, each step halved while it gains nothing."""
        left = self._left(seen, x)
        for _ in range(SOLVING_TURNS):
            step = np.linalg.pinv(self.jacobian(x) * free, rcond=RANK) @ np.nan_to_num(seen - self.at(x))[..., None]
            share, moved = np.ones(len(x)), np.zeros(len(x), bool)
            for _ in range(HALVINGS):
                tried = x + share[:, None] * step[..., 0]
                after = self._left(seen, tried)
                better = ~moved & (after < left * (1 - 1e-9))
                x, left = np.where(better[:, None], tried, x), np.where(better, after, left)
                moved |= better
                share = np.where(moved, share, share / 2)
            if not moved.any():
                break
        return x

    def _left(self, seen: Values, x: Values) -> Values:
        """Mean squared misfit of each sample (sample,)."""
        return np.nan_to_num(((seen - self.at(x)) ** 2).mean(axis=1), nan=np.inf)
