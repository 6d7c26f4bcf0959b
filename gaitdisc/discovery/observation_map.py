"""The observation map y = h(x, u, t) of a simulation, solved for the states at each sample of a record."""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from gaitdisc.simulation.compiled_simulation import Compiled
from gaitdisc.simulation.program import at_points, leaf_columns

TURNS = 30
HALVINGS = 6
NUDGE = 1e-6
RANK = 1e-6  # singular values below this share of the largest count as none
DETERMINED = 0.9  # of a state's unit vector that lies in the row space of the Jacobian
SOLVED = 1e-3  # of a channel's spread, below which no other beginning is tried
LEFT = 0.5  # of a channel's spread, beyond which a sample is not solved


@dataclass(frozen=True)
class ObservationMap:
    """What a simulation observes at the samples of one trial, over each channel's spread; delays are taken as none."""

    machine: Compiled
    t: NDArray[np.float64]  # (sample,), time [s]
    u: NDArray[np.float64]  # (sample, input), inputs
    spread: NDArray[np.float64]  # (channel,), of the measured channels [each channel's unit]

    def at(self, x: NDArray[np.float64]) -> NDArray[np.float64]:
        """Return the channels that states give (sample, channel).

        x (sample, state): states
        """
        machine, program = self.machine, self.machine.observation
        signals = dict(zip((*machine.states, *machine.inputs), (*x.T, *self.u.T), strict=True))
        late = np.column_stack([signals[name] for name, _ in program.delays]) if program.delays else None
        with np.errstate(all="ignore"):
            seen = at_points(program, leaf_columns(self.t, x, self.u, machine.defaults), late, len(x))
        return seen.T / self.spread

    def jacobian(self, x: NDArray[np.float64]) -> NDArray[np.float64]:
        """Return the slopes of the channels by the states (sample, channel, state); zero where there is none.

        x (sample, state): states
        """
        columns = []
        for state in range(x.shape[1]):
            nudge = np.zeros(x.shape[1])
            nudge[state] = NUDGE * max(float(np.abs(x[:, state]).max()), 1.0)
            columns.append((self.at(x + nudge) - self.at(x - nudge)) / (2 * nudge[state]))
        return np.nan_to_num(np.stack(columns, axis=2), nan=0.0, posinf=0.0, neginf=0.0)

    def drift(self, x: NDArray[np.float64], rate: float) -> NDArray[np.float64]:
        """Return how fast the channels change while the states rest, through inputs and time (sample, channel) [1/s].

        x (sample, state): states
        rate: samples a second [Hz]
        """
        number = np.arange(len(x))
        after, before = np.minimum(number + 1, len(x) - 1), np.maximum(number - 1, 0)
        ahead, behind = (replace(self, t=self.t[at], u=self.u[at]).at(x) for at in (after, before))
        return np.nan_to_num((ahead - behind) * rate / np.maximum(after - before, 1)[:, None])

    def solved(
        self, seen: NDArray[np.float64], begin: NDArray[np.float64], free: NDArray[np.bool_]
    ) -> tuple[NDArray[np.float64], NDArray[np.bool_]]:
        """Return the states that give what is seen, by Gauss-Newton, nearest to where the search begins.

        What the channels do not determine stays as it began (pseudo-inverse).

        seen (sample, channel): measured, over each channel's spread
        begin (sample, state): where the search begins
        free (state,): states that may move
        returns states (sample, state): the best of the searches from there, and from 1 to either side, where a slope
            may be zero at 0
        returns determined (sample, state): whether the channels determine the state
        """
        x = self._descended(seen, begin, free)
        left = self._left(seen, x)
        for shift in (1.0, -1.0):
            if (left < SOLVED**2).all():
                break
            other = self._descended(seen, begin + shift * free, free)
            better = (left >= SOLVED**2) & (self._left(seen, other) < left / 2)
            x = np.where(better[:, None], other, x)
            left = self._left(seen, x)
        slopes = self.jacobian(x) * free
        space = np.linalg.pinv(slopes, rcond=RANK) @ slopes
        whole = np.diagonal(space, axis1=1, axis2=2) > DETERMINED
        return x, whole & (left < LEFT**2)[:, None]

    def _descended(
        self, seen: NDArray[np.float64], x: NDArray[np.float64], free: NDArray[np.bool_]
    ) -> NDArray[np.float64]:
        """Gauss-Newton at all samples side by side, each step halved while it gains nothing."""
        left = self._left(seen, x)
        for _ in range(TURNS):
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

    def _left(self, seen: NDArray[np.float64], x: NDArray[np.float64]) -> NDArray[np.float64]:
        """Mean squared misfit of each sample (sample,)."""
        return np.nan_to_num(((seen - self.at(x)) ** 2).mean(axis=1), nan=np.inf)
