"""A simulation that is ready to run, and what drives it: many trials, many starts and many parameters at once."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike, NDArray

from gaitdisc.errors import ShapeError
from gaitdisc.recording.arrays import Values, read_only
from gaitdisc.simulation.program import Program, at_points, compile_program, leaf_columns
from gaitdisc.simulation.simulation import Simulation

SUBSTEPS = 5  # Runge-Kutta steps for each sample


@dataclass(frozen=True, eq=False)
class Drive:
    """What drives a simulation, trial by trial, at one rate.

    >>> Drive.of([np.zeros((300, 1)), np.zeros((200, 1))], 100.0).samples.tolist()
    [300, 200]
    """

    rate: float  # samples a second [Hz]
    time0: Values  # (trial,), time of each trial's first sample [s]
    # (trial, sample, input), in the order of the simulation's inputs; zero beyond a trial's end
    inputs: Values
    samples: NDArray[np.int64]  # (trial,), length of each trial

    def __post_init__(self) -> None:
        """Freeze the arrays and refuse shapes that do not fit."""
        inputs = read_only(np.ascontiguousarray(self.inputs, float))
        samples = read_only(np.ascontiguousarray(self.samples, np.int64), np.int64)
        time0 = read_only(np.ascontiguousarray(self.time0, float))
        fits = inputs.ndim == 3 and samples.shape == time0.shape == inputs.shape[:1]
        if not (fits and self.rate > 0 and np.all((samples > 0) & (samples <= inputs.shape[1]))):
            raise ShapeError(
                "a drive must have inputs (trial, sample, input), a first time and a length for each trial, and a rate",
                f"the inputs have shape {inputs.shape}, the times {time0.shape}; lengths {samples.tolist()[:5]}, rate "
                f"{self.rate}",
                "Build the drive from a list of trials with Drive.of.",
            )
        for name, value in (("rate", float(self.rate)), ("time0", time0), ("inputs", inputs), ("samples", samples)):
            object.__setattr__(self, name, value)

    @classmethod
    def of(cls, trials: Sequence[ArrayLike], rate: float, time0: ArrayLike = 0.0) -> Drive:
        """Drive of a list of trials, each (sample, input), with one first time for all or one for each."""
        arrays = [np.asarray(trial, float) for trial in trials]
        samples = np.array([len(array) for array in arrays])
        inputs = np.zeros((len(arrays), samples.max(), arrays[0].shape[1]))
        for trial, array in enumerate(arrays):
            inputs[trial, : len(array)] = array
        return cls(rate, np.broadcast_to(np.asarray(time0, float), samples.shape), inputs, samples)


@dataclass(frozen=True, eq=False)
class Rows:
    """Stretches of trials to run, each from its own state and with its own parameters."""

    trial: NDArray[np.int64]  # (row,), number of the trial
    begin: NDArray[np.int64]  # (row,), sample that each starts at
    starts: Values  # (row, state), state there
    # (row, parameter) or (parameter,), parameters; the simulation's own where absent
    values: Values | None = None


@dataclass(frozen=True, eq=False)
class Compiled:
    """A simulation that is ready to run."""

    simulation: Simulation
    states: tuple[str, ...]
    inputs: tuple[str, ...]
    parameters: tuple[str, ...]
    observed: tuple[str, ...]
    defaults: Values  # (parameter,), the parameters' own values
    right_hand_side: Program  # derivatives of the states
    observation: Program  # the observed channels

    def run(
        self, drive: Drive, rows: Rows, steps: int, *, substeps: int = SUBSTEPS, past: Values | None = None
    ) -> tuple[Values, NDArray[np.bool_]]:
        """States along each row, by Runge-Kutta of order 4.

        past (trial, sample, state): measured states, the first ones or all, for delays that reach before a row's
            start; held at the start where absent or NaN
        returns states (row, steps + 1, state): NaN beyond the trial's end, and from where a row diverged (a state
            beyond 1e6, or not a number)
        returns ok (row,): false where a row diverged
        """
        place, starts, values = self._rows(drive, rows)
        right = self.right_hand_side
        seconds = self._seconds(right, values)
        states = np.full((len(starts), steps + 1, len(self.states)), np.nan)
        states[:, 0] = starts
        ok = np.asarray(np.isfinite(starts).all(axis=1))
        lanes, integrate = self._integrator(values)
        program = right.placed(lanes), right.setup, right.constants, self._delays(right), right.registers
        driven, before = self._driven(drive), self._before(past)
        plan = (steps, substeps, lanes, np.flatnonzero(right.used()[1 + len(self.states) :][: len(self.inputs)]))
        with np.errstate(all="ignore"):  # a row that leaves every bound is reported, not warned of
            integrate(program, driven, (place, starts, values, seconds), plan, before, (states, ok))
        return states, ok

    def _integrator(self, values: Values) -> tuple[int, Callable[..., None]]:  # noqa: ARG002
        """Rows that a block has room for, and what integrates them; values (row, parameter): parameters."""
        from gaitdisc.simulation.machine import BLOCK, integrate

        return BLOCK, integrate

    def rates(
        self, t: ArrayLike, x: Values, u: Values, values: Values | None = None, late: Values | None = None
    ) -> Values:
        """Right-hand side at many points; parameters are the simulation's own where absent, or of each point.

        late (point, delay): delayed signals, in the order of `right_hand_side.delays`
        """
        x, values = np.asarray(x, float), self.defaults if values is None else np.asarray(values, float)
        columns = leaf_columns(np.broadcast_to(np.asarray(t, float), len(x)), x, u, values)
        return self._derivatives(x, at_points(self.right_hand_side, columns, late, len(x)).T, values)

    def _derivatives(self, x: Values, outputs: Values, values: Values) -> Values:  # noqa: ARG002
        """Derivatives (point, state) by what the right-hand side gives (point, output)."""
        return outputs

    def observe(self, drive: Drive, rows: Rows, states: Values, past: Values | None = None) -> Values:
        """Observed channels (row, step, observed) along rows that were run, their states and past as of `run`."""
        place, _, values = self._rows(drive, rows)
        count, steps, n = states.shape
        sample = place[:, 1, None] + np.arange(steps)
        held = np.minimum(sample, drive.samples[place[:, 0], None] - 1)
        used = self.observation.used()
        first = 1 + n + len(self.inputs)
        t = drive.time0[place[:, 0], None] + sample / drive.rate
        seconds = self._seconds(self.observation, values)
        late = np.empty((count, steps, seconds.shape[1]))
        if late.size:
            from gaitdisc.simulation.machine import delay_signals

            delays = self._delays(self.observation)
            delay_signals(delays, seconds, self._driven(drive), place, self._before(past), states=states, into=late)
        points = count * steps
        columns = leaf_columns(t.ravel(), states.reshape(points, n), np.empty((points, 0)), values[0])
        columns[1 + n : 1 + n] = [
            drive.inputs[place[:, 0, None], held, column].ravel() if used[1 + n + column] else np.zeros(())
            for column in range(len(self.inputs))
        ]
        for column in range(len(self.parameters)):
            if used[first + column]:
                columns[first + column] = np.repeat(values[:, column], steps)
        observed = at_points(self.observation, columns, late.reshape(points, -1), points)
        return np.ascontiguousarray(observed.T).reshape(count, steps, len(self.observed))

    def _driven(self, drive: Drive) -> tuple:
        wraps = np.array([signal.wraps for signal in self.simulation.inputs], bool)
        return drive.rate, drive.time0, drive.inputs, drive.samples, wraps

    def _before(self, past: Values | None) -> Values:
        """Past with NaN for the states that it lacks, the last ones: an effect's own were never measured."""
        if past is None:
            return read_only(np.empty((0, 0, 0)))
        lacking = len(self.states) - past.shape[2]
        if lacking:
            past = np.pad(past, ((0, 0), (0, 0), (0, lacking)), constant_values=np.nan)
        return read_only(np.ascontiguousarray(past, float))

    def _rows(self, drive: Drive, rows: Rows) -> tuple[NDArray[np.int64], Values, Values]:
        starts = np.array(rows.starts, float, order="C", ndmin=2)
        count = len(starts)
        values = self.defaults if rows.values is None else np.asarray(rows.values, float)
        fits = starts.shape[1] == len(self.states) and drive.inputs.shape[2] == len(self.inputs)
        if not fits or values.shape not in ((len(self.parameters),), (count, len(self.parameters))):
            raise ShapeError(
                f"rows must have starts (row, {len(self.states)}), values (row, {len(self.parameters)}) and "
                f"{len(self.inputs)} inputs",
                f"they have starts {starts.shape}, values {values.shape}, {drive.inputs.shape[2]} inputs",
                "Use the order of the simulation's states, parameters and inputs.",
            )
        place = np.empty((count, 2), np.int64)
        place[:, 0], place[:, 1] = rows.trial, rows.begin
        inside = (place[:, 0] >= 0) & (place[:, 0] < len(drive.samples)) & (place[:, 1] >= 0)
        if not inside.all() or np.any(place[:, 1] >= drive.samples[place[:, 0]]):
            raise ShapeError(
                f"each row must begin inside one of {len(drive.samples)} trials",
                f"the trials are {place[:, 0].min()} to {place[:, 0].max()}, the first samples {place[:, 1].min()} to "
                f"{place[:, 1].max()}",
                "Count trials and samples from 0.",
            )
        return place, starts, np.array(np.broadcast_to(values, (count, len(self.parameters))), order="C")

    def _seconds(self, program: Program, values: Values) -> Values:
        """Seconds of each delay of a program, (row, delay)."""
        if not program.delays:
            return np.empty((len(values), 0))
        ago = compile_program([seconds for _, seconds in program.delays], self.parameters)
        return np.ascontiguousarray(at_points(ago, list(values.T), None, len(values)).T)

    def _delays(self, program: Program) -> NDArray[np.int64]:
        """Of each delay whether it is of a state (else of an input), and its column, (delay, 2)."""
        kinds = [
            (1, self.states.index(signal)) if signal in self.states else (0, self.inputs.index(signal))
            for signal, _ in program.delays
        ]
        return np.array(kinds, np.int64).reshape(-1, 2)
