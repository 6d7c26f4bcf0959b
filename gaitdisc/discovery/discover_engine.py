"""A model of an engine and measured data, from their files to what was discovered and to the model with it."""

import os
from collections.abc import Callable
from contextlib import suppress
from dataclasses import dataclass, replace
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from gaitdisc.discovery.candidate import Candidate, saturations
from gaitdisc.discovery.catalogue import ALL, Request
from gaitdisc.discovery.discover_files import find_missing, seal
from gaitdisc.discovery.effect_words import named_at
from gaitdisc.discovery.estimated_filter import find_record_filter
from gaitdisc.discovery.first_states import guess_states
from gaitdisc.discovery.fit_by_engine import EngineFit, at_other_cutoffs, base_runs, errs_less, held_out, with_own_runs
from gaitdisc.discovery.grids import find_rhythm
from gaitdisc.discovery.result import ENGINE, Discovery
from gaitdisc.discovery.scored_model import Part
from gaitdisc.discovery.spiked_samples import without_spikes
from gaitdisc.engines.conventions import (
    list_warnings,
    refuse_other_conventions,
    refuse_other_units,
    refuse_unmeasured,
    report_limits,
    report_saturation,
)
from gaitdisc.engines.engine import Engine
from gaitdisc.engines.expansion import expand
from gaitdisc.engines.mapping import other_values, read_mapping
from gaitdisc.engines.own_runs import OwnRuns, trial_called
from gaitdisc.engines.written import WrittenModel, write_model
from gaitdisc.errors import SimulationError
from gaitdisc.recording import Finding
from gaitdisc.recording.recording import join_recordings
from gaitdisc.simulation.measured import Measured
from gaitdisc.simulation.measured_table import gather_recordings, read_measured
from gaitdisc.simulation.simulation import Simulation
from gaitdisc.simulation.writing import write_simulation
from gaitdisc.whole_file import write_whole

_NOTHING = Discovery("no_gap", "")
NARROW = 0.4  # of the window that guesses states: what is expanded around need not be smooth, but must not be bent
SMOOTH = 1.2  # of it with muscles: what their fibres make of a wrong speed is far from a straight line
MANY = 6  # coordinates, beyond which no shape at a port is of another coordinate or a difference, except a coupling
MOVED = 0.02  # share by which a parameter moves at most for its slopes to hold


@dataclass(frozen=True)
class EngineAnswer:
    """What was found of a model, in the forms in which it goes on."""

    found: Discovery
    augmented: Simulation  # the mapping with what was found
    written: WrittenModel  # the model's own text with it
    runs: OwnRuns  # of the engine itself, before and after
    engine: Engine  # the model as read


def discover_engine(
    model: Path,
    measured: Callable[[Simulation], Measured],
    request: Request = ALL,
    files: dict[Path, str] | None = None,
) -> EngineAnswer:
    """Find what a model of MuJoCo or OpenSim lacks.

    measured: reads the trials, once the mapping says what their columns are
    """
    mapping, engine = read_mapping(model)
    data = measured(mapping)
    refuse_unmeasured(mapping, engine, data)
    clean, rate_of = without_spikes(data), {coordinate.name: coordinate.speed for coordinate in engine.coordinates}
    period = find_rhythm(clean.observed, clean.rate).period
    window = (SMOOTH if engine.fibres else NARROW) * period
    states = guess_states(replace(mapping, model=""), clean, window, rate_of)  # coordinates, then speeds
    refuse_other_units(mapping, engine, data, states)
    refuse_other_conventions(mapping, engine, data, states)
    met, read = tuple(report_limits(engine, states, data)), {engine.path: "model", **(files or {})}
    passed, noted = find_record_filter(mapping, clean, period)
    fit = EngineFit(mapping, engine, data, states, low_pass=passed, progress=request.progress)
    request.progress(f"running {engine.path.name} with {engine.called} along every trial")
    as_read = write_model(engine, mapping)  # what the mapping says otherwise than the model's file
    runs = base_runs(as_read.engine, fit)
    if not request.effects and not runs.leave_mere_noise:
        runs, fit, noted = at_other_cutoffs(as_read.engine, fit, runs, clean, period) or (runs, fit, noted)
    answer = EngineAnswer(_NOTHING, mapping, as_read, runs, engine)
    if request.effects or not answer.runs.leave_mere_noise:
        answer = search(fit, answer, replace(request, refitted=fit.noted), read)
    else:
        units = tuple(answer.runs.units.values())
        nothing = replace(_NOTHING, channels=data.channels, units=units, findings=(*data.findings, *noted))
        discovery = seal(with_own_runs(nothing, answer.runs, fit, mapping), mapping, data, read)
        answer = replace(answer, found=discovery)
    discovery = answer.found
    findings = (
        *discovery.findings,
        *other_values(mapping, engine),
        *met,
        *report_saturation(answer.written.engine, data),
        *list_warnings(engine, answer.written.engine),
        *(Finding("note", "written back", "model", what, "") for what in answer.written.notes),
        Finding("note", "own runs", "model", answer.runs.sentence, ""),
    )
    made = discovery.provenance and replace(discovery.provenance, section=ENGINE)
    return replace(answer, found=replace(discovery, findings=findings, provenance=made))


def search(
    fit: EngineFit, base: EngineAnswer, request: Request, read: dict[Path, str], again: bool = True
) -> EngineAnswer:
    """Search the expansion along the record; of what it names, that stays which the engine's own runs bear out.

    again: whether the others are searched once where these runs bear out nothing
    """
    mapping, engine, data, passed = fit.mapping, fit.engine, fit.measured, fit.low_pass
    discovery, linear = search_expansion(fit, request, read)
    request.progress(f"running the augmented model with {engine.called}")
    if fit.low_pass != passed and (fit.low_pass.margin or passed.margin):  # as the search has it
        base = replace(base, runs=base_runs(base.written.engine, fit))
    numbers = [trial_called(data, name) for name in discovery.runs.names]
    runs = base.runs.among(np.isin(base.runs.at.trial, numbers))
    augmented, written, _ = fit.written(discovery, fit.parts)
    hidden = [size[2] for size in discovery.held_out.channels.values()]  # noise that the record itself may not show
    pushed = [f"{effect.name} at {effect.place}" for effect in discovery.effects if effect.name == "process_noise"]
    unchecked = " and ".join((*written.absent, *pushed))
    if unchecked and not runs.before_at_noise:
        why = f"{engine.called} has not run {unchecked}: this result is based on the expansion of the model alone."
        discovery = replace(discovery, sentence=f"{discovery.sentence} {why}")
        return EngineAnswer(discovery, augmented, written, runs, engine)
    if unchecked:  # what the engine cannot run is not said where its own runs leave mere noise
        discovery, augmented, written = replace(discovery, effects=(), corrections=()), mapping, base.written
    if discovery.effects and discovery.verdict != "wrong_initial_condition":
        held = held_out(discovery, runs, data)
        if not written.along:  # whose numbers rest on the smoothed motion
            learned = runs.among(~held)
            discovery = with_forces_of_muscles(fit, fit.fitted(discovery, linear, learned), linear, learned)
        runs = replace(runs, after=fit.left(discovery, fit.parts, runs)).with_floor(hidden)
        kept = keep_borne_out(fit, discovery, runs, held)
        if not kept:
            runs = replace(runs, after=runs.before)
            if not runs.before_at_noise:
                named = {(effect.name, effect.place) for effect in discovery.effects}
                discovery = withdraw_effects(with_own_runs(discovery, runs, fit, linear), runs)
                others = replace(request, possible=lambda candidate: (candidate.name, candidate.place) not in named)
                other = search(fit, base, others, read, False) if again and not request.effects else None
                return other if other and other.found.effects else replace(base, found=discovery, runs=runs)
            discovery, augmented, written = replace(discovery, effects=(), corrections=()), mapping, base.written
        elif len(kept) < len(fit.parts):
            fit.parts, discovery = kept, keep_some(discovery, fit.parts, kept)
            runs = replace(runs, after=fit.left(discovery, kept, runs))
        if kept:
            augmented, written = fit.compared(discovery, runs)
    if not discovery.effects and runs.before_at_noise:  # the expansion errs, through a contact say
        discovery = replace(discovery, verdict="no_gap", rivals=(), explanations=())
    elif discovery.verdict == "no_gap":  # in short runs, in which much is a matter of the start
        discovery = replace(discovery, verdict="unexplained")
    runs = runs.with_floor(hidden)
    return EngineAnswer(with_own_runs(discovery, runs, fit, linear), augmented, written, runs, engine)


def search_expansion(fit: EngineFit, request: Request, read: dict[Path, str]) -> tuple[Discovery, Simulation]:
    """Search the expansion along the record, again about numbers that moved far; return the expansion as well."""
    mapping, engine, data, states = fit.mapping, fit.engine, fit.measured, fit.states
    request.progress(f"computing the accelerations of {engine.path.name} along the record with {engine.called}")
    linear, driven = expand(mapping, engine, data, states)
    request = replace(request, added=saturations(mapping, getattr(engine, "servos", {})))
    roles = {q.port: ("", q.name) for q in engine.coordinates} if len(engine.coordinates) > MANY else {}

    def is_searched(candidate: Candidate) -> bool:  # a limit is the input's own, and of no force
        plain = candidate.kind != "port" or candidate.place not in roles or candidate.role in roles[candidate.place]
        plain = plain or candidate.name == "linear_coupling"
        return plain and (candidate.kind, candidate.name) != ("port", "input_saturation") and possible(candidate)

    possible = request.possible
    request = request if request.effects else replace(request, possible=is_searched)
    discovery, answer = find_missing(linear, driven, request, read)
    now, unfixed = answer.values(), {k: value for k, value in mapping.values().items() if engine.as_force(k) is None}
    moved = {name: now[name] for name, value in unfixed.items() if abs(now[name] - value) > MOVED * abs(value)}
    if moved and (len(discovery.effects) > 1 or engine.fibres):  # one number alone rests on the engine's own runs
        request.progress(f"expanding the model again about the fitted values of {', '.join(moved)}")
        near, driven = expand(mapping, engine, data, states, moved)
        with suppress(SimulationError):  # which may diverge with the file's own values, if these are far
            discovery, linear = find_missing(near, driven, request, read)[0], near
    return discovery, linear


def keep_borne_out(fit: EngineFit, discovery: Discovery, runs: OwnRuns, held: NDArray[np.bool_]) -> tuple[Part, ...]:
    """Return the explanations without which the engine's own runs err more; of given ones, all or none."""
    both = zip(discovery.effects, fit.parts, strict=True)
    kept = tuple(part for effect, part in both if discovery.given or not effect.small)
    if not errs_less(runs, runs.before, held):
        return ()
    for part in kept if len(kept) > 1 and not discovery.given else ():
        others = tuple(other for other in fit.parts if other is not part)
        if not errs_less(runs, fit.left(discovery, others, runs), held):
            kept = tuple(other for other in kept if other is not part)
    return kept


def with_forces_of_muscles(fit: EngineFit, discovery: Discovery, base: Simulation, runs: OwnRuns) -> Discovery:
    """Return what was found with a muscle's force in the place of its excitation's gain, where own runs leave less.

    An expansion does not distinguish them: its inputs are activations. What ties with that gain there does not here.
    """
    numbers = fit.mapping.values()
    for number, gain in enumerate(discovery.effects):
        name = f"{gain.place}_force"
        if gain.name != "input_gain" or name not in numbers:
            continue
        before = fit.left(discovery, fit.parts, runs)
        candidate = Candidate("wrong_parameter", "parameter", name, "wrong_parameter", value=numbers[name])
        force = Part(candidate, {"value": fit.parts[number].values["gain"] * numbers[name]})
        other = replace(fit, parts=(*fit.parts[:number], force, *fit.parts[number + 1 :]))
        named = replace(gain, kind="parameter", place=name, name="wrong_parameter")
        others = (rival for rival in (gain, *discovery.rivals) if (rival.name, rival.place) != (named.name, name))
        tried = replace(
            discovery,
            verdict="wrong_parameter",
            effects=(*discovery.effects[:number], named, *discovery.effects[number + 1 :]),
            rivals=tuple(replace(rival, tied=False) for rival in others),
            explanations=discovery.explanations[:1],
            findings=tuple(finding for finding in discovery.findings if finding.kind != "unstated errors"),
        )
        tried = other.fitted(tried, base, runs)
        after = other.left(tried, other.parts, runs)
        if np.nansum((after / runs.floor) ** 2) < np.nansum((before / runs.floor) ** 2):
            discovery, fit.parts = tried, other.parts
    return discovery


def keep_some(discovery: Discovery, parts: tuple[Part, ...], some: tuple[Part, ...]) -> Discovery:
    """Return an answer of some of its parts, and without explanations that only add to these."""
    both = list(zip(discovery.effects, parts, strict=True))
    idle = tuple(replace(effect, small=True) for effect, part in both if part not in some)
    effects = tuple(effect for effect, part in both if part in some)
    kept = {(effect.name, effect.place) for effect in effects}
    first, others = discovery.explanations[:1], discovery.explanations[1:]
    adding = [other for other in others if kept < {(effect.name, effect.place) for effect in other.effects}]
    added = {(other.effects[-1].name, other.effects[-1].place) for other in adding}
    alone = [(rival, (rival.name, rival.place) not in added) for rival in discovery.rivals]
    rivals = (*idle, *(replace(rival, tied=rival.tied and is_alone) for rival, is_alone in alone))
    others = (explanation for explanation in others if explanation not in adding)
    verdict, explanations = some[0].candidate.verdict, (*first, *others)
    return replace(discovery, verdict=verdict, effects=effects, rivals=rivals, explanations=explanations)


def withdraw_effects(discovery: Discovery, runs: OwnRuns) -> Discovery:
    """Take back what the engine's own runs do not bear out: an expansion or an integrator's step can err as well."""
    named = " and ".join(f"the {named_at(effect)}" for effect in discovery.effects)
    it = "it" if len(discovery.effects) == 1 else "them"
    sentence = (
        f"Not proven: {named}. {runs.engine}'s own runs have the same error without {it}, above the sensor "
        f"noise; only runs of the expanded model supported {it}. Trials with other movement can decide."
    )
    rivals = (*discovery.effects, *discovery.rivals)
    discovery = replace(discovery, effects=(), corrections=(), explanations=(), rivals=rivals)
    return replace(discovery, verdict="unexplained", sentence=sentence)


def discover_model_file(model: Path, measured: Path, request: Request = ALL) -> EngineAnswer:
    """Find what a model lacks against a file of measured trials."""
    files = {measured: "measured table"}
    return discover_engine(model, lambda mapping: read_trials(measured, mapping), request, files)


def read_trials(file: Path, mapping: Simulation) -> Measured:
    """Trials of a table, or the one trial of a storage file with angles and controls."""
    if file.suffix.lower() not in (".mot", ".sto"):
        return read_measured(file, mapping)
    from gaitdisc.ingest.storage import read_storage

    return gather_recordings([join_recordings(*read_storage(file).streams.values())], mapping)


def write_answer(answer: EngineAnswer, out: Path) -> list[str]:
    """Write the mapping with what was found, and the model's own text with what has a form there; their names."""
    engine = answer.engine
    name = os.path.relpath(engine.path.resolve(), out.resolve())
    mapping = write_simulation(replace(answer.augmented, model=name, layout=""), out / "augmented.toml")
    return [mapping.name, write_whole(out / name_augmented(engine.path), answer.written.text).name]


def name_augmented(model: Path) -> str:
    """Name of a model's file with what was found in it."""
    return f"{model.stem}_augmented{model.suffix}"
