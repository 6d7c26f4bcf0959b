"""Runs by the engine's own integrator, without and with what was found: a check that rests on no expansion."""

from __future__ import annotations

from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from gaitdisc.engines.engine import Engine, Motion
from gaitdisc.results.discovery import Runs
from gaitdisc.simulation.evaluating import Points, evaluate_many
from gaitdisc.simulation.measured import Measured
from gaitdisc.simulation.simulation import Simulation

MOST_RUNS = 6
TURNS = 4
NUDGE = 1e-4


@dataclass(frozen=True)
class OwnRuns:
    """What runs by the engine itself leave of the record."""

    errors: Mapping[str, tuple[float, float, str]]  # for each channel: root mean square before and after, and its unit
    engine: str  # its name
    share: float  # of the error before, over all channels by their spread, that is left after

    @property
    def said(self) -> str:
        """One sentence."""
        errors = "; ".join(
            f"{name} by {before:.3g} {unit} before and {after:.3g} after"
            for name, (before, after, unit) in self.errors.items()
        )
        return f"run by {self.engine} itself over the held-out runs, the model misses {errors}"


@dataclass(frozen=True)
class _Stretch:
    """Some samples of a trial."""

    trial: int
    first: int
    end: int


def own_runs(
    engines: tuple[Engine, Engine],
    mappings: tuple[Simulation, Simulation],
    measured: Measured,
    runs: Runs,
    states: NDArray[np.float64],
) -> OwnRuns:
    """Run two models over the held-out runs, each from the start that suits it best.

    engines, mappings: the model as read, and with what was found
    runs: Held-out runs, which say where
    states (trial, sample, state): smoothed: where the search for each start begins
    """
    stretches = _stretches(measured, runs)
    both = zip(engines, mappings, strict=True)
    left = [_left(engine, mapping, measured, stretches, states) for engine, mapping in both]
    units = [mappings[0].sensor(name).unit for name in measured.channels]
    rows = zip(*(each.tolist() for each in left), units, strict=True)
    before, after = (np.linalg.norm(each / np.nanstd(measured.observed, axis=(0, 1))) for each in left)
    share = float(after / before) if before else 1.0
    return OwnRuns(dict(zip(measured.channels, rows, strict=True)), engines[0].called, share)


def trial_called(measured: Measured, name: str) -> int:
    """Number of a trial by the name that a search gave it: its own, its number, or that of a part of the only one."""
    if len(measured.trials) == 1:
        return 0
    return measured.trials.index(name) if name in measured.trials else int(name.rsplit(maxsplit=1)[-1]) - 1


def recorded_motion(
    engine: Engine, measured: Measured, states: NDArray[np.float64], trials: Iterable[int]
) -> dict[int, Motion]:
    """Motion of some trials with what the engine computes along it.

    states (trial, sample, state): smoothed
    """
    n, found = len(engine.coordinates), {}
    for trial in trials:
        along, driven = (each[trial, : measured.samples[trial]] for each in (states, measured.drive.inputs))
        found[trial] = engine.along(along[:, :n], along[:, n:], driven, measured.rate)
    return found


def _stretches(measured: Measured, runs: Runs) -> list[_Stretch]:
    found = []
    for run in np.unique(np.linspace(0, len(runs.trial) - 1, MOST_RUNS).round().astype(int)):
        trial = trial_called(measured, runs.names[runs.trial[run]])
        first, last = (round((time - measured.drive.time0[trial]) * measured.rate) for time in runs.time[run, [0, -1]])
        found.append(_Stretch(trial, first, min(last + 1, int(measured.samples[trial]))))
    return found


def _left(
    engine: Engine, mapping: Simulation, measured: Measured, stretches: list[_Stretch], states: NDArray[np.float64]
) -> NDArray[np.float64]:
    """Root mean square of what is left in each channel, starts found by Gauss-Newton."""
    n = len(engine.coordinates)
    recorded = recorded_motion(engine, measured, states, {one.trial for one in stretches})
    size = np.nanstd(measured.observed, axis=(0, 1))
    total, count = 0.0, 0
    for one in stretches:
        controls = measured.drive.inputs[one.trial, one.first : one.end]
        seen = measured.observed[one.trial, one.first : one.end]
        there = np.isfinite(seen)

        def residual(starts: NDArray[np.float64], one: _Stretch = one, controls=controls, seen=seen, there=there):
            known = recorded[one.trial].at(np.full(len(starts), one.first))
            driven = np.repeat(controls[None], len(starts), axis=0)
            run = engine.run(engine.near(known, starts[:, :n], starts[:, n:]), driven, measured.rate)
            t = measured.time(one.trial)[one.first : one.end]
            points = [Points(t, x, controls, rate=measured.rate) for x in run]
            return np.where(there, seen - np.stack([observed(mapping, measured.channels, one) for one in points]), 0.0)

        start = states[one.trial, one.first].copy()
        left = residual(start[None])[0]
        for _ in range(TURNS):
            nudged = residual(start + NUDGE * np.eye(2 * n))
            slopes = ((nudged - left) / NUDGE / size).reshape(2 * n, -1)
            if not np.isfinite(slopes).all():  # a run that leaves every bound has no slopes
                break
            move = np.linalg.lstsq(slopes.T, -(left / size).ravel(), rcond=1e-9)[0]
            tried = residual((start + move)[None])[0]
            gain = ((left / size) ** 2).sum() - ((tried / size) ** 2).sum()
            if not gain > 0:
                break
            start, left = start + move, tried
            if gain < 1e-4 * ((left / size) ** 2).sum():
                break
        total, count = total + (left**2).sum(axis=0), count + there.sum(axis=0)
    return np.sqrt(np.asarray(total) / count)


def observed(mapping: Simulation, channels: Sequence[str], points: Points) -> NDArray[np.float64]:
    """Observed channels (sample, channel) of an engine's run."""
    expressions = [dict(mapping.observations)[name] for name in channels]
    found = evaluate_many(replace(mapping, model=""), expressions, points)
    return np.broadcast_to(found, (len(channels), np.size(points.t))).T
