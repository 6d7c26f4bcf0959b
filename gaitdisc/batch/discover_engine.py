"""A model of an engine and measured data, from their files to what was discovered and to the model with it."""

from __future__ import annotations

import os
from collections.abc import Callable
from dataclasses import dataclass, replace
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from gaitdisc.batch.discover_files import discovered
from gaitdisc.batch.fit_by_engine import EngineFit
from gaitdisc.discovery.candidate import SIGNAL_ERRORS
from gaitdisc.discovery.catalogue import ALL, Request
from gaitdisc.discovery.first_states import guess_states
from gaitdisc.discovery.grids import rhythm_of
from gaitdisc.discovery.spiked_samples import without_spikes
from gaitdisc.engines.conventions import refuse_other_conventions, refuse_other_units
from gaitdisc.engines.engine import Engine
from gaitdisc.engines.expansion import expanded
from gaitdisc.engines.mapping import other_values, read_mapping, with_input_changed
from gaitdisc.engines.own_runs import OwnRuns, own_runs
from gaitdisc.engines.written import WrittenModel, written_model
from gaitdisc.errors import ChannelError
from gaitdisc.recording import Finding
from gaitdisc.results.discovery import ENGINE, Discovery
from gaitdisc.results.effect_words import at_place, spoken
from gaitdisc.simulation.expression import names, parsed
from gaitdisc.simulation.measured import Measured
from gaitdisc.simulation.measured_table import measured_of_recordings, read_measured
from gaitdisc.simulation.simulation import Simulation
from gaitdisc.simulation.writing import write_simulation
from gaitdisc.whole_file import write_whole

NARROW = 0.4  # of the window that guesses states: what is expanded around need not be smooth, but must not be bent
CONFIRMED = 0.97  # of the error that the engine's own runs leave of the record, above which nothing was shown
SMOOTH = 1.2  # of it with muscles: what their fibres make of a wrong speed is far from a straight line
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
    progress: Callable[[str], None] = lambda _: None,
) -> EngineAnswer:
    """Find what a model of MuJoCo or OpenSim lacks.

    model: the model, or its mapping file
    measured: reads the trials, once the mapping says what their columns are
    files: what was read, and what it is called in the result
    """
    mapping, engine = read_mapping(model)
    data = measured(mapping)
    refuse_unmeasured(mapping, engine, data)
    states = smoothed_states(mapping, engine, data)
    refuse_other_conventions(mapping, engine, data, states)
    progress(f"computing the accelerations of {engine.path.name} along the record by {engine.called}")
    linear, driven = expanded(mapping, engine, data, states)
    read = {engine.path: "model", **(files or {})}  # what was read of the data is known by now
    fit = EngineFit(mapping, engine, data, states)
    found, answer = discovered(linear, driven, request, read, progress, refitted=fit.refitted)
    moved = {name: value for name, value in _moved(mapping, answer).items() if engine.as_force(name) is None}
    if moved and (len(found.effects) > 1 or not fit.done):  # one number alone rests on the engine's own runs
        progress(f"expanding again where {' and '.join(moved)} came to lie")
        linear, driven = expanded(mapping, engine, data, states, moved)
        found, answer = discovered(linear, driven, request, read, progress, refitted=fit.refitted)
    augmented = in_mapping(mapping, answer, found)
    progress("writing it into the model")
    written = written_model(engine, augmented)
    progress(f"running both with {engine.called}")
    as_read = written_model(engine, mapping)  # what the mapping says otherwise than the model's file
    runs = own_runs((as_read.engine, written.engine), (mapping, augmented), data, found.runs, states)
    if found.effects and not written.absent and runs.share > CONFIRMED:
        found, augmented, written = unconfirmed(found, runs), mapping, as_read
    findings = (
        *found.findings,
        *other_values(mapping, engine),
        *_contacts(engine),
        *_warned(engine, written.engine),
        *_said(written, runs),
    )
    if found.provenance is not None:
        found = replace(found, provenance=replace(found.provenance, section=ENGINE))
    return EngineAnswer(replace(found, findings=findings), augmented, written, runs, engine)


def unconfirmed(found: Discovery, runs: OwnRuns) -> Discovery:
    """Take back what the engine's own runs do not bear out: an expansion or an integrator's step can err as well."""
    named = " and ".join(f"the {spoken(one.name)} {at_place(one.kind, one.place)}" for one in found.effects)
    sentence = (
        f"Nothing is named: {runs.engine}'s own runs over what was held out miss the record as much with as without "
        f"{named}, which runs of the expanded model spoke for; its integrator's step or the expansion makes such a "
        f"difference. Let {runs.engine} take shorter steps, or record at a higher rate."
    )
    before = {name: (size, size, floor) for name, (size, _, floor) in found.held_out.channels.items()}
    held_out = replace(found.held_out, after=found.held_out.before, channels=before, p=float("nan"))
    return replace(
        found,
        verdict="no_gap",
        sentence=sentence,
        where=(),
        effects=(),
        corrections=(),
        rivals=(*found.effects, *found.rivals),
        train=replace(found.train, after=found.train.before),
        held_out=held_out,
        runs=replace(found.runs, augmented=found.runs.simulated),
    )


def discover_model_file(
    model: Path, measured: Path, request: Request = ALL, progress: Callable[[str], None] = lambda _: None
) -> EngineAnswer:
    """Find what a model lacks against a file of measured trials."""
    files = {measured: "measured table"}
    return discover_engine(model, lambda mapping: measured_of_file(measured, mapping), request, files, progress)


def measured_of_file(file: Path, mapping: Simulation) -> Measured:
    """Trials of a table, or the one trial of a storage file with angles and controls."""
    if file.suffix.lower() not in (".mot", ".sto"):
        return read_measured(file, mapping)
    from gaitdisc.ingest.storage import read_storage

    streams = list(read_storage(file).streams.values())
    channels = tuple(channel for one in streams for channel in one.channels)
    whole = replace(
        streams[0],
        values=np.concatenate([one.values for one in streams], axis=1),
        channels=channels,
        suspect=np.concatenate([np.asarray(one.suspect) for one in streams], axis=1),
    )
    return measured_of_recordings([whole], mapping)


def write_answer(answer: EngineAnswer, out: Path) -> list[str]:
    """Write the mapping with what was found, and the model's own text with what has a form there; their names."""
    engine = answer.engine
    name = os.path.relpath(engine.path.resolve(), out.resolve())
    mapping = write_simulation(replace(answer.augmented, model=name, layout=""), out / "augmented.toml")
    return [mapping.name, write_whole(out / augmented_name(engine.path), answer.written.text).name]


def augmented_name(model: Path) -> str:
    """Name of a model's file with what was found in it."""
    return f"{model.stem}_augmented{model.suffix}"


def refuse_unmeasured(mapping: Simulation, engine: Engine, data: Measured) -> None:
    """Refuse a record that does not show every free coordinate."""
    seen = {name for channel, text in mapping.observations if channel in data.channels for name in names(parsed(text))}
    for one in engine.coordinates:
        if one.name not in seen:
            raise ChannelError(
                "every free coordinate of the model is measured",
                f"no column shows {one.called!r}; the observations show {', '.join(sorted(seen)) or 'none'}",
                "Name its column under [observations], or lock the coordinate in the model.",
            )


def smoothed_states(mapping: Simulation, engine: Engine, data: Measured) -> NDArray[np.float64]:
    """Coordinates and speeds along the record (trial, sample, state)."""
    data, plain = without_spikes(data), replace(mapping, model="")
    period = rhythm_of(data.observed, data.rate).period
    rate_of = {one.name: one.speed for one in engine.coordinates}
    found = guess_states(plain, data, (SMOOTH if engine.fibres else NARROW) * period, rate_of).states
    largest = np.nanmax(np.abs(found), axis=(0, 1))
    refuse_other_units(mapping, engine, {one.name: float(largest[k]) for k, one in enumerate(engine.coordinates)})
    return found


def in_mapping(mapping: Simulation, answer: Simulation, found: Discovery) -> Simulation:
    """What was found in the expanded simulation, in the model's mapping."""
    values = answer.values()
    changed = mapping.with_values({name: values[name] for name in mapping.values()})
    own = {state.name for state in answer.states[len(mapping.states) :]}
    for term in answer.effects:
        if not own & set(names(parsed(term.term))):  # a state of an effect's own is not the model's
            changed = changed.with_effect(term)
    for name, text in answer.observations:
        changed = changed.with_observation(name, text)
    for effect in found.effects:
        if effect.kind == "input" and SIGNAL_ERRORS[effect.name][2]:
            slot, _, form = SIGNAL_ERRORS[effect.name]
            number = repr(effect.estimates[slot].value) if slot in effect.estimates else "1"
            changed = with_input_changed(changed, effect.place, form.format(s=effect.place, **{slot: number}))
    starts = {one.name: one.initial for one in answer.states if one.initial is not None and one.name not in own}
    return changed.with_starts(starts)


def _moved(mapping: Simulation, answer: Simulation) -> dict[str, float]:
    """Parameters that came to lie where their slopes no longer hold."""
    before, after = mapping.values(), answer.values()
    return {name: after[name] for name in before if abs(after[name] - before[name]) > MOVED * abs(before[name])}


def _contacts(engine: Engine) -> tuple[Finding, ...]:
    touched = getattr(engine, "contacts", 0)
    what = (
        f"bodies touch in the record ({touched} contacts at most): forces there are stiff and were expanded as they are"
    )
    return (Finding("warning", "contact", "model", what, "what rests on runs through a contact"),) if touched else ()


def _warned(*engines: Engine) -> tuple[Finding, ...]:
    """What MuJoCo warned of: it is said here, and in no file of the user's folder."""
    said = dict.fromkeys(what for one in engines for what in getattr(one, "warnings", ()))
    return tuple(
        Finding("warning", "engine", "model", f"{engines[0].called} warns: {what}", "what rests on such a run")
        for what in said
    )


def _said(written: WrittenModel, runs: OwnRuns) -> tuple[Finding, ...]:
    """What the engine itself says of the answer."""
    found = [Finding("note", "written back", "model", what, "") for what in written.notes]
    return (*found, Finding("note", "own runs", "model", runs.said, ""))
