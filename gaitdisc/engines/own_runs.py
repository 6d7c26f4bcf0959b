"""Runs by the engine's own integrator, without and with what was found: a check that rests on no expansion."""

from __future__ import annotations

import time
from collections.abc import Callable, Mapping
from dataclasses import dataclass, field, replace

import numpy as np
from numpy.typing import NDArray

from gaitdisc.engines.engine import Engine
from gaitdisc.engines.expansion import compute_motion
from gaitdisc.engines.motion import Values
from gaitdisc.recording.arrays import root_mean_square
from gaitdisc.simulation.evaluating import Points, evaluate_many
from gaitdisc.simulation.measured import Measured
from gaitdisc.simulation.simulation import Simulation

MOST_RUNS, FEWER = 24, 6  # fewer where muscles have fibres
PERIODS = 2.0  # of a run: over 4 s with limits or contacts 2 of 4 perfect models had a start that is not the best
SHARES = (0.125, 0.35, 1.0)  # of a run, to which its start is fitted one after the other
SHORT, COVERED = 6, 0.95  # margins in a trial, at least; share of what runs can cover that they do
TURNS = 6
SILENT_S = 10.0  # without progress, after which the number of finished runs is reported
NUDGE = 1e-4
MERE_NOISE = 1.3  # times the variance of the sensors' noise: its own estimate errs
WINDOWS = 10  # in a period: what is missing bends a run more slowly
CHANCE = 0.05  # of runs of a perfect model that are not taken for mere noise, and searched


@dataclass(frozen=True)
class Driven:
    """A model of an engine, the controls that drive it and the lags in these."""

    engine: Engine
    mapping: Simulation
    controls: Values  # (trial, sample, control)
    forces: Values | None = None  # (trial, sample, coordinate), besides
    lags: Mapping[int, float] = field(default_factory=dict)  # control: time constant [s] of the lag in these
    # channels, samples along an axis, as the record's filter leaves them
    recorded: Callable[[Values, int], Values] = field(default_factory=lambda: lambda simulated, _: simulated)
    progress: Callable[[str], None] = field(default_factory=lambda: lambda _: None)


@dataclass(frozen=True)
class Stretches:
    """Parts of trials, equally long; no sample is compared in two of them."""

    trial: NDArray[np.intp]  # (run,), and the first sample of each
    first: NDArray[np.intp]
    length: int
    period: float  # of the motion [samples]
    margin: int = 0  # samples at either end that are not compared, as a filter does not know what is beyond

    def among(self, some: NDArray[np.bool_]) -> Stretches:
        """Return some of them (run,)."""
        return replace(self, trial=self.trial[some], first=self.first[some])


@dataclass(frozen=True)
class OwnRuns:
    """What runs by the engine itself leave of the record: measured minus run, without and with what was found."""

    before: Values  # (run, sample, channel) [the channel's unit], NaN where nothing was measured
    after: Values
    at: Stretches
    engine: str  # its name
    units: Mapping[str, str]  # of the channels
    floor: Values  # (channel,), standard deviation of the noise
    starts: Values  # (run, state), as fitted
    every: int = 1  # samples between those that hold all that the record's filter passes
    memory: Values | None = None  # (lag, channel), autocorrelation of its noise between these; white where absent

    def among(self, some: NDArray[np.bool_]) -> OwnRuns:
        """Return some of them (run,)."""
        each = {name: getattr(self, name)[some] for name in ("before", "after", "starts")}
        return replace(self, at=self.at.among(some), **each)

    @property
    def leave_mere_noise(self) -> bool:
        """Whether runs of the model as read leave noise of the sensors' size, white before the record's filter.

        Means of windows vary no more than the spread within them says (F test): what is missing bends whole windows.
        """
        from scipy.stats import f as variance_ratio

        between, within, (outer, inner) = self.variances(self.before / self.floor)
        known = np.isfinite(between)
        if not known.any() or np.isinf(self.before).any():
            return False
        free, size = max(known.sum() - self.starts.size, 1), within[known].mean()
        over = between[known].sum() / free / size
        return bool(size < MERE_NOISE and variance_ratio.sf(over, free * outer, known.sum() * inner) > CHANCE)

    def variances(self, left: Values) -> tuple[Values, Values, tuple[float, float]]:
        """Variance of the noise by each window's mean and by its spread (run, window, channel), and their freedom."""
        size = max(round(self.at.period / self.every / WINDOWS), 3)
        some = left[:, :: self.every]
        parts = some[:, : some.shape[1] // size * size].reshape(len(left), -1, size, left.shape[2])
        share, free = np.array(1 / size), (1.0, size - 1.0)  # of the variance, in the means
        if self.memory is not None:  # not independent: Satterthwaite 1946, Biometrics Bulletin 2, 110
            at, windows = np.arange(parts.shape[1] * size).reshape(-1, size), parts.shape[1]
            alike = self.memory[np.abs(np.subtract.outer(at, at))]
            outer, inner = alike.mean(axis=(1, 3)), alike - alike.mean(axis=1, keepdims=True)
            inner, share = inner - inner.mean(axis=3, keepdims=True), outer[0, 0]
            between = ((outer / share) ** 2).sum(axis=(0, 1)).mean()
            within = ((inner / (size - size * share)) ** 2).sum(axis=(0, 1, 2, 3)).mean()
            free = windows / float(between), windows / float(within)
        return parts.mean(axis=2) ** 2 / share, parts.var(axis=2) / (1 - share), free

    @property
    def before_at_noise(self) -> bool:
        """Whether runs of the model as read leave no more than the noise in any channel."""
        return bool((root_mean_square(self.before) < np.sqrt(MERE_NOISE) * self.floor).all())

    def with_floor(self, hidden: list[float]) -> OwnRuns:
        """Return runs with the noise that a search saw (channel,), where these do not leave less."""
        within = np.inf if self.memory is None else np.sqrt(np.nanmean(self.variances(self.after)[1], axis=(0, 1)))
        return replace(self, floor=np.fmax(np.fmin(self.floor, within), np.fmin(hidden, root_mean_square(self.after))))

    @property
    def sentence(self) -> str:
        """One sentence."""
        sizes = zip(self.units.items(), *map(root_mean_square, (self.before, self.after)), strict=True)
        errors = "; ".join(f"{name} {old:.3g} and {new:.3g} {unit}" for (name, unit), old, new in sizes)
        return f"rms errors without and with the effects, in {len(self.before)} runs by {self.engine}: {errors}"


def spread_stretches(measured: Measured, period: float, fewer: bool = False, margin: int = 0) -> Stretches:
    """Runs of two periods at most, spread over every trial: side by side, so that noise counts once."""
    margin = min(margin, int(measured.samples.min()) // SHORT)
    inner = measured.samples - 2 * margin
    longest = min(max(round(PERIODS * period), 16), int(inner.min()))
    lengths = np.arange(longest, longest // 2, -1)
    covered = (inner[:, None] // lengths * lengths).sum(axis=0)
    length = int(lengths[np.argmax(covered > COVERED * covered.max())])
    every = [(k, at) for k, n in enumerate(inner) for at in np.linspace(0, n - length, n // length).astype(int)]
    some = np.unique(np.linspace(0, len(every) - 1, FEWER if fewer else MOST_RUNS).round().astype(int))
    trial, first = np.array(every)[some].T
    return Stretches(trial, first, length + 2 * margin, period, margin)


def cut_stretches(
    model: Driven, measured: Measured, states: Values, period: float, margin: int, factor: float, most: float = np.inf
) -> Stretches:
    """Runs so short that a small change of the start grows by a factor in a fifth of them at most; these are left out.

    Source: Voss, Timmer & Kurths 2004, Int J Bifurcation Chaos 14, 1905: beyond, the misfit has many minima.
    """
    engine, ends = model.engine, list[float]()  # where each run's change has grown so much
    at = spread_stretches(measured, min(period, (most - 2 * margin) / PERIODS), engine.fibres, margin)
    if engine.fibres:  # whose runs take long
        return at
    steps = NUDGE * np.maximum(states.std(axis=(0, 1)), NUDGE)
    changes = np.vstack([np.zeros(len(steps)), np.diag(steps)])
    recorded = {trial: compute_motion(engine, measured.drive, states, trial) for trial in np.unique(at.trial)}
    for trial, first in zip(at.trial, at.first, strict=True):
        motion = recorded[trial].at(np.full(len(changes), first))
        start = engine.near(motion, *np.split(states[trial, first] + changes, 2, axis=1))
        driven = np.repeat(model.controls[None, trial, first : first + at.length], len(changes), axis=0)
        run = engine.run(start, driven, measured.rate)
        grown = np.nan_to_num((run[1:] - run[0]) / steps, nan=1e9, posinf=1e9, neginf=1e9)
        beyond = np.flatnonzero(np.linalg.norm(grown, 2, axis=(0, 2)) > factor)
        ends.append(float(beyond[0]) if beyond.size else np.inf)
    if (end := sorted(ends)[len(ends) // 5]) < most:
        return cut_stretches(model, measured, states, period, margin, factor, end)
    return replace(at.among(np.array(ends) == np.inf), period=period)


def trial_called(measured: Measured, name: str) -> int:
    """Number of a trial by the name that a search gave it: its own, its number, or that of a part of the only one."""
    if len(measured.trials) == 1:
        return 0
    return measured.trials.index(name) if name in measured.trials else int(name.rsplit(maxsplit=1)[-1]) - 1


def residual_by(
    model: Driven, measured: Measured, at: Stretches, states: Values, near: dict[int, Values] | None = None
) -> Values:
    """Measured minus run (run, sample, channel), starts and hidden states found by Gauss-Newton.

    states (trial, sample, state): smoothed: where the search for each start begins
    near: run -> the start (state,) of a model that is hardly another, where it begins then; these are put in
    """
    engine, n, lags = model.engine, len(model.engine.coordinates), model.lags
    drive = replace(measured.drive, inputs=model.controls)
    recorded = {trial: compute_motion(engine, drive, states, trial) for trial in np.unique(at.trial)}
    plain, expressions = replace(model.mapping, model=""), dict(model.mapping.observations)
    seen_as = [expressions[name] for name in measured.channels]
    size, reported = np.nanstd(measured.observed, axis=(0, 1)), time.monotonic()
    n_hidden = len(lags) + (len(engine.pushes.machine.states) - 2 * n if engine.pushes else 0)
    reach = np.append(np.nanmax(states, axis=(0, 1)) - np.nanmin(states, axis=(0, 1)), np.full(n_hidden, np.inf))
    residual = np.full((len(at.trial), at.length, len(size)), np.nan)
    for row, (trial, first) in enumerate(zip(at.trial, at.first, strict=True)):
        if time.monotonic() - reported > SILENT_S:
            model.progress(f"{row} of {len(at.trial)} runs by {engine.called} done")
            reported = time.monotonic()

        def left_from(starts: Values, samples: int, trial: int = trial, first: int = first):
            some = slice(first, first + samples)
            driven = np.repeat(model.controls[None, trial, some], len(starts), axis=0)
            for hidden, (control, seconds) in zip(starts.T[2 * n :], lags.items(), strict=False):
                driven[:, :, control] += hidden[:, None] * np.exp(-np.arange(samples) / (measured.rate * seconds))
            known = engine.near(recorded[trial].at(np.full(len(starts), first)), starts[:, :n], starts[:, n : 2 * n])
            t, seen = measured.time(trial)[some], measured.observed[trial, some]
            begun = replace(known, own=starts[:, 2 * n + len(lags) :], t=np.full(len(starts), t[0]))
            push = None if model.forces is None else np.repeat(model.forces[None, trial, some], len(starts), axis=0)
            run = engine.run(begun, driven, measured.rate, push)
            points = [Points(t, x, u, rate=measured.rate) for x, u in zip(run, driven, strict=True)]
            simulated = np.stack([evaluate_many(plain, seen_as, run_points).T for run_points in points])
            if samples < at.length:
                return (seen - simulated) / size
            left = (seen - model.recorded(simulated, 1)) / size
            left[:, : at.margin], left[:, samples - at.margin :] = np.nan, np.nan
            return left

        known, left = near.get(row) if near else None, residual[row]
        start = np.append(states[trial, first], np.zeros(n_hidden)) if known is None else known
        for share in SHARES if known is None else SHARES[-1:]:
            samples = max(int(share * at.length), min(16, at.length))
            start, left = _find_start(lambda starts, samples=samples: left_from(starts, samples), start, reach)
        residual[row] = left * size
        if near is not None:
            near[row] = start
    return residual


def _find_start(left_from: Callable[[Values], Values], start: Values, reach: Values) -> tuple[Values, Values]:
    """Start that suits a run best, and what it leaves; slopes are mended by each step (Broyden) while that gains.

    reach (state,): of the record; a run that begins farther off says nothing, and muscles may take minutes for it
    """
    left, slopes, computed = left_from(start[None])[0], None, False
    there = np.isfinite(left)
    for _ in range(TURNS):
        if slopes is None:
            slopes, computed = ((left_from(start + NUDGE * np.eye(len(start))) - left) / NUDGE)[:, there], True
        if not np.isfinite(slopes).all():  # a run that leaves every bound has no slopes
            break
        u, size, turned = np.linalg.svd(slopes.T, full_matrices=False)
        gain = -1.0
        # share of a step; damping by the greatest slope
        for share, damped in ((1.0, 1e-9), (0.3, 1e-9), (1.0, 1e-3), (1.0, 0.1)):
            step = share * (u.T @ -left[there] * size / (size**2 + (damped * size.max(initial=NUDGE)) ** 2)) @ turned
            if (np.abs(step) > reach).any():
                continue
            tried = left_from((start + step)[None])[0]
            gain = (left[there] ** 2).sum() - (tried[there] ** 2).sum()
            if gain > 0:
                break
        if not gain > 0:
            if computed:
                break
            slopes = None
            continue
        slopes, computed = slopes + np.outer(step, (tried - left)[there] - step @ slopes) / (step @ step), False
        start, left = start + step, tried
        if gain < 1e-4 * (left[there] ** 2).sum():
            break
    return start, left
