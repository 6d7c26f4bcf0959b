"""Numbers of what was found, fitted by the engine's own runs: they rest on no expansion."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, replace
from functools import cached_property
from typing import cast

import numpy as np
from numpy.typing import NDArray

from gaitdisc.discovery.candidate_model import CandidateModel, Part
from gaitdisc.discovery.fitted import Fitted
from gaitdisc.discovery.noise import noise_of
from gaitdisc.discovery.scored_model import ScoredModel
from gaitdisc.discovery.segments import cut_segments
from gaitdisc.discovery.shooting import Shooting
from gaitdisc.engines.engine import Engine, Motion
from gaitdisc.engines.own_runs import recorded_motion, trial_called
from gaitdisc.engines.written import WrittenModel, written_model
from gaitdisc.simulation.compiled_simulation import Compiled
from gaitdisc.simulation.drive import Drive, Rows
from gaitdisc.simulation.measured import Measured
from gaitdisc.simulation.simulation import Simulation

TURNS = (1, 4)
NUDGE = 1e-3  # of states and numbers: an adaptive integrator does not resolve less
ENOUGH = 0.1  # of the misfit, a third of a standard error
STARTING = 8  # turns
FOLLOWED = 4.0  # times the noise's variance, which a run leaves at most that follows the record
MOST = 0.8  # of the runs, which are to follow it
SHORTEST = 16  # samples of a run
EXACT = ("missing_physics", "wrong_parameter", "sensor_error")  # verdicts on what a model's own file or a column can be


@dataclass
class EngineFit:
    """A model of an engine and its record, which fit what a search found."""

    mapping: Simulation
    engine: Engine
    measured: Measured  # driven by the controls
    states: NDArray[np.float64]  # (trial, sample, state), smoothed: where fibres and activations are taken from
    done: bool = False  # whether the last answer's numbers are of the engine's own runs

    def refitted(self, found: ScoredModel) -> CandidateModel:
        """Return what was found with numbers, and their covariance, of the engine's own runs.

        As it was where nothing was found, where some of it has no form in the model's file, and where muscles have
        fibres: a run of these takes too long.
        """
        model, self.done = found.model, False
        exact = all(part.candidate.verdict in EXACT and not part.candidate.states for part in model.parts)
        if not model.parts or self.engine.fibres or not exact:
            return model
        runs = _Runs(self, model, found.shooting.measured)
        if runs.written(model.fit.values).absent:
            return model
        shooting = replace(found.shooting, prior=model.fit.prior, nudge=NUDGE)
        machine = cast("Compiled", runs)
        fit = shooting.at(machine, (), model.fit.values, model.fit.starts)
        if not _followed(fit).all():
            fit = shooting.fitted(machine, (), model.fit.values, model.fit.starts, STARTING, 1.0)
        while _followed(fit).mean() < MOST and shooting.segments.span >= 2 * SHORTEST:  # the motion is chaotic
            shooting, starts = _halved(shooting, found)
            fit = shooting.fitted(machine, (), model.fit.values, starts, STARTING, 1.0)
        kept = np.flatnonzero(_followed(fit))
        if not kept.size:
            return model
        shooting, starts = replace(shooting, segments=shooting.segments.among(kept)), fit.starts[kept]
        for turns in TURNS:  # with the noise that the search saw, then with that of these runs
            fit = shooting.fitted(machine, model.fit.free, fit.values, starts, turns, ENOUGH)
            if not np.isfinite(fit.misfit):
                return model
            used, starts = fit.starts.shape[1] / fit.residual.shape[2], fit.starts
            noise = noise_of(fit.residual, used, autocorrelation=shooting.filter_autocorrelation)
            shooting = shooting.with_noise(noise)
        self.done = True
        return replace(model, parts=runs.parts(fit.values), fit=fit)


def _followed(fit: Fitted) -> NDArray[np.bool_]:
    """Which runs (segment,) follow the record."""
    return fit.misfits <= FOLLOWED * fit.white[0].size


def _halved(shooting: Shooting, found: ScoredModel) -> tuple[Shooting, NDArray[np.float64]]:
    """Runs half as long, and where they begin (segment, state): on the runs of the search."""
    segments, samples = shooting.segments, shooting.measured.samples
    trials = tuple(np.unique(segments.trial).tolist())
    shorter = cut_segments(samples, trials, segments.span // 2, segments.margin, segments.every)
    states = found.model.fit.states
    known = np.full((len(samples), int(samples.max()), states.shape[2]), np.nan)
    starts = found.shooting.segments.put(known, states)[shorter.trial, shorter.begin]
    there = np.flatnonzero(np.isfinite(starts).all(axis=1))
    return replace(shooting, segments=shorter.among(there)), starts[there]


class _Runs:
    """Runs of what was found by the engine, in the place of those of its expansion."""

    def __init__(self, given: EngineFit, model: CandidateModel, searched: Measured) -> None:
        self.given, self.model, self.searched = given, model, searched
        self.parameters, self.observe = model.machine.parameters, model.machine.observe
        self._engines: dict[bytes, WrittenModel] = {}

    def parts(self, values: NDArray[np.float64]) -> tuple[Part, ...]:
        """Explanations with numbers of a fit (parameter,)."""
        return tuple(
            replace(part, values={slot: float(values[self.parameters.index(name)]) for slot, name in names.items()})
            for part, names in zip(self.model.parts, self.model.names, strict=True)
        )

    def written(self, values: NDArray[np.float64]) -> WrittenModel:
        """The model's own file with numbers of a fit (parameter,) in it."""
        key = values.tobytes()
        if key not in self._engines:
            mapping = self.given.mapping
            moved = {name: float(values[self.parameters.index(name)]) for name in self.model.fit.prior.names}
            mapping = mapping.with_values(moved)
            for part in self.parts(values):
                mapping = part.candidate.written(mapping, {slot: repr(one) for slot, one in part.values.items()})
            self._engines[key] = written_model(self.given.engine, mapping)
        return self._engines[key]

    @cached_property
    def recorded(self) -> Mapping[int, Motion]:
        """The motion of each trial of the search, by its number in the record."""
        trials = {trial_called(self.given.measured, name) for name in self.searched.trials}
        return recorded_motion(self.given.engine, self.given.measured, self.given.states, trials)

    def run(
        self, drive: Drive, rows: Rows, steps: int, *, substeps: int, past: NDArray[np.float64] | None
    ) -> tuple[NDArray[np.float64], NDArray[np.bool_]]:
        """As of a simulation that is compiled; the engine takes its own steps, and nothing in it comes late."""
        del substeps, past
        measured, n = self.given.measured, len(self.given.engine.coordinates)
        values = np.broadcast_to(
            self.model.machine.defaults if rows.values is None else rows.values,
            (len(rows.trial), len(self.parameters)),
        )
        found = np.full((len(rows.trial), steps + 1, 2 * n), np.nan)
        _, version = np.unique(values, axis=0, return_inverse=True)
        for one in range(version.max() + 1):
            some = np.flatnonzero(version.ravel() == one)
            engine = self.written(np.ascontiguousarray(values[some[0]])).engine
            begun = []
            controls = np.empty((len(some), steps + 1, len(engine.controls)))
            for place, row in enumerate(some):
                trial = trial_called(measured, self.searched.trials[rows.trial[row]])
                later = drive.time0[rows.trial[row]] - measured.drive.time0[trial]
                first = round(later * drive.rate) + int(rows.begin[row])
                begun.append((trial, first))
                controls[place] = measured.drive.inputs[trial, first : first + steps + 1]
            start = _joined([self.recorded[trial].at(np.array([first])) for trial, first in begun])
            q, v = rows.starts[some, :n], rows.starts[some, n:]
            found[some] = engine.run(engine.near(start, q, v), controls, drive.rate)
        return found, np.asarray(np.isfinite(found).all(axis=(1, 2)))


def _joined(motions: list[Motion]) -> Motion:
    """Points of several motions as those of one."""
    q, v, u = (np.concatenate([getattr(one, field) for one in motions]) for field in ("q", "v", "u"))
    return Motion(q, v, u)
