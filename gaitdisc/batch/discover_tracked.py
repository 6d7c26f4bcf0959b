"""A walk with recorded forces in a model of OpenSim: from its files to what each joint lacks, and the model with it."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, replace
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

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
from gaitdisc.engines.tracked_files import TrackedMotion
from gaitdisc.engines.tracked_mapping import Tracked, write_tracked_mapping
from gaitdisc.engines.written import WrittenModel, written_model
from gaitdisc.errors import SchemaError
from gaitdisc.ingest.raw_file import file_sha256
from gaitdisc.recording import Finding
from gaitdisc.results.discovery import ALPHA, TRACKED, Discovery
from gaitdisc.results.effect_words import amount
from gaitdisc.results.provenance import made_now
from gaitdisc.simulation.parts import Term
from gaitdisc.simulation.simulation import Simulation
from gaitdisc.whole_file import write_whole

Values = NDArray[np.float64]
WINDOW_S, WINDOWS = 0.02, 8  # of short forward runs


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
    tracked: Tracked,
    kinematics: Path,
    request: Request = ALL,
    progress: Callable[[str], None] = lambda _: None,
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
    augmented = _augmented(engine, found)
    written = _written(engine, augmented, found)
    said = _gaps(walk, written, found)
    shown = [shown_by(walk, number, one) for number, one in zip(walk.joints, joints, strict=True)]
    findings += [*shown, *doubts(shown)]
    findings += [Finding("note", "written back", "model", one, "") for one in written.notes]
    findings += [Finding("note", "own runs", "model", one, "") for one in said]
    hashes = {file.name: file_sha256(file) for file in (engine.path, kinematics, *tracked.files)}
    settings = {"title": base.title, "seconds": float(np.ptp(motion.time)), "rate_hz": motion.rate_hz}
    made = made_now({**settings, "channels": list(found.channels)}, SEED, hashes, TRACKED)
    found = replace(found, findings=tuple(findings), provenance=made)
    if not walk.joints:
        found = replace(found, sentence=only_residuals(walk))
    return TrackedAnswer(found, augmented, written, tracked, tuple(joints), said)


def write_tracked(answer: TrackedAnswer, out: Path) -> list[str]:
    """Write the model's own text with what has a form there, and its mapping, to go on from; their names."""
    augmented = write_whole(out / augmented_name(answer.tracked.model), answer.written.text)
    mapping = augmented.with_suffix(".toml")
    write_tracked_mapping(replace(answer.tracked, model=augmented), mapping)
    return [augmented.name, mapping.name]


def _augmented(engine: OpensimTracked, found: Discovery) -> Simulation:
    augmented = drafted(engine)
    for one in found.effects:
        if one.kind == "port":
            augmented = augmented.with_effect(Term(one.place, "port", one.name, one.term))
    return augmented


def _written(engine: OpensimTracked, augmented: Simulation, found: Discovery) -> WrittenModel:
    """The model's text with what acts at a coordinate; what muscles do otherwise is no part of the model's file."""
    written = written_model(engine, augmented)
    notes = [
        f"{one.place} = {one.estimates['value'].value:.4g} is about the forces' file and stands in discovery.json alone"
        for one in found.effects
        if one.kind == "parameter"
    ]
    own = tuple(note.replace("augmented.toml", "discovery.json") for note in written.notes)
    return replace(written, notes=(*own, *notes))


def _gaps(walk: Pass, written: WrittenModel, found: Discovery) -> tuple[str, ...]:
    """What the written model leaves by OpenSim itself: in moments, and in degrees of short forward runs."""
    places = {one.port: k for k, one in enumerate(walk.engine.coordinates)}
    numbers = [places[one.place] for one in found.effects if one.kind == "port"]
    if not numbers or not isinstance(written.engine, OpensimTracked) or written.engine is walk.engine:
        return ()
    motion = walk.motion
    after = written.engine.demanded(motion.time, (motion.q, motion.v, motion.a)) - walk.pulls.sum(axis=1)
    moments = walk.pulls.sum(axis=1)
    moments[:, list(walk.engine.base)] = walk.demanded[:, list(walk.engine.base)]
    runs = [_forward(one, motion, moments) for one in (walk.engine, written.engine)]
    said = []
    for k in numbers:
        one = walk.engine.coordinates[k]
        before, now = (float(np.sqrt(np.mean(walk.dense(each[:, k]) ** 2))) for each in (walk.left, after))
        said.append(
            f"{one.called}, computed by OpenSim with the written model: {amount(before)} {one.force_unit} left before, "
            f"{amount(now)} after; short forward runs ({1000 * WINDOW_S:.0f} ms, n = {len(runs[0])}) end "
            f"{amount(np.degrees(np.sqrt(np.mean(runs[0][:, k] ** 2))))} deg off before, "
            f"{amount(np.degrees(np.sqrt(np.mean(runs[1][:, k] ** 2))))} after"
        )
    return tuple(said)


def _forward(engine: OpensimTracked, motion: TrackedMotion, moments: Values) -> Values:
    """How far short forward runs from the record end beside it (run, coordinate)."""
    length = max(round(WINDOW_S * motion.rate_hz), 1)
    starts = np.linspace(0, len(motion.time) - 1 - length, WINDOWS).astype(int)
    ends = []
    for first in starts:
        part = slice(first, first + length + 1)
        run = engine.forward(motion.time[part], (motion.q[first], motion.v[first]), moments[part])
        ends.append(run[-1] - motion.q[first + length])
    return np.array(ends)
