"""A walk with recorded forces in a model of OpenSim: from its files to what each joint lacks, and the model with it."""

from collections.abc import Mapping
from dataclasses import dataclass, replace
from pathlib import Path

import numpy as np

from gaitdisc.discovery.candidate import Candidate, Identity, list_candidates
from gaitdisc.discovery.catalogue import ALL, Request, Shape, read_shapes
from gaitdisc.discovery.criteria import CRITERIA
from gaitdisc.discovery.discover_engine import name_augmented
from gaitdisc.discovery.effect_words import amount, display_unit, named_at
from gaitdisc.discovery.estimates import name_estimates
from gaitdisc.discovery.joint_and_trials import EFFECTS, STRENGTH
from gaitdisc.discovery.places import Place
from gaitdisc.discovery.prescribed import (
    CLOSED,
    JointFinding,
    Named,
    ResidualMoment,
    Values,
    joint_finding,
    name_across_joints,
)
from gaitdisc.discovery.record_filter import DENSE
from gaitdisc.discovery.result import ALPHA, TRACKED, Discovery, FoundEffect, GapSize, Runs, Whereabouts
from gaitdisc.discovery.tracked_pass import (
    NOTHING_NM,
    SEED,
    Pass,
    balance,
    compute_pass,
    moments_of_angle_noise,
    only_residuals,
    refuse_other_motion,
)
from gaitdisc.discovery.wording import write_sentence
from gaitdisc.engines.mapping import draft
from gaitdisc.engines.opensim_tracked import OpensimTracked
from gaitdisc.engines.tracked_mapping import Tracked, write_tracked_mapping
from gaitdisc.engines.written import WrittenModel, write_model
from gaitdisc.errors import SamplingError, SchemaError
from gaitdisc.recording import Finding
from gaitdisc.regular_file import file_sha256
from gaitdisc.saved.provenance import provenance_now
from gaitdisc.simulation.evaluating import Points, evaluate
from gaitdisc.simulation.parts import Input, Parameter, Sensor, Term
from gaitdisc.simulation.simulation import Simulation
from gaitdisc.whole_file import write_whole

FEWEST = 20  # samples that hold what passes the low-pass
BEYOND = 3.0  # times the noise of a joint, from which what is left is worth a word


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
            "effects and alpha can be given only for a forward simulation (a file, a function or a model)",
            f"{kinematics.name} is a tracked walk",
            "Leave out effects and alpha: each joint is searched.",
        )
    progress = request.progress
    progress(f"reading {kinematics.name} and the forces")
    walk = compute_pass(tracked, kinematics, progress)
    findings, engine, motion = balance(walk), walk.engine, walk.motion
    refuse_other_motion(walk)
    progress("computing the noise of the moments from the noise of the angles")
    angle_noise = moments_of_angle_noise(walk, tracked.noise_deg)
    base, joints = search_joints(walk, angle_noise, request)
    discovery = make_discovery(base, joints)
    progress("writing the effects into the model")
    masses, augmented = {parameter.name: parameter for parameter in engine.parameters}, draft(engine)
    for effect in discovery.effects:
        if effect.kind == "port":
            augmented = augmented.with_effect(Term(effect.place, "port", effect.name, effect.term))
        elif effect.place in masses:
            mass = replace(masses[effect.place], value=effect.estimates["value"].value)
            augmented = replace(augmented, parameters=(*augmented.parameters, mass))
    written = write_model(engine, augmented)
    notes = [note.replace("augmented.toml", "discovery.json") for note in written.notes]
    for effect in discovery.effects:
        if effect.kind == "parameter" and effect.place not in masses:  # changed muscles are not in the model's file
            number = f"{effect.place} = {effect.estimates['value'].value:.4g}"
            notes.append(f"{number} changes the forces, not the model: only discovery.json contains it")
    lines = (stretch_used(walk, kinematics.name), *_gaps(walk, written))
    shown = [summarise_joint(walk, number, joint) for number, joint in zip(walk.joints, joints, strict=True)]
    findings += [*shown, *doubts(shown)]
    findings += [Finding("note", "written back", "model", note, "") for note in notes]
    findings += [Finding("note", "own runs" if k else "stretch", "model", line, "") for k, line in enumerate(lines)]
    hashes = {file.name: file_sha256(file) for file in (engine.path, kinematics, *tracked.files)}
    settings = {"title": base.title, "seconds": float(np.ptp(motion.time)), "rate_hz": motion.rate_hz}
    made = provenance_now({**settings, "channels": list(discovery.channels)}, SEED, hashes, TRACKED)
    sentence = discovery.sentence if walk.joints else only_residuals(walk)
    discovery = replace(discovery, sentence=sentence, findings=tuple(findings), provenance=made)
    return TrackedAnswer(discovery, augmented, replace(written, notes=tuple(notes)), tracked, lines)


def make_discovery(base: Simulation, joints: list[JointFinding]) -> Discovery:
    """Return what the joints show, as an answer: effects, rivals, the gap before and after."""
    if not joints:
        return write_sentence(Discovery("no_gap", ""), base, ())
    named: dict[Identity, tuple[Named, list[JointFinding]]] = {}  # a mass is named at several joints
    for joint in joints:
        if joint.named is not None:
            named.setdefault(joint.named.candidate.identity, (joint.named, []))[1].append(joint)
    effects, rivals = [], []
    for best, (lead, *others) in named.values():
        pairs = ((joint.joint.left, joint.named.predicted) for joint in (lead, *others) if joint.named)
        before, after = np.sum([(np.sum(rest**2), np.sum((rest - taken) ** 2)) for rest, taken in pairs], axis=0)
        effects.append(_effect(base, best, 1 - after / max(before, 1e-300)))
        close = [replace(_effect(base, rival), tied=best.gained - rival.gained < CRITERIA.tie) for rival in lead.rivals]
        rivals += close[1:4]
    unexplained = [] if named else [joint for joint in joints if joint.rivals and not joint.at_noise]
    unexplained.sort(key=lambda joint: -joint.rivals[0].gained)
    rivals += [_effect(base, joint.rivals[0]) for joint in unexplained[:1]]
    units = tuple(sensor.unit for sensor in base.sensors)
    measured, residual = (np.stack([getattr(joint.joint, key) for joint in joints], 1) for key in ("demanded", "left"))
    closed = np.column_stack([joint.named.predicted if joint.named else 0.0 * joint.joint.left for joint in joints])
    walk = [values[None] for values in (measured, measured - residual, measured - residual + closed)]
    discovery = Discovery(
        next(iter(named.values()))[0].candidate.verdict if named else "no_gap",
        "",
        where=tuple(Whereabouts(effect.kind, effect.place, 1.0 / len(named)) for effect in effects),
        effects=tuple(effects),
        rivals=tuple(rivals),
        train=_gap(joints, [joint.named.explained if joint.named else 0.0 for joint in joints]),
        held_out=_gap(joints, [joint.named.predicted if joint.named else 0.0 for joint in joints]),
        channels=tuple(f"net_{joint.joint.port}" for joint in joints),
        units=units,
        runs=Runs(np.arange(1), joints[0].joint.time[None], np.zeros((1, 0)), *walk, names=("whole walk",)),
    )
    if not unexplained:
        return write_sentence(discovery, base, tuple(best for best, _ in named.values()))
    first = unexplained[0]
    best = first.prove(first.rivals[0])
    if best.gained <= 0:  # nothing explains anything: where most is left
        first = max(unexplained, key=lambda joint: np.linalg.norm(joint.joint.left) / joint.joint.floor)
    name, moment = f"net_{first.joint.port}", first.joint.left
    before, _, floor = discovery.held_out.channels[name]
    size = f"{amount(before)} {(unit := units[joints.index(first)])} (noise floor {amount(floor)} {unit})"
    sentence = f"No effect is named: the residual of {name} is {size}, and no tested effect explains it."
    if best.gained > 0:
        fit, held = (amount(float(np.sqrt(np.mean((moment - part) ** 2)))) for part in (best.explained, best.predicted))
        sentence = (
            f"Not proven: {named_at(rivals[0])} reduces the residual of {size} to {fit} {unit} in the fit and to "
            f"{held} {unit} on held-out time; its evidence is {best.gained:.0f}. A name requires {CRITERIA.margin:.0f} "
            f"or more, and {100 * CLOSED:.0f} % less squared residual on held-out time. Another walk can decide."
        )
    return replace(discovery, verdict="unexplained", sentence=sentence)


def _effect(base: Simulation, named: Named, closed: float = float("nan")) -> FoundEffect:
    candidate, numbers = named.candidate, name_estimates(named, named.covariance, base)
    place = candidate.kind, candidate.place, candidate.name
    return FoundEffect(*place, named.term, numbers, closed, named.gained, bounds=candidate.bounds)


def _gap(joints: list[JointFinding], explained: list[Values | float]) -> GapSize:
    sizes = {}
    for joint, effect in zip(joints, explained, strict=True):
        before, after = (float(np.sqrt(np.mean(moment**2))) for moment in (joint.joint.left, joint.joint.left - effect))
        sizes[f"net_{joint.joint.port}"] = (before, after, joint.joint.floor)
    spreads = np.array([max(float(np.std(joint.joint.demanded)), 1e-9) for joint in joints])
    before, after, floor = np.sqrt(np.mean((np.array(list(sizes.values())).T / spreads) ** 2, axis=1)).tolist()
    first = min((joint.named.test for joint in joints if joint.named), key=lambda test: test.p, default=None)
    return GapSize(before, after, floor, first.p if first else float("nan"), sizes, first.pieces if first else 0)


def stretch_used(walk: Pass, file: str) -> str:
    """Say which part of the record was searched, and how far each joint turned in it: what acts elsewhere is unseen."""
    time, (begin, end) = walk.motion.time, walk.motion.span
    ranges = []
    for k in walk.joints:
        joint, q = walk.engine.coordinates[k], walk.motion.q[:, k]
        unit, factor = display_unit(joint.unit)
        ranges.append(f"range of {joint.called}: {factor * q.min():.3g} to {factor * q.max():.3g} {unit}")
    used = f"{file} covers {begin:.2f} to {end:.2f} s; the search used {time[0]:.2f} to {time[-1]:.2f} s"
    return "; ".join([used, *ranges])


def write_tracked(answer: TrackedAnswer, out: Path) -> list[str]:
    """Write the model's own text with what has a form there, and its mapping, to go on from; their names."""
    augmented = write_whole(out / name_augmented(answer.tracked.model), answer.written.text)
    mapping = augmented.with_suffix(".toml")
    write_tracked_mapping(replace(answer.tracked, model=augmented), mapping)
    return [augmented.name, mapping.name]


def _gaps(walk: Pass, written: WrittenModel) -> tuple[str, ...]:
    """What the written model leaves by OpenSim itself."""
    if not isinstance(written.engine, OpensimTracked) or written.engine is walk.engine:
        return ()
    after = written.engine.demanded(walk.motion) - walk.pulls.sum(axis=1)
    lines = []
    for k in walk.joints:
        if np.abs(after - walk.left)[:, k].max() < NOTHING_NM:
            continue
        joint = walk.engine.coordinates[k]
        before, rest = (f"{amount(walk.size(curve[:, k]))} {joint.force_unit}" for curve in (walk.left, after))
        lines.append(f"{joint.called}, with the written model: residual {before} without the effects, {rest} with them")
    return tuple(lines)


def search_joints(walk: Pass, angle_noise: Values, request: Request = ALL) -> tuple[Simulation, list[JointFinding]]:
    """Name what is left at each joint beside what noise makes of it; the simulation says what the numbers are."""
    if len(walk.times) < FEWEST:
        raise SamplingError(
            f"to name residual moments at a low-pass cut-off of {walk.cutoff_hz:g} Hz, motion and forces must share at "
            f"least {FEWEST / DENSE / walk.cutoff_hz:.2g} s",
            f"they share {np.ptp(walk.motion.time):.2g} s",
            "Record a longer walk.",
        )
    base = _simulation(walk)
    possible, joints = _candidates(base, walk, request.shapes), []
    for number in walk.joints:
        joint = walk.engine.coordinates[number]
        request.progress(f"analysing the residual at {joint.called}")
        places = {joint.port, *(f"{name}_{word}" for name in walk.groups_at(number) for word in ("strength", "delay"))}
        candidates = tuple(candidate for candidate in possible if candidate.place in places)
        joints.append(joint_finding(_left(walk, base, number, angle_noise), candidates, len(walk.joints)))
    if not all(joint.at_noise for joint in joints):
        masses = walk.masses_by_joints()
        joints = name_across_joints(joints, tuple(candidate for candidate in possible if candidate.place in masses))
    return base, joints


def _simulation(walk: Pass) -> Simulation:
    """The walk as a simulation: what its muscles' groups may do otherwise, and a port at each joint."""
    plain, numbers = draft(walk.engine), []
    for name in walk.groups:
        numbers.append(Parameter(f"{name}_strength", 1.0, "1", 1 - STRENGTH, 1 + STRENGTH, "factor on the force"))
        numbers.append(Parameter(f"{name}_delay", 0.0, "s", meaning="delay of these muscles compared with the file"))
    observed, sensors = [], []
    for k in walk.joints:
        joint = walk.engine.coordinates[k]
        terms = [f"{name}_strength*delay({name}, {name}_delay)" for name in walk.groups_at(k)]
        observed.append((f"net_{joint.port}", " + ".join([*terms, joint.port])))
        sensors.append(Sensor(f"net_{joint.port}", joint.force_unit))
    return replace(
        plain,
        title=f"tracked walk of {walk.engine.path.name}",
        model="",
        inputs=tuple(Input(name, "N m", "moment from the forces file") for name in walk.groups),
        parameters=(*numbers, *walk.engine.parameters),
        observations=tuple(observed) or plain.observations,
        sensors=tuple(sensors),
    )


def _candidates(base: Simulation, walk: Pass, more: tuple[Shape, ...]) -> list[Candidate]:
    """What may act at the joints: a device's shapes at their ports, muscles stronger or later, effects of the user."""
    joints = [walk.engine.coordinates[k] for k in walk.joints]
    places = tuple(Place("port", dof.port, ((dof.name, dof.speed),), (), (), dof.unit == "rad") for dof in joints)
    effects = {*EFFECTS, *(shape.name for shape in more)}
    every = list_candidates(base, places, (*read_shapes(), *more))
    return [effect for effect in every if effect.kind == "parameter" or (effect.name in effects and not effect.states)]


def _left(walk: Pass, base: Simulation, number: int, angle_noise: Values) -> ResidualMoment:
    motion, joint = walk.motion, walk.engine.coordinates[number]
    points = Points(motion.time, np.hstack([motion.q, motion.v]), np.zeros((len(motion.time), len(base.inputs))))
    known: dict[object, Values] = {}

    def columns(candidate: Candidate, constants: Mapping[str, float]) -> Values:
        key = (candidate.identity, *constants.values())
        if key not in known:
            known[key] = walk.dense(acting(candidate, constants))
        return known[key]

    def acting(candidate: Candidate, constants: Mapping[str, float]) -> Values:
        if candidate.place in walk.demanded_by_mass:
            return -walk.demanded_by_mass[candidate.place][:, [number]]
        if candidate.verdict == "wrong_parameter":
            group, _, word = candidate.place.rpartition("_")
            moment = walk.groups[group]
            if word == "delay":
                moment = np.interp(motion.time - constants["value"], motion.time, moment) - moment
            return moment[:, None]
        extras = replace(points, extras={f"_{name}": value for name, value in constants.items()})
        pieces = [np.broadcast_to(evaluate(base, piece, extras), len(motion.time)) for piece in candidate.pieces]
        return np.column_stack(pieces)

    return ResidualMoment(
        joint.port,
        walk.times,
        walk.dense(walk.left[:, number]),
        walk.dense(walk.demanded[:, number]),
        angle_noise[:, :, number],
        along=motion.q[:, number],
        columns=columns,
    )


def summarise_joint(walk: Pass, number: int, finding: JointFinding) -> Finding:
    """Return what a joint can show, and what is left there."""
    coordinate, joint = walk.engine.coordinates[number], finding.joint
    unit = coordinate.force_unit
    spring = finding.least(walk.dense(walk.motion.q[:, number] - walk.motion.q[:, number].mean()))
    damper = finding.least(walk.dense(walk.motion.v[:, number]))
    shares = [
        f"{100 * finding.least(walk.dense(walk.groups[name])):.2g} % of the force of its {name.split('_')[-2]} muscles"
        for name in walk.groups_at(number)
    ]
    rms = float(np.sqrt(np.mean(joint.left**2)))
    what = (
        f"{coordinate.called}: residual {rms:.3g} {unit} of a required {np.std(joint.demanded):.3g} {unit}, noise "
        f"{joint.floor:.2g} {unit}; smallest visible effects: a spring of {spring:.2g} {unit}/{coordinate.unit}, a "
        f"damper of {damper:.2g} {unit} s/{coordinate.unit}" + "".join(f", {share}" for share in shares)
    )
    if rms > BEYOND * joint.floor and finding.named is None:
        return Finding("warning", "without a name", "model", what, "this joint's residual, which no effect explains")
    return Finding("note", "joint", "model", what, "", coordinate.called)


def doubts(shown: list[Finding]) -> list[Finding]:
    """Warn where joints are left far beyond their noise and have no name: the forces may answer another motion."""
    unnamed = [finding for finding in shown if finding.severity == "warning"]
    if not unnamed:
        return []
    what = (
        f"at {len(unnamed)} of {len(shown)} joints, an unnamed residual is {BEYOND:g} times the noise or more. The "
        "forces may have been computed for another motion, or for angles with another low-pass cut-off (lowpass_hz)"
    )
    return [Finding("warning", "forces in doubt", "model", what, "effects named at the other joints")]
