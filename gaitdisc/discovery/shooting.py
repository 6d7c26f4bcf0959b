"""Fit a simulation to segments of a record: start states of each segment projected out, unknown constants shared.

Source: Bock and Plitt 1984, IFAC Proc. 17(2), 1603, doi 10.1016/S1474-6670(17)61205-9 (multiple shooting; here no
continuity joins the segments); Marquardt 1963, J. SIAM 11, 431 (damped steps); Golub and Pereyra 1973, SIAM J. Numer.
Anal. 10, 413 (start states solved for within: variable projection).
"""

from __future__ import annotations

from dataclasses import dataclass, field, replace
from functools import cached_property

import numpy as np
from numpy.typing import NDArray

from gaitdisc.discovery.fitted import Fitted, Prior
from gaitdisc.discovery.kept_work import keep, recall
from gaitdisc.discovery.noise import Noise
from gaitdisc.discovery.record_filter import RecordFilter
from gaitdisc.discovery.segments import Segments
from gaitdisc.recording.arrays import Values
from gaitdisc.simulation.compiled_simulation import Compiled
from gaitdisc.simulation.measured import Measured

DAMPING = 1e-3
MOST_DAMPING = 1e6
NUDGE = 1e-5  # of states and constants, as a share of their size, for slopes
STUCK = 5.0  # times the median misfit of a segment
FREED = 0.5  # of their misfit, which another start must leave at most
TURNS = 12
ENOUGH = 1e-2


@dataclass(frozen=True)
class Shooting:
    """Segments of measured trials and what it takes to run several versions of a simulation over them.

    Of these: starts (version, segment, state), states (version, segment, sample, state), values (version, parameter).
    """

    measured: Measured  # trials, with the inputs that drive the simulation
    segments: Segments
    noise: Noise
    substeps: int = 2
    # (trial, sample, state) or None, states before a segment begins, for what comes late
    past: Values | None = None
    prior: Prior = field(default_factory=Prior)  # of the parameters that have bounds and are fitted
    record_filter: RecordFilter | None = None

    @cached_property
    def seen(self) -> Values:
        """The measurement in each segment, where it is compared (segment, sample, channel)."""
        return self.segments.of(self.measured.observed)[:, self.segments.compared]

    @cached_property
    def known(self) -> NDArray[np.bool_]:
        """Where there is a measurement (segment, sample, channel)."""
        return np.isfinite(self.seen)

    def run(self, machine: Compiled, starts: Values, values: Values) -> tuple[Values, Values]:
        """Run a simulation over all segments, several versions at once.

        returns states (version, segment, sample, state): NaN from where a run left every bound
        returns observed (version, segment, sample, channel): what would be recorded, where it is compared
        """
        rows, drive = self.segments.rows(starts, values), self.measured.drive
        states, _ = machine.run(drive, rows, self.segments.length - 1, substeps=self.substeps, past=self.past)
        states = states.reshape(*starts.shape[:2], self.segments.length, -1)
        return states, self.observed(machine, states, values)

    def landed(self, machine: Compiled, states: Values, values: Values) -> Values:
        """Run every step of every segment by itself, and return where it lands (version, segment, step, state)."""
        rows = self.segments.steps.rows(states.reshape(len(states), -1, states.shape[-1]), values)
        landed, _ = machine.run(self.measured.drive, rows, 1, substeps=self.substeps, past=self.past)
        return landed[:, 1].reshape(states.shape)

    def observed(self, machine: Compiled, states: Values, values: Values) -> Values:
        """Return what would be recorded along states, where it is compared (version, segment, sample, channel)."""
        return self.filtered(self.unfiltered(machine, states, values), 2)

    def filtered(self, observed: Values, axis: int) -> Values:
        """Return channels as they come out of the filter that the record went through, where they are compared."""
        recorded = self.record_filter.filtered(observed, axis) if self.record_filter else observed
        return recorded[(slice(None),) * axis + (self.segments.compared,)]

    def unfiltered(self, machine: Compiled, states: Values, values: Values) -> Values:
        """Return what the sensors see along given states, before any filter (version, segment, sample, channel)."""
        rows = self.segments.rows(states[:, :, 0], values)
        seen = machine.observe(self.measured.drive, rows, states.reshape(-1, *states.shape[2:]), past=self.past)
        return seen.reshape(*states.shape[:3], -1)

    def whiten(self, residual: Values) -> Values:
        """Return residuals whitened and flat (segment, sample times channel, ...); what is unknown counts as none."""
        if not np.isfinite(residual).all():
            residual = np.nan_to_num(residual, nan=0.0, posinf=0.0, neginf=0.0)
        white = self.noise.whiten(residual, None if self.known.all() else self.known)
        return white.reshape(white.shape[0], -1, *white.shape[3:])

    def at(self, machine: Compiled, free: tuple[str, ...], values: Values, starts: Values) -> Fitted:
        """Return the fit at given constants and start states, with its slopes."""
        n, index = starts.shape[1], [machine.parameters.index(name) for name in free]
        spans = np.maximum(np.abs(starts).max(axis=0), 1e-3)
        nudges = NUDGE * np.concatenate([spans, np.maximum(np.abs(values[index]), 1e-2)])
        many_starts = np.repeat(starts[None], 1 + len(nudges), axis=0)
        many_values = np.repeat(values[None], 1 + len(nudges), axis=0)
        many_starts[1 + np.arange(n), :, np.arange(n)] += nudges[:n, None]
        many_values[1 + n + np.arange(len(index)), index] += nudges[n:]
        states, observed = self.run(machine, many_starts, many_values)
        residual = self.seen - observed[0]
        failed = ~np.isfinite(observed[0]).all(axis=(1, 2))
        white = self.whiten(residual)
        white[failed] = np.inf
        change = np.moveaxis((observed[1:] - observed[0]) / nudges[:, None, None, None], 0, -1)
        slopes, prior = self.whiten(change), self.prior.among(free)
        return Fitted(free, values, starts, states[0], residual, white=white, slopes=slopes, prior=prior)

    def fitted(
        self,
        machine: Compiled,
        free: tuple[str, ...],
        values: Values,
        starts: Values,
        turns: int = TURNS,
        enough: float = ENOUGH,
    ) -> Fitted:
        """Fit constants and start states (Levenberg-Marquardt; the start states of each segment solved for within).

        enough: a step that takes less off the misfit is the last
        """
        known = recall(repr((free, turns, enough)), values.tobytes(), starts.tobytes())
        if known:
            return self.at(machine, free, *map(np.array, known))
        now = self._descend(machine, self.at(machine, free, values, starts), turns, enough)
        elsewhere = self._begin_elsewhere(machine, now, starts)
        if elsewhere is not None:
            again = self._descend(machine, self.at(machine, free, now.values, elsewhere), turns, enough)
            now = again if again.misfit < now.misfit else now
        if free:  # else each segment has stopped at a step of its own
            keep((now.values.tolist(), now.starts.tolist()))
        return now

    def _descend(self, machine: Compiled, now: Fitted, turns: int, enough: float = ENOUGH) -> Fitted:
        """Return the fit after damped steps, until these gain nothing more."""
        damping = np.full(len(self.segments), DAMPING)
        for _ in range(turns):
            if not np.isfinite(now.misfit):
                break
            step = self.at(machine, now.free, *_step(now, machine, damping))
            better = step.misfits <= now.misfits
            if now.free:
                better[:] = step.misfit <= now.misfit
            moved = now.where(better, step)
            damping = np.where(better, np.maximum(damping / 10, 1e-9), damping * 10)
            gained, now = now.misfit - moved.misfit, moved
            if (damping > MOST_DAMPING).all() or (better.any() and gained < enough + 1e-6 * now.misfit):
                break
        return now

    def _begin_elsewhere(self, machine: Compiled, now: Fitted, starts: Values) -> Values | None:
        """Return better start states (segment, state) where a few segments fit far worse than most.

        A start on the wrong side of a threshold (a spike, a fall) is a minimum of its own, and a step of the constants
        that one segment needs is refused if it spoils the others. Tried are the starts that the fit ended and began
        with and the end of the segment before, each for constants as they are.
        """
        stuck = now.misfits > STUCK * np.median(now.misfits)
        if not np.isfinite(now.misfit) or not stuck.any():
            return None
        before = np.vstack([now.starts[:1], now.states[:-1, -1]])
        best = replace(now, free=(), slopes=now.slopes[..., : starts.shape[1]], prior=Prior())
        for other in (now.starts, starts, before):
            tried = np.where(stuck[:, None], other, now.starts)
            fit = self._descend(machine, self.at(machine, (), now.values, tried), TURNS)
            best = best.where(fit.misfits < best.misfits, fit)
        return best.starts if best.misfits[stuck].sum() < FREED * now.misfits[stuck].sum() else None

    def with_past(self, states: Values) -> Shooting:
        """Return the same segments with a run's states (segment, sample, state) as the past of what comes late."""
        return self if self.past is None else replace(self, past=self.segments.put(self.past, states))

    def with_noise(self, noise: Noise) -> Shooting:
        """Return the same segments, divided by other noise."""
        return replace(self, noise=noise)


def _step(now: Fitted, machine: Compiled, damping: Values) -> tuple[Values, Values]:
    """Return (values, starts) one damped Gauss-Newton step on."""
    n = now.starts.shape[1]
    shape, change = now.slopes[..., :n], now.slopes[..., n:]
    values = now.values.copy()
    rest = now.white
    if now.free:
        move = _move(now, damping.max())
        values[[machine.parameters.index(name) for name in now.free]] += move
        rest = rest - change @ move
        values = now.prior.within(values)  # what rounding carries over a bound
    size = np.linalg.norm(shape, axis=1, keepdims=True)
    scaled = shape / np.where(size > 0, size, 1.0)
    normal = np.swapaxes(scaled, 1, 2) @ scaled + damping[:, None, None] * np.eye(n)
    move = np.linalg.solve(normal, np.swapaxes(scaled, 1, 2) @ rest[..., None])[..., 0]
    return values, now.starts + move / np.where(size > 0, size, 1.0)[:, 0]


def _move(now: Fitted, damping: float) -> Values:
    """Return the damped step of the constants (free,); one that would leave its bounds stops there."""
    left, flat = now.stacked
    prior, first = now.prior, len(now.free) - len(now.prior.names)
    at = now.values[prior.places]
    size = np.linalg.norm(flat, axis=0)
    size[size == 0] = 1.0
    flat = flat / size
    move, held = np.zeros(len(now.free)), np.zeros(len(now.free), bool)
    for _ in range(1 + len(prior.names)):
        some = flat[:, ~held]
        normal = some.T @ some + damping * np.eye(some.shape[1])
        rest = left - flat[:, held] @ (move * size)[held]
        move[~held] = np.linalg.lstsq(normal, some.T @ rest, rcond=None)[0] / size[~held]
        reached = np.clip(at + move[first:], prior.low, prior.high)
        beyond = ~held[first:] & (reached != at + move[first:])
        if not beyond.any():
            break
        move[first:][beyond] = (reached - at)[beyond]
        held[first:] |= beyond
    return move
