"""A model of an engine and measured data, from their files to what was discovered and to the model with it."""

from __future__ import annotations

import os
from collections.abc import Callable, Iterator
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
from gaitdisc.discovery.result import ENGINE, Discovery, FoundEffect
from gaitdisc.discovery.scored_model import Part
from gaitdisc.discovery.spiked_samples import without_spikes
from gaitdisc.engines.conventions import refuse_other_conventions, refuse_other_units
from gaitdisc.engines.engine import Engine
from gaitdisc.engines.expansion import expand
from gaitdisc.engines.mapping import other_values, read_mapping
from gaitdisc.engines.motion import Values
from gaitdisc.engines.own_runs import OwnRuns, trial_called
from gaitdisc.engines.written import WrittenModel, write_model
from gaitdisc.errors import ChannelError
from gaitdisc.recording import Finding
from gaitdisc.simulation.expression import names, parse
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
    met, read = tuple(_report_limits(engine, states, data)), {engine.path: "model", **(files or {})}
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
        found = seal(with_own_runs(nothing, answer.runs, fit, mapping), mapping, data, read)
        answer = replace(answer, found=found)
    found = answer.found
    findings = (
        *found.findings,
        *other_values(mapping, engine),
        *met,
        *_report_saturation(answer.written.engine, data),
        *_list_warnings(engine, answer.written.engine),
        *(Finding("note", "written back", "model", what, "") for what in answer.written.notes),
        Finding("note", "own runs", "model", answer.runs.sentence, ""),
    )
    made = found.provenance and replace(found.provenance, section=ENGINE)
    return replace(answer, found=replace(found, findings=findings, provenance=made))


def search(fit: EngineFit, base: EngineAnswer, request: Request, read: dict[Path, str]) -> EngineAnswer:
    """Search the expansion along the record; of what it names, that stays which the engine's own runs bear out."""
    mapping, engine, data, passed = fit.mapping, fit.engine, fit.measured, fit.low_pass
    found, linear = search_expansion(fit, request, read)
    request.progress(f"running the augmented model with {engine.called}")
    runs = base.runs
    if fit.low_pass != passed and (fit.low_pass.margin or passed.margin):  # as the search has it
        runs = base_runs(base.written.engine, fit)
    runs = runs.among(np.isin(runs.at.trial, [trial_called(data, name) for name in found.runs.names]))
    augmented, written, _ = fit.written(found, fit.parts)
    hidden = [size[2] for size in found.held_out.channels.values()]  # noise that the record itself may not show
    pushed = [f"{effect.name} at {effect.place}" for effect in found.effects if effect.name == "process_noise"]
    unchecked = " and ".join((*written.absent, *pushed))
    if unchecked and not runs.before_at_noise:
        why = f"{engine.called} has not run {unchecked}: this result is based on the expansion of the model alone."
        return EngineAnswer(replace(found, sentence=f"{found.sentence} {why}"), augmented, written, runs, engine)
    if unchecked:  # what the engine cannot run is not said where its own runs leave mere noise
        found, augmented, written = replace(found, effects=(), corrections=()), mapping, base.written
    if found.effects and found.verdict != "wrong_initial_condition":
        held = held_out(found, runs, data)
        if not written.along:  # whose numbers rest on the smoothed motion
            found = with_forces_of_muscles(fit, fit.fitted(found, linear, runs.among(~held)), linear, runs.among(~held))
        runs = replace(runs, after=fit.left(found, fit.parts, runs)).with_floor(hidden)
        kept = keep_borne_out(fit, found, runs, held)
        if not kept:
            runs = replace(runs, after=runs.before)
            if not runs.before_at_noise:
                found = withdraw_effects(with_own_runs(found, runs, fit, linear), runs)
                return EngineAnswer(found, mapping, base.written, runs, engine)
            found, augmented, written = replace(found, effects=(), corrections=()), mapping, base.written
        elif len(kept) < len(fit.parts):
            both = list(zip(found.effects, fit.parts, strict=True))
            idle = tuple(replace(one, small=True) for one, part in both if part not in kept)
            effects = tuple(one for one, part in both if part in kept)
            fit.parts, found = kept, without_beside(found, effects, idle)
            runs = replace(runs, after=fit.left(found, kept, runs))
        if kept:
            augmented, written = fit.compared(found, runs)
    if not found.effects and runs.before_at_noise:  # the expansion errs, through a contact say
        found = replace(found, verdict="no_gap", rivals=(), explanations=())
    elif found.verdict == "no_gap":  # in short runs, in which much is a matter of the start
        found = replace(found, verdict="unexplained")
    runs = runs.with_floor(hidden)
    return EngineAnswer(with_own_runs(found, runs, fit, linear), augmented, written, runs, engine)


def search_expansion(fit: EngineFit, request: Request, read: dict[Path, str]) -> tuple[Discovery, Simulation]:
    """Search the expansion along the record, again about numbers that moved far; return the expansion as well."""
    mapping, engine, data, states = fit.mapping, fit.engine, fit.measured, fit.states
    request.progress(f"computing the accelerations of {engine.path.name} along the record with {engine.called}")
    linear, driven = expand(mapping, engine, data, states)
    request = replace(request, added=saturations(mapping, getattr(engine, "servos", {})))
    roles = {one.port: ("", one.name) for one in engine.coordinates} if len(engine.coordinates) > MANY else {}

    def is_searched(one: Candidate) -> bool:  # a limit is the input's own, and of no force
        plain = one.kind != "port" or one.place not in roles or one.role in roles[one.place]
        return (one.kind, one.name) != ("port", "input_saturation") and (plain or one.name == "linear_coupling")

    request = request if request.effects else replace(request, possible=is_searched)
    found, answer = find_missing(linear, driven, request, read)
    now, own = answer.values(), {k: one for k, one in mapping.values().items() if engine.as_force(k) is None}
    moved = {name: now[name] for name, value in own.items() if abs(now[name] - value) > MOVED * abs(value)}
    if moved and (len(found.effects) > 1 or engine.fibres):  # one number alone rests on the engine's own runs
        request.progress(f"expanding the model again about the fitted values of {', '.join(moved)}")
        linear, driven = expand(mapping, engine, data, states, moved)
        found, _ = find_missing(linear, driven, request, read)
    return found, linear


def keep_borne_out(fit: EngineFit, found: Discovery, runs: OwnRuns, held: NDArray[np.bool_]) -> tuple[Part, ...]:
    """Return the explanations without which the engine's own runs err more; of given ones, all or none."""
    kept = tuple(part for one, part in zip(found.effects, fit.parts, strict=True) if found.given or not one.small)
    if not errs_less(runs, runs.before, held):
        return ()
    for part in kept if len(kept) > 1 and not found.given else ():
        others = tuple(one for one in fit.parts if one is not part)
        if not errs_less(runs, fit.left(found, others, runs), held):
            kept = tuple(one for one in kept if one is not part)
    return kept


def with_forces_of_muscles(fit: EngineFit, found: Discovery, base: Simulation, runs: OwnRuns) -> Discovery:
    """Return what was found with a muscle's force in the place of its excitation's gain, where own runs leave less.

    An expansion does not distinguish them: its inputs are activations. What ties with that gain there does not here.
    """
    own = fit.mapping.values()
    for number, gain in enumerate(found.effects):
        name = f"{gain.place}_force"
        if gain.name != "input_gain" or name not in own:
            continue
        before = fit.left(found, fit.parts, runs)
        candidate = Candidate("wrong_parameter", "parameter", name, "wrong_parameter", value=own[name])
        force = Part(candidate, {"value": fit.parts[number].values["gain"] * own[name]})
        other = replace(fit, parts=(*fit.parts[:number], force, *fit.parts[number + 1 :]))
        named = replace(gain, kind="parameter", place=name, name="wrong_parameter")
        others = (one for one in (gain, *found.rivals) if (one.name, one.place) != (named.name, name))
        tried = replace(
            found,
            verdict="wrong_parameter",
            effects=(*found.effects[:number], named, *found.effects[number + 1 :]),
            rivals=tuple(replace(one, tied=False) for one in others),
            explanations=found.explanations[:1],
            findings=tuple(one for one in found.findings if one.kind != "unstated errors"),
        )
        tried = other.fitted(tried, base, runs)
        after = other.left(tried, other.parts, runs)
        if np.nansum((after / runs.floor) ** 2) < np.nansum((before / runs.floor) ** 2):
            found, fit.parts = tried, other.parts
    return found


def without_beside(found: Discovery, effects: tuple[FoundEffect, ...], idle: tuple[FoundEffect, ...]) -> Discovery:
    """Return an answer of some of its effects, and without explanations that only add to these."""
    kept, others = {(effect.name, effect.place) for effect in effects}, found.explanations[1:]
    adding = [other for other in others if kept < {(effect.name, effect.place) for effect in other.effects}]
    added = {(one.effects[-1].name, one.effects[-1].place) for one in adding}
    rivals = tuple(replace(rival, tied=rival.tied and (rival.name, rival.place) not in added) for rival in found.rivals)
    others = (explanation for explanation in others if explanation not in adding)
    return replace(found, effects=effects, rivals=(*idle, *rivals), explanations=(*found.explanations[:1], *others))


def withdraw_effects(found: Discovery, runs: OwnRuns) -> Discovery:
    """Take back what the engine's own runs do not bear out: an expansion or an integrator's step can err as well."""
    named = " and ".join(f"the {named_at(effect)}" for effect in found.effects)
    it = "it" if len(found.effects) == 1 else "them"
    sentence = (
        f"Not proven: {named}. {runs.engine}'s own runs have the same error without {it}, above the sensor "
        f"noise; only runs of the expanded model supported {it}. Trials with other movement can decide."
    )
    found = replace(found, effects=(), corrections=(), explanations=(), rivals=(*found.effects, *found.rivals))
    return replace(found, verdict="unexplained", sentence=sentence)


def discover_model_file(model: Path, measured: Path, request: Request = ALL) -> EngineAnswer:
    """Find what a model lacks against a file of measured trials."""
    files = {measured: "measured table"}
    return discover_engine(model, lambda mapping: read_trials(measured, mapping), request, files)


def read_trials(file: Path, mapping: Simulation) -> Measured:
    """Trials of a table, or the one trial of a storage file with angles and controls."""
    if file.suffix.lower() not in (".mot", ".sto"):
        return read_measured(file, mapping)
    from gaitdisc.ingest.storage import read_storage

    streams = list(read_storage(file).streams.values())
    whole = replace(
        streams[0],
        values=np.hstack([one.values for one in streams]),
        channels=tuple(channel for one in streams for channel in one.channels),
        suspect=np.hstack([np.asarray(one.suspect) for one in streams]),
    )
    return gather_recordings([whole], mapping)


def write_answer(answer: EngineAnswer, out: Path) -> list[str]:
    """Write the mapping with what was found, and the model's own text with what has a form there; their names."""
    engine = answer.engine
    name = os.path.relpath(engine.path.resolve(), out.resolve())
    mapping = write_simulation(replace(answer.augmented, model=name, layout=""), out / "augmented.toml")
    return [mapping.name, write_whole(out / name_augmented(engine.path), answer.written.text).name]


def name_augmented(model: Path) -> str:
    """Name of a model's file with what was found in it."""
    return f"{model.stem}_augmented{model.suffix}"


def refuse_unmeasured(mapping: Simulation, engine: Engine, data: Measured) -> None:
    """Refuse a record that does not show every free coordinate."""
    seen = {name for channel, text in mapping.observations if channel in data.channels for name in names(parse(text))}
    for coordinate in engine.coordinates:
        if coordinate.name not in seen:
            raise ChannelError(
                "every free coordinate of the model must be measured",
                f"no column shows {coordinate.called!r} (the observations show {', '.join(sorted(seen)) or 'none'})",
                "Name its column under [observations], or lock the coordinate in the model.",
            )


def _report_limits(engine: Engine, states: Values, data: Measured) -> Iterator[Finding]:
    """Say in which samples a limit or a contact of the model acts: its own runs pass through these."""
    inside = np.arange(states.shape[1]) < data.samples[:, None]
    for coordinate, q in zip(engine.coordinates, states[inside].T, strict=False):
        if share := 100 * np.mean((q <= coordinate.low) | (q >= coordinate.high)):
            limits = f"{coordinate.low:.3g} to {coordinate.high:.3g} {coordinate.unit}"
            what = f"{coordinate.called} is at its limit ({limits}) in {share:.2g} % of the samples"
            yield Finding("note", "limit", "model", f"{what}: there the model itself limits the movement", "")
    if touched := getattr(engine, "contacts", 0):
        what = f"bodies touch (at most {touched} contacts): the expansion of the model is not valid during a contact"
        yield Finding("warning", "contact", "model", what, "results that depend on runs through a contact")


def _report_saturation(engine: Engine, data: Measured) -> Iterator[Finding]:
    """Say in which samples a control is beyond its range, the model's own or one that was found."""
    driven = data.drive.inputs[np.arange(data.drive.inputs.shape[1]) < data.samples[:, None]]
    for control, u, (low, high) in zip(engine.controls, driven.T, engine.control_ranges, strict=False):
        if share := 100 * np.mean((u < low) | (u > high)):
            what = f"{control.name} is beyond its range ({low:.3g} to {high:.3g}) in {share:.2g} % of the samples"
            yield Finding("note", "saturated", "model", f"{what}: the engine clips it there", "")


def _list_warnings(*engines: Engine) -> tuple[Finding, ...]:
    """What MuJoCo warned of: it is said here, and in no file of the user's folder."""
    said = dict.fromkeys(what for one in engines for what in getattr(one, "warnings", ()))
    return tuple(
        Finding("warning", "engine", "model", f"{engines[0].called} warns: {what}", "results of runs with this warning")
        for what in said
    )
