"""A walk with recorded forces in a model of OpenSim: from its files to what each joint lacks, and the model with it."""

from __future__ import annotations

from dataclasses import dataclass, replace
from pathlib import Path

import numpy as np

from gaitdisc.discovery.catalogue import ALL, Request
from gaitdisc.discovery.criteria import CRITERIA
from gaitdisc.discovery.discover_engine import augmented_name
from gaitdisc.discovery.effect_words import amount, at_place, shown_unit, spoken
from gaitdisc.discovery.estimates import named_estimates
from gaitdisc.discovery.prescribed import JointFinding, Named, Values
from gaitdisc.discovery.result import ALPHA, TRACKED, Discovery, FoundEffect, GapSize, Runs, Whereabouts
from gaitdisc.discovery.tracked_joints import doubts, joints_of, shown_by
from gaitdisc.discovery.tracked_pass import (
    SEED,
    Pass,
    balance,
    moments_of_angle_noise,
    only_residuals,
    refuse_other_motion,
    tracked_pass,
)
from gaitdisc.discovery.wording import sentence_of
from gaitdisc.engines.mapping import drafted
from gaitdisc.engines.opensim_tracked import OpensimTracked
from gaitdisc.engines.tracked_mapping import Tracked, write_tracked_mapping
from gaitdisc.engines.written import WrittenModel, written_model
from gaitdisc.errors import SchemaError
from gaitdisc.ingest.raw_file import file_sha256
from gaitdisc.recording import Finding
from gaitdisc.saved.provenance import made_now
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
    said: tuple[str, ...]


def discover_tracked(tracked: Tracked, kinematics: Path, request: Request = ALL) -> TrackedAnswer:
    """Find what a model lacks at each joint of a walk whose ground and muscle forces were recorded."""
    if request.effects or request.alpha != ALPHA:
        raise SchemaError(
            "effects and alpha are given for a simulation, a function or a model that runs forward",
            f"{kinematics.name} is a walk that is tracked",
            "Leave them out: each joint is searched.",
        )
    progress = request.progress
    progress(f"reading {kinematics.name} and the forces")
    walk = tracked_pass(tracked, kinematics, progress)
    findings, engine, motion = balance(walk), walk.engine, walk.motion
    refuse_other_motion(walk)
    progress("computing what noise of the angles makes of them")
    angle_noise = moments_of_angle_noise(walk, tracked.noise_deg)
    base, joints = joints_of(walk, angle_noise, request)
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
    return TrackedAnswer(found, augmented, replace(written, notes=tuple(notes)), tracked, said)


def discovery_of(base: Simulation, joints: list[JointFinding]) -> Discovery:
    """Return what the joints show, as an answer: effects, rivals, the gap before and after."""
    named = [(one, one.named) for one in joints if one.named is not None]
    effects, rivals = [], []
    for one, best in named:
        left = float(np.sum((one.joint.left - best.predicted) ** 2))
        effects.append(_effect(base, best, 1 - left / max(float(np.sum(one.joint.left**2)), 1e-300)))
        beside = [replace(_effect(base, each), tied=best.gained - each.gained < CRITERIA.tie) for each in one.rivals]
        rivals += beside[1:4]
    ordered = sorted((one for one in joints if one.rivals), key=lambda one: -one.rivals[0].gained)
    if not named:
        rivals = [_effect(base, one.rivals[0]) for one in ordered[:1]]
    units = tuple(sensor.unit for sensor in base.sensors) if joints else ()
    found = Discovery(
        named[0][1].part.candidate.verdict if named else "no_gap",
        "",
        tuple(Whereabouts(one.kind, one.place, 1.0 / len(named)) for one in effects),
        tuple(effects),
        tuple(rivals),
        _gap(joints, [one.named.explained if one.named else 0.0 for one in joints]),
        _gap(joints, [one.named.predicted if one.named else 0.0 for one in joints]),
        tuple(f"net_{one.joint.port}" for one in joints),
        units,
        _runs(joints),
    )
    sizes = found.held_out.channels.values()
    if named or not ordered or all(before < CRITERIA.agrees * floor for before, _, floor in sizes):
        return sentence_of(found, base, tuple(best.part for _, best in named))
    first, (one,) = ordered[0], rivals
    before, after = (np.sqrt(np.mean((first.joint.left - each) ** 2)) for each in (0.0, first.rivals[0].explained))
    unit = units[joints.index(first)]
    sentence = (
        f"Not proven: {spoken(one.name)} {at_place(one.kind, one.place)} explains most of what is left, from "
        f"{amount(before)} to {amount(after)} {unit} where it is fitted (noise floor {amount(first.joint.floor)}). "
        "It does not bear that out on time held out, or has too little evidence: a longer walk or a second one would."
    )
    return replace(found, verdict="unexplained", sentence=sentence)


def _effect(base: Simulation, one: Named, closed: float = float("nan")) -> FoundEffect:
    candidate, numbers = one.part.candidate, named_estimates(one.part, one.covariance, base)
    place = candidate.kind, candidate.place, candidate.name
    return FoundEffect(*place, one.part.term, numbers, closed, one.gained, bounds=candidate.bounds)


def _gap(joints: list[JointFinding], taken: list[Values | float]) -> GapSize:
    if not joints:
        return GapSize(0.0, 0.0, 0.0)
    sizes = {}
    for one, effect in zip(joints, taken, strict=True):
        before, after = (float(np.sqrt(np.mean(each**2))) for each in (one.joint.left, one.joint.left - effect))
        sizes[f"net_{one.joint.port}"] = (before, after, one.joint.floor)
    spreads = np.array([max(float(np.std(one.joint.demanded)), 1e-9) for one in joints])
    before, after, floor = np.sqrt(np.mean((np.array(list(sizes.values())).T / spreads) ** 2, axis=1)).tolist()
    first = min((one.named.test for one in joints if one.named), key=lambda test: test.p, default=None)
    return GapSize(before, after, floor, first.p if first else float("nan"), sizes, first.pieces if first else 0)


def _runs(joints: list[JointFinding]) -> Runs:
    """The whole walk, each block of its time with what was learned from the rest."""
    none = np.empty((0, 0))
    if not joints:
        return Runs(np.zeros(0, int), none, none, none, none, none)
    measured, left = (np.column_stack([getattr(one.joint, name) for one in joints]) for name in ("demanded", "left"))
    named = np.column_stack([one.named.predicted if one.named else 0.0 * one.joint.left for one in joints])
    whole = [one[None] for one in (measured, measured - left, measured - left + named)]
    return Runs(np.arange(1), joints[0].joint.time[None], np.zeros((1, 0)), *whole, names=("whole walk",))


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
