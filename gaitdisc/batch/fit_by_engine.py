"""Numbers of what was found, fitted by the engine's own runs: they rest on no expansion."""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from gaitdisc.batch.joint_and_trials import lagged
from gaitdisc.discovery.candidate import SIGNAL_ERRORS
from gaitdisc.discovery.candidate_model import CandidateModel, Part
from gaitdisc.discovery.criteria import CRITERIA
from gaitdisc.discovery.estimates import named_estimates
from gaitdisc.discovery.paired_test import sum_error
from gaitdisc.discovery.scored_model import ScoredModel
from gaitdisc.engines.engine import Engine
from gaitdisc.engines.mapping import replaced_inputs, with_input_changed
from gaitdisc.engines.own_runs import Driven, OwnRuns, Start, left_by
from gaitdisc.engines.written import WrittenModel, written_model
from gaitdisc.results.discovery import Discovery
from gaitdisc.simulation.expression import names, parsed
from gaitdisc.simulation.measured import Measured
from gaitdisc.simulation.simulation import Simulation

TURNS = 3
STEP = 0.01  # of a number, for its slope: over less, runs that meet limits or friction do not change smoothly
ENOUGH = 0.1  # of the misfit, a third of a standard error


@dataclass
class EngineFit:
    """A model of an engine and its record, and what a search of its expansion found."""

    mapping: Simulation
    engine: Engine
    measured: Measured  # driven by the controls
    states: NDArray[np.float64]  # (trial, sample, state), smoothed: where starts and fibres are taken from
    parts: tuple[Part, ...] = ()  # of what was found

    def noted(self, found: ScoredModel) -> CandidateModel:
        """Return what was found as it is, once its parts are kept."""
        self.parts = found.model.parts
        return found.model

    def in_mapping(self, found: Discovery, parts: tuple[Part, ...]) -> Simulation:
        """What was found, in the model's mapping; with the states that effects bring along behind the model's own."""
        changed = self.mapping.with_values({one.parameter: one.found.value for one in found.corrections})
        for part in parts:
            one, numbers = part.candidate, {slot: repr(value) for slot, value in part.values.items()}
            form = SIGNAL_ERRORS[one.name][2] if one.verdict == "input_error" else ""
            if form:
                changed = with_input_changed(changed, one.place, form.format(s=one.place, **numbers))
            elif one.verdict != "input_error":
                changed = one.written(changed, numbers)
        starts = {one.place: one.estimates["initial"].value for one in found.effects if one.kind == "state"}
        return changed.with_starts(starts)

    def written(self, found: Discovery, parts: tuple[Part, ...]) -> tuple[Simulation, WrittenModel, Driven]:
        """Return the mapping with what was found, the model with it, and that as the engine runs it."""
        whole, data = self.in_mapping(found, parts), self.measured
        written, own = written_model(self.engine, whole), {one.name for one in whole.states[len(self.mapping.states) :]}
        kept = tuple(one for one in whole.effects if not own & set(names(parsed(one.term))))
        augmented = replace(whole, states=self.mapping.states, equations=self.mapping.equations, effects=kept)
        controls, lags, called = data.drive.inputs.copy(), {}, [one.name for one in self.engine.controls]
        for trial, samples in enumerate(data.samples):
            time, u = data.time(trial)[:samples], data.drive.inputs[trial, :samples]
            controls[trial, :samples] = replaced_inputs(augmented, time, u, data.rate)
        for part in parts:
            if part.candidate.name == "input_lag":
                column = called.index(part.candidate.place)
                lags[column] = seconds = max(part.values["seconds"], 0.1 / data.rate)
                controls[:, :, column] = lagged(controls[:, :, column], seconds * data.rate)
                lag = f"{part.candidate.place}, behind a first-order lag of {seconds:.4g} s, has no form in a mapping: "
                written = replace(written, notes=(*written.notes, f"{lag}it stands in discovery.json alone"))
        return augmented, written, Driven(written.engine, augmented, controls, lags)

    def left(
        self, found: Discovery, parts: tuple[Part, ...], runs: OwnRuns, near: dict[int, Start] | None = None
    ) -> NDArray[np.float64]:
        """Measured minus the engine's runs (run, sample, channel) with some of what was found."""
        return left_by(self.written(found, parts)[2], self.measured, runs.at, self.states, near)

    def fitted(self, found: Discovery, base: Simulation, runs: OwnRuns) -> Discovery:
        """Return what was found with numbers of the engine's own runs, whose starts follow them (Gauss-Newton).

        base: says what the numbers are
        runs: of what was learned from
        """
        slots = [(number, slot) for number, part in enumerate(self.parts) for slot in part.candidate.slots]
        values = np.array([self.parts[number].values[slot] for number, slot in slots])

        def parts_at(values: NDArray[np.float64]) -> tuple[Part, ...]:
            each = dict(zip(slots, values.tolist(), strict=True))
            of_part = ({slot: each[number, slot] for slot in one.values} for number, one in enumerate(self.parts))
            return tuple(replace(one, values=own) for one, own in zip(self.parts, of_part, strict=True))

        def white(values: NDArray[np.float64], near: dict[int, Start]) -> NDArray[np.float64]:
            left = self.left(found, parts_at(values), runs, near) / runs.floor
            return np.nan_to_num(left, posinf=1e6, neginf=-1e6).ravel()

        near: dict[int, Start] = {}
        now, slopes = white(values, near), np.zeros((0, len(slots)))
        for _ in range(TURNS):
            steps = STEP * np.maximum(np.abs(values), STEP) * np.eye(len(slots))
            slopes = np.column_stack([(white(values + step, near.copy()) - now) / step.sum() for step in steps])
            moved = values + np.asarray(np.linalg.lstsq(slopes, -now, rcond=None)[0], np.float64)
            ahead = near.copy()
            tried = white(moved, ahead)
            gained = float(now @ now - tried @ tried)
            if gained > 0:
                values, now, near = moved, tried, ahead
            if gained < ENOUGH:
                break
        self.parts = parts_at(values)
        left = np.where(np.isfinite(runs.before), now.reshape(runs.before.shape), np.nan)
        influence = np.linalg.pinv(slopes).reshape(len(slots), *left.shape)  # of each sample on each number
        covariance = np.diag([sum_error(one, left) ** 2 for one in influence])
        effects = []
        for number, (one, part) in enumerate(zip(found.effects, self.parts, strict=True)):
            own = [k for k, (other, _) in enumerate(slots) if other == number]
            numbers, idle = named_estimates(part, covariance[np.ix_(own, own)], base), part.candidate.idle
            away = [abs(values[k] - idle[slots[k][1]]) for k in own if slots[k][1] in idle]
            sure = [CRITERIA.certain * np.sqrt(covariance[k, k]) for k in own if slots[k][1] in idle]
            effects.append(replace(one, term=part.term, estimates=numbers, small=bool(np.less(away, sure).all())))
        return replace(found, effects=tuple(effects))
