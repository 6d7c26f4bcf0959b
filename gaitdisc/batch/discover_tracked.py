"""A walk with recorded forces in a model of OpenSim: from its files to what each joint lacks, and the model with it."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, replace
from pathlib import Path

import numpy as np

from gaitdisc.batch.discover_engine import augmented_name
from gaitdisc.batch.tracked_answer import discovery_of
from gaitdisc.batch.tracked_joints import doubts, joints_of, shown_by
from gaitdisc.batch.tracked_pass import (
    SEED,
    Pass,
    balance,
    moments_of_angle_noise,
    only_residuals,
    refuse_other_motion,
    tracked_pass,
)
from gaitdisc.discovery.catalogue import ALL, Request
from gaitdisc.discovery.prescribed import JointFinding
from gaitdisc.engines.mapping import drafted
from gaitdisc.engines.opensim_tracked import OpensimTracked
from gaitdisc.engines.tracked_mapping import Tracked, write_tracked_mapping
from gaitdisc.engines.written import WrittenModel, written_model
from gaitdisc.errors import SchemaError
from gaitdisc.ingest.raw_file import file_sha256
from gaitdisc.recording import Finding
from gaitdisc.results.discovery import ALPHA, TRACKED, Discovery
from gaitdisc.results.effect_words import amount, shown_unit
from gaitdisc.results.provenance import made_now
from gaitdisc.simulation.parts import Term
from gaitdisc.simulation.simulation import Simulation
from gaitdisc.whole_file import write_whole


@dataclass(frozen=True, eq=False)
class TrackedAnswer:
    """What was found of a walk with recorded forces."""

    found: Discovery
    augmented: Simulation  # mapping with what acts at coordinates
    written: WrittenModel
    tracked: Tracked
    joints: tuple[JointFinding, ...]
    said: tuple[str, ...]


def discover_tracked(
    tracked: Tracked, kinematics: Path, request: Request = ALL, progress: Callable[[str], None] = lambda _: None
) -> TrackedAnswer:
    """Find what a model lacks at each joint of a walk whose ground and muscle forces were recorded."""
    if request.effects or request.alpha != ALPHA:
        raise SchemaError(
            "effects and alpha are given for a simulation, a function or a model that runs forward",
            f"{kinematics.name} is a walk that is tracked",
            "Leave them out: each joint is searched.",
        )
    progress(f"reading {kinematics.name} and the forces")
    walk = tracked_pass(tracked, kinematics, progress)
    findings, engine, motion = balance(walk), walk.engine, walk.motion
    refuse_other_motion(walk)
    progress("computing what noise of the angles makes of them")
    angle_noise = moments_of_angle_noise(walk, tracked.noise_deg)
    base, joints = joints_of(walk, angle_noise, request.shapes, progress)
    found = discovery_of(base, joints)
    progress("writing it into the model")
    augmented = drafted(engine)
    for one in found.effects:
        if one.kind == "port":
            augmented = augmented.with_effect(Term(one.place, "port", one.name, one.term))
    written = written_model(engine, augmented)
    notes = [note.replace("augmented.toml", "discovery.json") for note in written.notes]
    for one in found.effects:
        if one.kind == "parameter":  # what muscles do otherwise is no part of the model's file
            number = f"{one.place} = {one.estimates['value'].value:.4g}"
            notes.append(f"{number} is about the forces' file and stands in discovery.json alone")
    said = (stretch_used(walk, kinematics.name), *_gaps(walk, written, found))
    shown = [shown_by(walk, number, one) for number, one in zip(walk.joints, joints, strict=True)]
    findings += [*shown, *doubts(shown)]
    findings += [Finding("note", "written back", "model", one, "") for one in notes]
    findings += [Finding("note", "own runs" if k else "stretch", "model", one, "") for k, one in enumerate(said)]
    hashes = {file.name: file_sha256(file) for file in (engine.path, kinematics, *tracked.files)}
    settings = {"title": base.title, "seconds": float(np.ptp(motion.time)), "rate_hz": motion.rate_hz}
    made = made_now({**settings, "channels": list(found.channels)}, SEED, hashes, TRACKED)
    sentence = found.sentence if walk.joints else only_residuals(walk)
    found = replace(found, sentence=sentence, findings=tuple(findings), provenance=made)
    return TrackedAnswer(found, augmented, replace(written, notes=tuple(notes)), tracked, tuple(joints), said)


def stretch_used(walk: Pass, file: str) -> str:
    """Say which part of the record was searched, and how far each joint turned in it: what acts elsewhere is unseen."""
    time, (begin, end) = walk.motion.time, walk.motion.span
    ranges = []
    for k in walk.joints:
        one, q = walk.engine.coordinates[k], walk.motion.q[:, k]
        unit, factor = shown_unit(one.unit)
        ranges.append(f"{one.called} {factor * q.min():.3g} to {factor * q.max():.3g} {unit}")
    used = f"searched from {time[0]:.2f} to {time[-1]:.2f} s of the {begin:.2f} to {end:.2f} s in {file}"
    return "; ".join([used, *ranges])


def write_tracked(answer: TrackedAnswer, out: Path) -> list[str]:
    """Write the model's own text with what has a form there, and its mapping, to go on from; their names."""
    augmented = write_whole(out / augmented_name(answer.tracked.model), answer.written.text)
    mapping = augmented.with_suffix(".toml")
    write_tracked_mapping(replace(answer.tracked, model=augmented), mapping)
    return [augmented.name, mapping.name]


def _gaps(walk: Pass, written: WrittenModel, found: Discovery) -> tuple[str, ...]:
    """What the written model leaves by OpenSim itself."""
    places = {one.port: k for k, one in enumerate(walk.engine.coordinates)}
    numbers = [places[one.place] for one in found.effects if one.kind == "port"]
    if not numbers or not isinstance(written.engine, OpensimTracked) or written.engine is walk.engine:
        return ()
    motion = walk.motion
    after = written.engine.demanded(motion.time, (motion.q, motion.v, motion.a)) - walk.pulls.sum(axis=1)
    said = []
    for k in numbers:
        one = walk.engine.coordinates[k]
        before, now = (f"{amount(walk.size(each[:, k]))} {one.force_unit}" for each in (walk.left, after))
        said.append(f"{one.called}, computed by OpenSim with the written model: {before} left before, {now} after")
    return tuple(said)
