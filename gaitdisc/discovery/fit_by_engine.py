"""What an engine's own runs say of what was found, its numbers fitted by them: neither rests on an expansion."""

from collections.abc import Callable
from dataclasses import dataclass, field, replace

import numpy as np
from numpy.typing import NDArray

from gaitdisc.discovery.criteria import CRITERIA
from gaitdisc.discovery.estimated_filter import find_record_filter, note_other
from gaitdisc.discovery.estimates import name_estimates
from gaitdisc.discovery.grids import find_rhythm
from gaitdisc.discovery.joint_and_trials import lag_signal
from gaitdisc.discovery.kept_work import keep, recall
from gaitdisc.discovery.noise import sensor_noise
from gaitdisc.discovery.paired_test import compare_errors, sum_error
from gaitdisc.discovery.record_filter import RecordFilter
from gaitdisc.discovery.result import Discovery, Runs
from gaitdisc.discovery.scored_model import Part, ScoredModel
from gaitdisc.discovery.wording import write_sentence
from gaitdisc.engines.engine import Engine
from gaitdisc.engines.mapping import replace_inputs, with_input_changed, with_strength
from gaitdisc.engines.motion import Values
from gaitdisc.engines.own_runs import MERE_NOISE, Driven, OwnRuns, cut_stretches, residual_by, trial_called
from gaitdisc.engines.written import WrittenModel, forces_at, write_model
from gaitdisc.processing.kept_parts import hash_content
from gaitdisc.recording import Finding
from gaitdisc.recording.arrays import root_mean_square
from gaitdisc.simulation.evaluating import Points
from gaitdisc.simulation.expression import names, parse
from gaitdisc.simulation.measured import Measured
from gaitdisc.simulation.simulation import Simulation
from gaitdisc.words import counted

TURNS = 3
STEP = 0.01  # of a number, for its slope: over less, runs that meet limits or friction do not change smoothly
ENOUGH = 0.1  # of the misfit, a third of a standard error
DRAWN = 4  # runs of a picture
NO_FILTER = RecordFilter((), 1.0)


@dataclass
class EngineFit:
    """A model of an engine and its record, and what a search of its expansion found."""

    mapping: Simulation
    engine: Engine
    measured: Measured  # driven by the controls
    states: Values  # (trial, sample, state), smoothed: where starts and fibres are taken from
    parts: tuple[Part, ...] = ()  # of what was found
    low_pass: RecordFilter = NO_FILTER  # that the record went through, as the search has it
    progress: Callable[[str], None] = field(default_factory=lambda: lambda _: None)
    native: bool = True  # whether what was found is written into the model, or acts beside it at each step

    def noted(self, scored: ScoredModel) -> ScoredModel:
        """Return what was found as it is, once its parts and the record's filter are kept."""
        self.parts, self.low_pass = scored.parts, scored.shooting.record_filter or NO_FILTER
        return scored

    def in_mapping(self, discovery: Discovery, parts: tuple[Part, ...]) -> Simulation:
        """What was found, in the model's mapping; with the states that effects bring along behind the model's own."""
        changed = self.mapping.with_values({row.parameter: row.found.value for row in discovery.corrections})
        for part in parts:
            candidate, numbers = part.candidate, {slot: repr(value) for slot, value in part.values.items()}
            form = candidate.form if candidate.verdict == "input_error" else ""
            if candidate.name == "input_gain":
                changed = with_strength(changed, self.engine, candidate.place, part.values["gain"])
            elif form:
                changed = with_input_changed(changed, candidate.place, form.format(s=candidate.place, **numbers))
            elif candidate.verdict != "input_error":
                changed = candidate.written(changed, numbers)
        starts = {
            effect.place: effect.estimates["initial"].value for effect in discovery.effects if effect.kind == "state"
        }
        return changed.with_starts(starts)

    def written(self, discovery: Discovery, parts: tuple[Part, ...]) -> tuple[Simulation, WrittenModel, Driven]:
        """Return the mapping with what was found, the model with it, and that as the engine runs it."""
        whole, data = self.in_mapping(discovery, parts), self.measured
        written = write_model(self.engine, whole, self.native)
        added = {state.name for state in whole.states[len(self.mapping.states) :]}
        kept = tuple(effect for effect in whole.effects if not added & set(names(parse(effect.term))))
        augmented = replace(whole, states=self.mapping.states, equations=self.mapping.equations, effects=kept)
        controls, lags, called = data.drive.inputs.copy(), {}, [control.name for control in self.engine.controls]
        driving = replace(augmented, definitions=written.definitions)
        forces = np.zeros((*controls.shape[:2], len(self.engine.coordinates))) if written.along else None
        for trial, samples in enumerate(data.samples):
            time, u = data.time(trial)[:samples], data.drive.inputs[trial, :samples]
            controls[trial, :samples] = replace_inputs(driving, time, u, data.rate)
            if forces is not None:
                at = Points(time, self.states[trial, :samples], u, rate=data.rate)
                forces[trial, :samples] = forces_at(self.engine, augmented, written.along, at)
        for part in parts:
            if part.candidate.name == "input_lag":
                column = called.index(part.candidate.place)
                lags[column] = seconds = max(part.values["seconds"], 0.1 / data.rate)
                controls[:, :, column] = lag_signal(controls[:, :, column], seconds * data.rate)
                lag = f"a first-order lag of {part.candidate.place} ({seconds:.4g} s) cannot be written to a mapping: "
                written = replace(written, notes=(*written.notes, f"{lag}only discovery.json contains it"))
        recorded = self.low_pass.filtered
        driven = Driven(written.engine, augmented, controls, forces, lags, recorded=recorded, progress=self.progress)
        return augmented, written, driven

    def left(
        self, discovery: Discovery, parts: tuple[Part, ...], runs: OwnRuns, near: dict[int, Values] | None = None
    ) -> Values:
        """Measured minus the engine's runs (run, sample, channel) with some of what was found."""
        known = recall(repr([part.values for part in parts]))
        if known is None:
            left = residual_by(self.written(discovery, parts)[2], self.measured, runs.at, self.states, near)
            keep((left.tolist(), {row: start.tolist() for row, start in (near or {}).items()}))
            return left
        if near is not None:
            near.update((int(row), np.array(start)) for row, start in known[1].items())
        return np.array(known[0])

    def compared(self, discovery: Discovery, runs: OwnRuns) -> tuple[Simulation, WrittenModel]:
        """Return mapping and model with what was found, and how far its held-out runs are from those by hand."""
        both = [replace(self, native=native).written(discovery, self.parts) for native in (True, False)]
        (augmented, written, _), plain = both[0], both[1][1]
        if plain.absent or plain.along or plain.text == written.text:
            return augmented, written
        held, near = held_out(discovery, runs, self.measured), dict[int, Values]()
        at = runs.among(held if held.any() else ~held).at
        left = [residual_by(driven, self.measured, at, self.states, near) for *_, driven in both]
        sizes = zip(runs.units.items(), root_mean_square(left[0] - left[1]), strict=True)
        differences = ", ".join(f"{name} by {size:.1g} {unit}" for (name, unit), size in sizes)
        compared = f"{written.notes[-1]}; held-out runs differ from those of the expression: {differences}"
        return augmented, replace(written, notes=(*written.notes[:-1], compared))

    def fitted(self, discovery: Discovery, base: Simulation, runs: OwnRuns) -> Discovery:
        """Return what was found with numbers of the engine's learned runs, whose starts follow them (Gauss-Newton)."""
        slots = [(number, slot) for number, part in enumerate(self.parts) for slot in part.candidate.slots]
        values = np.array([self.parts[number].values[slot] for number, slot in slots])

        def parts_at(values: Values) -> tuple[Part, ...]:
            each = dict(zip(slots, values.tolist(), strict=True))
            of_part = ({slot: each[number, slot] for slot in part.values} for number, part in enumerate(self.parts))
            return tuple(replace(part, values=numbers) for part, numbers in zip(self.parts, of_part, strict=True))

        def white(values: Values, near: dict[int, Values]) -> Values:
            left = self.left(discovery, parts_at(values), runs, near) / runs.floor
            return np.nan_to_num(left, posinf=1e6, neginf=-1e6).ravel()

        near: dict[int, Values] = {}
        now, slopes = white(values, near), np.zeros((0, len(slots)))
        turns = 1 if self.engine.fibres else TURNS  # runs with fibres take long
        for turn in range(turns):
            self.progress(f"fitting {counted(len(slots), 'value')} by engine runs, round {turn + 1} of at most {turns}")
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
        covariance = np.diag([sum_error(sensitivity, left) ** 2 for sensitivity in influence])
        effects = []
        for number, (effect, part) in enumerate(zip(discovery.effects, self.parts, strict=True)):
            places = [k for k, (other, _) in enumerate(slots) if other == number]
            numbers, idle = name_estimates(part, covariance[np.ix_(places, places)], base), part.candidate.idle
            away = [abs(values[k] - idle[slots[k][1]]) for k in places if slots[k][1] in idle]
            sure = [CRITERIA.certain * np.sqrt(covariance[k, k]) for k in places if slots[k][1] in idle]
            effects.append(replace(effect, term=part.term, estimates=numbers, small=bool(np.less(away, sure).all())))
        return replace(discovery, effects=tuple(effects))


def errs_less(runs: OwnRuns, without: Values, held: NDArray[np.bool_]) -> bool:
    """Whether runs without some of the answer (run, sample, channel) miss more by no chance, and held (run,) ones."""
    both = [each[:, :: runs.every] for each in (without, runs.after)]  # of filtered noise, more say no more
    test = compare_errors(both[0], both[1], runs.floor)
    before, after = (np.nansum((each[held] / runs.floor) ** 2) for each in both)
    return bool(test.bears_out and test.fall > CRITERIA.margin and after <= before)


def base_runs(engine: Engine, fit: EngineFit) -> OwnRuns:
    """Run a model as read along every trial."""
    mapping, data = fit.mapping, fit.measured
    given = hash_content((mapping, data, data.drive, fit.low_pass), engine.path.read_text(encoding="utf-8"))
    driven = Driven(engine, mapping, data.drive.inputs, recorded=fit.low_pass.filtered, progress=fit.progress)
    left, starts, period = [], [], find_rhythm(data.observed, data.rate).samples
    at = cut_stretches(driven, data, fit.states, period, fit.low_pass.margin, CRITERIA.chaotic)
    for trial in np.unique(at.trial):  # each is kept as it ends
        known = recall(given, str(trial))
        if known is None:
            near: dict[int, Values] = {}
            residual = residual_by(driven, data, at.among(at.trial == trial), fit.states, near)
            keep(known := [residual.tolist(), [near[row].tolist() for row in range(len(residual))]])
        left, starts = left + known[0], starts + known[1]
    units, whole = {name: mapping.sensor(name).unit for name in data.channels}, np.array(left)
    return with_noise(OwnRuns(whole, whole, at, engine.called, units, np.zeros(0), np.array(starts)), fit)


def with_noise(runs: OwnRuns, fit: EngineFit) -> OwnRuns:
    """Return runs with the size of the noise that a sensor states, or that the record or the runs show."""
    data, passed = fit.measured, fit.low_pass
    given = np.array([fit.mapping.sensor(name).sd or np.nan for name in data.channels], float)
    runs = replace(runs, floor=sensor_noise(data.observed))
    if passed.margin:  # a filter hides the size of the noise: what is within windows shows it
        runs = replace(runs, every=passed.every, memory=passed.autocorrelation(runs.at.length))
        hidden = passed.at_most_noise(np.sqrt(np.nanmean(runs.variances(runs.before)[1], axis=(0, 1))))
        runs = replace(runs, floor=np.where([cutoff is None for cutoff in passed.cutoffs_hz], runs.floor, hidden))
        given = given * passed.gains
    return replace(runs, floor=np.where(np.isnan(given), runs.floor, given))


def at_other_cutoffs(
    engine: Engine, fit: EngineFit, runs: OwnRuns, clean: Measured, period: float
) -> tuple[OwnRuns, EngineFit, tuple[Finding, ...]] | None:
    """Runs that leave mere noise at a cut-off found beside the model's own runs, or within the error of that one.

    A test holds at every value of a number that is not known, or not at all (Berger & Boos 1994, J Am Stat Assoc 89).
    """
    at, data, stated = runs.at, fit.measured, [fit.mapping.sensor(name).lowpass for name in clean.channels]
    if None not in stated or np.isinf(runs.before).any():
        return None
    seen = data.observed[at.trial[:, None], at.first[:, None] + np.arange(at.length)]
    model, near = Driven(engine, fit.mapping, data.drive.inputs, progress=fit.progress), dict(enumerate(runs.starts))
    simulated = seen - (residual_by(model, data, replace(at, margin=0), fit.states, near) if at.margin else runs.before)
    again, noted = find_record_filter(fit.mapping, clean, period, like=simulated)
    if again.margin and not fit.low_pass.margin:  # none was seen before, so that runs left no room at their ends
        fit = replace(fit, low_pass=again)
        runs = base_runs(engine, fit)
        return (runs, fit, noted) if runs.leave_mere_noise else at_other_cutoffs(engine, fit, runs, clean, period)
    for other in (again, *again.within_error(stated)) if again.margin else ():
        left, fit = seen - other.filtered(simulated, 1), replace(fit, low_pass=other)
        left[:, : at.margin], left[:, at.length - at.margin :] = np.nan, np.nan
        # noise is in the record alone: at the true cut-off no more is left than at another
        if not np.mean((root_mean_square(left) / root_mean_square(runs.before)) ** 2) < MERE_NOISE:
            continue
        if (tried := with_noise(replace(runs, before=left, after=left), fit)).leave_mere_noise:
            return tried, fit, noted if other == again else (*noted, note_other(other, clean.source))
    return None


def held_out(discovery: Discovery, runs: OwnRuns, data: Measured) -> NDArray[np.bool_]:
    """Which of the engine's runs (run,) the search held out."""
    drawn = zip(discovery.runs.trial, discovery.runs.time[:, 0], strict=True) if discovery.runs.time.size else ()
    begun = {trial_called(data, discovery.runs.names[k]): time for k, time in reversed([*drawn])}
    times = data.drive.time0[runs.at.trial] + (runs.at.first + runs.at.margin + 1) / data.rate
    return np.array([time > begun.get(trial, np.inf) for trial, time in zip(runs.at.trial, times, strict=True)])


def with_own_runs(discovery: Discovery, runs: OwnRuns, fit: EngineFit, base: Simulation) -> Discovery:
    """Return the answer with errors and shares of the engine's own runs, held out as the search did."""
    at, data, sizes = runs.at, fit.measured, []
    spread, times = np.nanstd(data.observed, axis=(0, 1)), data.drive.time0[at.trial] + at.first / data.rate
    held = held_out(discovery, runs, data)
    for some, size in ((~held, discovery.train), (held, discovery.held_out)):
        which = some if some.any() else ~some
        rows = np.array([*(root_mean_square(residual[which]) for residual in (runs.before, runs.after)), runs.floor])
        whole = np.sqrt(np.mean((rows / spread) ** 2, axis=1)).tolist()
        channels = dict(zip(data.channels, map(tuple, rows.T.tolist()), strict=True))
        sizes.append(replace(size, before=whole[0], after=whole[1], noise_floor=whole[2], channels=channels))
    effects = tuple(replace(effect, held_out=1 - sizes[1].unexplained) for effect in discovery.effects)
    named = [replace(one, effects=effects, held_out=sizes[1]) for one in discovery.explanations[:1] if effects]
    shown = np.flatnonzero(held if held.any() else ~held)[:DRAWN]
    seen = data.observed[at.trial[shown, None], at.first[shown, None] + np.arange(at.length)]
    time = times[shown, None] + np.arange(at.length) / data.rate
    again = (at.trial[shown][1:] == at.trial[shown][:-1])[:, None] & (time[1:] <= time[:-1, -1:])
    seen[1:][again] = np.nan  # where two runs overlap, the first is drawn
    simulated, augmented = seen - runs.before[shown], seen - runs.after[shown]
    discovery = replace(
        discovery,
        train=sizes[0],
        held_out=sizes[1],
        effects=effects,
        explanations=(*named, *discovery.explanations[len(named) :]),
        runs=Runs(at.trial[shown], time, np.zeros((len(shown), 0)), seen, simulated, augmented, names=data.trials),
    )
    return write_sentence(discovery, base, fit.parts if effects else ())
