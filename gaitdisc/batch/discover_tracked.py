"""A walk with recorded forces in a model of OpenSim: from its files to what each joint lacks, and the model with it."""

from __future__ import annotations

import os
from collections.abc import Callable, Mapping
from dataclasses import dataclass, replace
from functools import cached_property
from pathlib import Path

import numpy as np
from numpy.typing import NDArray
from scipy.signal import butter, sosfiltfilt

from gaitdisc.batch.joint_inquiry import EFFECTS, STRENGTH
from gaitdisc.discovery.candidate import Candidate, candidates_of
from gaitdisc.discovery.catalogue import Shape, known_shapes, read_catalogue
from gaitdisc.discovery.estimates import named_estimates
from gaitdisc.discovery.places import Place
from gaitdisc.discovery.prescribed import JointFinding, LeftMoment, Named, joint_finding
from gaitdisc.discovery.ranking import TIE
from gaitdisc.discovery.record_filter import DENSE
from gaitdisc.discovery.wording import sentence_of
from gaitdisc.engines.mapping import drafted
from gaitdisc.engines.opensim_tracked import OpensimTracked
from gaitdisc.engines.tracked_files import Tracked, TrackedMotion, check_loads, tracked_motion
from gaitdisc.engines.written import WrittenModel, written_model
from gaitdisc.errors import SamplingError, SchemaError
from gaitdisc.ingest.file_hash import file_sha256
from gaitdisc.recording import Finding
from gaitdisc.results.discovery import Discovery, FoundEffect, GapSize, Runs, Whereabouts
from gaitdisc.results.effect_words import amount
from gaitdisc.results.provenance import made_now
from gaitdisc.signals.derivatives import differentiated
from gaitdisc.simulation.evaluating import Points, evaluate
from gaitdisc.simulation.parts import Input, Parameter, Sensor, Term
from gaitdisc.simulation.simulation import Simulation
from gaitdisc.toml_text import quoted
from gaitdisc.whole_file import write_whole

Values = NDArray[np.float64]
DRAWS, SEED, NOISE_DEG = 4, 0, 0.3
FEWEST = 20  # samples that hold what passes the low-pass
OTHER_MOTION = 0.15  # of the weight
WRONG_MASS = 0.05  # of the weight, which the ground carries less or more than the model moves
LEAST_ARM_M = 1e-3
SIDES = ((1.0, "raising"), (-1.0, "lowering"))
WINDOW_S, WINDOWS = 0.02, 8  # of short forward runs
BEYOND = 3.0  # times the noise of a joint, from which what is left is worth a word


@dataclass(frozen=True, eq=False)
class TrackedAnswer:
    """What was found of a walk with recorded forces."""

    found: Discovery
    augmented: Simulation  # mapping with what acts at coordinates
    written: WrittenModel
    tracked: Tracked
    joints: tuple[JointFinding, ...]
    said: tuple[str, ...]


@dataclass(frozen=True, eq=False)
class Pass:
    """Generalised forces along a prescribed motion."""

    engine: OpensimTracked
    motion: TrackedMotion
    cutoff_hz: float
    demanded: Values  # (sample, coordinate)
    pulls: Values  # (sample, actuator, coordinate), of each actuator of the forces' file
    groups: Mapping[str, Values]  # moment (sample,) of muscles that raise or lower a coordinate

    @property
    def left(self) -> Values:
        """What neither the model nor its actuators give (sample, coordinate)."""
        return self.demanded - self.pulls.sum(axis=1)

    @property
    def joints(self) -> tuple[int, ...]:
        """Coordinates on which some actuator of the file acts, those with the ground apart."""
        moved = (
            np.abs(self.pulls).max(axis=(0, 1)) > 0 if self.pulls.shape[1] else np.zeros(self.demanded.shape[1], bool)
        )
        return tuple(k for k in range(self.demanded.shape[1]) if moved[k] and k not in self.engine.base)

    @cached_property
    def weight_n(self) -> float:
        """What moving the body up and down takes in the mean; 0 where no coordinate does [N]."""
        motion, up = self.motion, self.engine.vertical
        if up < 0:
            return 0.0
        alone = self.engine.demanded(motion.time, (motion.q, motion.v, motion.a), loaded=False)
        return abs(float(np.mean(self.dense(alone[:, up]))))

    @property
    def kept(self) -> slice:
        """Samples that hold all that the low-pass leaves."""
        return slice(None, None, max(int(self.motion.rate_hz / (DENSE * self.cutoff_hz)), 1))

    @property
    def times(self) -> Values:
        """Of these samples [s]."""
        return self.motion.time[self.kept]

    def groups_at(self, number: int) -> list[str]:
        """Names of the groups of muscles that move a coordinate."""
        name = self.engine.coordinates[number].name
        return [f"{name}_{word}_muscles" for _, word in SIDES if f"{name}_{word}_muscles" in self.groups]

    def dense(self, values: Values) -> Values:
        """Values (sample, ...) after the record's low-pass, at these samples."""
        return sosfiltfilt(self.sections, values, axis=0)[self.kept]

    @cached_property
    def sections(self) -> Values:
        """Low-pass of the record, in second-order sections."""
        return np.asarray(butter(4, self.cutoff_hz, fs=self.motion.rate_hz, output="sos"))


def discover_tracked(
    tracked: Tracked,
    kinematics: Path,
    catalogue: Path | None = None,
    told: Callable[[str], None] = lambda _: None,
) -> TrackedAnswer:
    """Find what a model lacks at each joint of a walk whose ground and muscle forces were recorded."""
    told(f"reading {kinematics.name} and the forces")
    walk = tracked_pass(tracked, kinematics, told)
    findings, engine, motion = _balance(walk), walk.engine, walk.motion
    _refuse_other_motion(walk)
    told("computing what noise of the angles makes of them")
    angle_noise = moments_of_angle_noise(walk, tracked.noise_deg)
    base, joints = joints_of(walk, angle_noise, read_catalogue(catalogue) if catalogue else (), told)
    found = _discovery(base, joints)
    told("writing it into the model")
    augmented = _augmented(engine, found)
    written = _written(engine, augmented, found)
    said = _gaps(walk, written, found)
    findings += [_shows(walk, number, one) for number, one in zip(walk.joints, joints, strict=True)]
    findings += [Finding("note", "written back", "model", one, "") for one in written.notes]
    findings += [Finding("note", "own runs", "model", one, "") for one in said]
    hashes = {file.name: file_sha256(file) for file in (engine.path, kinematics, *tracked.files)}
    settings = {"title": base.title, "seconds": float(np.ptp(motion.time)), "rate_hz": motion.rate_hz}
    made = made_now({**settings, "channels": list(found.channels)}, SEED, hashes, "tracked pass")
    found = replace(found, findings=tuple(findings), provenance=made)
    if not walk.joints:
        found = replace(found, sentence=_only_residuals(walk))
    return TrackedAnswer(found, augmented, written, tracked, tuple(joints), said)


def tracked_pass(tracked: Tracked, kinematics: Path, told: Callable[[str], None] = lambda _: None) -> Pass:
    """Compute the generalised forces that a recorded motion demands, and those that the files' actuators give."""
    check_loads(tracked)
    engine = OpensimTracked(tracked.model, tracked.loads, tracked.actuators)
    motion = tracked_motion(tracked, kinematics, engine.coordinates, engine.actuators)
    told("computing the moments that the motion demands, by OpenSim")
    demanded = engine.demanded(motion.time, (motion.q, motion.v, motion.a))
    arms = engine.arms(motion.time, motion.q, motion.actuators)
    pulls = arms * motion.forces[:, :, None]
    muscles = np.array([name in engine.paths for name in motion.actuators])
    groups = {}
    for k, one in enumerate(engine.coordinates):
        if k in engine.base or not muscles.any():
            continue
        mean = arms[:, :, k].mean(axis=0) * muscles
        for sign, word in SIDES:
            own = sign * mean > LEAST_ARM_M
            if own.any():
                groups[f"{one.name}_{word}_muscles"] = pulls[:, own, k].sum(axis=1)
    return Pass(engine, motion, tracked.lowpass_hz, demanded, pulls, groups)


def joints_of(
    walk: Pass, angle_noise: Values, more: tuple[Shape, ...] = (), told: Callable[[str], None] = lambda _: None
) -> tuple[Simulation, list[JointFinding]]:
    """Name what is left at each joint beside what noise makes of it; the simulation says what the numbers are."""
    _refuse_short(walk)
    base = _simulation(walk)
    joints = []
    for number in walk.joints:
        told(f"weighing what is left at {walk.engine.coordinates[number].called}")
        joint = _left(walk, base, number, angle_noise)
        joints.append(joint_finding(joint, _candidates(base, walk, number, (*known_shapes(), *more)), len(walk.joints)))
    return base, joints


def _refuse_short(walk: Pass) -> None:
    if len(walk.times) < FEWEST:
        raise SamplingError(
            f"what is left is named from {FEWEST / DENSE / walk.cutoff_hz:.2g} s or more at a low-pass of "
            f"{walk.cutoff_hz:g} Hz",
            f"motion and forces share {np.ptp(walk.motion.time):.2g} s",
            "Record longer.",
        )


def write_tracked(answer: TrackedAnswer, out: Path) -> None:
    """Write the model's own text with what has a form there, and its mapping, to go on from."""
    tracked = answer.tracked
    stem, suffix = tracked.model.stem, tracked.model.suffix
    write_whole(out / f"{stem}_augmented{suffix}", answer.written.text)
    lines = [f"model = {quoted(f'{stem}_augmented{suffix}')}", "", "[tracked]"]
    names = {"external_loads": tracked.loads[0], "forces": tracked.forces, "actuators": tracked.actuators}
    names |= {"speeds": tracked.speeds, "accelerations": tracked.accelerations}
    for name, path in names.items():
        if path is not None:
            lines.append(f"{name} = {quoted(Path(os.path.relpath(path.resolve(), out.resolve())).as_posix())}")
    lines.append(f"lowpass_hz = {tracked.lowpass_hz!r}")
    numbers = {"noise_deg": tracked.noise_deg, "start_s": tracked.start_s, "end_s": tracked.end_s}
    lines += [f"{name} = {value!r}" for name, value in numbers.items() if value is not None and np.isfinite(value)]
    write_whole(out / f"{stem}_augmented.toml", "\n".join(lines) + "\n")


def _balance(walk: Pass) -> list[Finding]:
    """Say what is left at the joint with the ground; refuse a model whose mass is not the walker's."""
    engine, up = walk.engine, walk.engine.vertical
    found = []
    for k in engine.base:
        one, size = engine.coordinates[k], float(np.sqrt(np.mean(walk.dense(walk.demanded[:, k]) ** 2)))
        what = f"{one.called}: {size:.3g} {one.force_unit} (root mean square) that neither ground nor body explain"
        found.append(Finding("note", "residual", "model", what, "", one.called))
    if up < 0:
        return found
    mean = float(np.mean(walk.dense(walk.demanded[:, up])))
    share = mean / walk.weight_n
    if abs(share) > WRONG_MASS:
        mass = engine.mass_kg
        raise SchemaError(
            f"the ground carries the model's weight to {100 * WRONG_MASS:.0f} %",
            f"{engine.path.name} moves {mass:.1f} kg, {engine.coordinates[up].called} lacks {mean:.0f} N in the mean: "
            f"the forces carry {mass * (1 - share):.1f} kg",
            "Scale the model to the walker's mass, or correct the plates' scale; what is left at the joints would be "
            "named after the error.",
        )
    return found


def _refuse_other_motion(walk: Pass) -> None:
    """Refuse forces whose residuals do not balance this motion: they were computed for another one, or failed."""
    engine, weight = walk.engine, walk.weight_n
    given = np.abs(walk.pulls).max(axis=(0, 1)) if walk.pulls.shape[1] else np.zeros(len(engine.coordinates))
    for k in engine.base:
        one = engine.coordinates[k]
        size = float(np.sqrt(np.mean(walk.dense(walk.left[:, k]) ** 2)))
        if one.unit == "m" and given[k] > 0 and weight and size > OTHER_MOTION * weight:
            raise SchemaError(
                f"residual forces of the forces' file balance its motion to {100 * OTHER_MOTION:.0f} % of the weight",
                f"{one.called} lacks {size:.0f} N (root mean square) of {weight:.0f}",
                "Compute the forces for this motion again: they belong to another one, or were not found.",
            )


def moments_of_angle_noise(walk: Pass, noise_deg: float | None) -> Values:
    """What noise of the angles, after the record's low-pass, makes of the moments (draw, sample, coordinate)."""
    motion, rate = walk.motion, walk.motion.rate_hz
    given = noise_deg if noise_deg is not None else (NOISE_DEG if motion.differentiated else 0.0)
    sizes = np.array([np.radians(given) if one.unit == "rad" else given / 300 for one in walk.engine.coordinates])
    if not given:
        return np.zeros((1, len(walk.times), len(sizes)))
    rng = np.random.default_rng(SEED)
    spare = int(rate)
    draws = []
    for _ in range(DRAWS):
        noise = sosfiltfilt(walk.sections, rng.normal(size=(len(motion.time) + 2 * spare, len(sizes))), axis=0)
        noise *= sizes / noise.std(axis=0)
        inside = slice(spare, spare + len(motion.time))
        first, second = (differentiated(noise, rate, order)[inside] for order in (1, 2))
        moved = (motion.q + noise[inside], motion.v + first, motion.a + second)
        draws.append(walk.dense(walk.engine.demanded(motion.time, moved) - walk.demanded))
    return np.array(draws)


def _simulation(walk: Pass) -> Simulation:
    """The walk as a simulation: what its muscles' groups may do otherwise, and a port at each joint."""
    plain = drafted(walk.engine)
    inputs = tuple(Input(name, "N m", "of the forces' file") for name in walk.groups)
    numbers = []
    for name in walk.groups:
        numbers.append(Parameter(f"{name}_strength", 1.0, "1", 1 - STRENGTH, 1 + STRENGTH, "against the file's forces"))
        numbers.append(Parameter(f"{name}_delay", 0.0, "s", meaning="by which they act later than in the file"))
    seen, sensors = [], []
    for k in walk.joints:
        one = walk.engine.coordinates[k]
        terms = [f"{name}_strength*delay({name}, {name}_delay)" for name in walk.groups_at(k)]
        seen.append((f"net_{one.port}", " + ".join([*terms, one.port])))
        sensors.append(Sensor(f"net_{one.port}", one.force_unit))
    shown = tuple(seen) or plain.observations
    return replace(
        plain,
        title=f"tracked walk of {walk.engine.path.name}",
        model="",
        inputs=inputs,
        parameters=tuple(numbers),
        observations=shown,
        sensors=tuple(sensors),
    )


def _candidates(base: Simulation, walk: Pass, number: int, shapes: tuple[Shape, ...]) -> tuple[Candidate, ...]:
    one = walk.engine.coordinates[number]
    place = Place("port", one.port, ((one.name, one.speed),), (), (), one.unit == "rad")
    every = candidates_of(base, (place,), shapes)
    mine = {f"{name}_{word}" for name in walk.groups_at(number) for word in ("strength", "delay")}
    ours = {shape.name for shape in shapes} - {shape.name for shape in known_shapes()}
    return tuple(
        one
        for one in every
        if (one.kind == "port" and one.name in (*EFFECTS, *ours) and not one.states)
        or (one.kind == "parameter" and one.place in mine)
    )


def _left(walk: Pass, base: Simulation, number: int, angle_noise: Values) -> LeftMoment:
    motion, one = walk.motion, walk.engine.coordinates[number]
    states, inputs = np.hstack([motion.q, motion.v]), np.zeros((len(motion.time), len(base.inputs)))
    points = Points(motion.time, states, inputs)
    known: dict[object, Values] = {}

    def columns(candidate: Candidate, constants: Mapping[str, float]) -> Values:
        key = (candidate.identity, *constants.values())
        if key not in known:
            known[key] = computed(candidate, constants)
        return known[key]

    def computed(candidate: Candidate, constants: Mapping[str, float]) -> Values:
        if candidate.verdict == "wrong_parameter":
            group, _, word = candidate.place.rpartition("_")
            own = walk.groups[group]
            if word == "delay":
                own = np.interp(motion.time - constants["value"], motion.time, own) - own
            return walk.dense(own[:, None])
        extras = replace(points, extras={f"_{name}": value for name, value in constants.items()})
        pieces = [np.broadcast_to(evaluate(base, piece, extras), len(motion.time)) for piece in candidate.pieces]
        return walk.dense(np.column_stack(pieces))

    return LeftMoment(
        one.port,
        walk.times,
        walk.dense(walk.left[:, number]),
        walk.dense(walk.demanded[:, number]),
        angle_noise[:, :, number],
        motion.q[:, number],
        columns,
    )


def _discovery(base: Simulation, joints: list[JointFinding]) -> Discovery:
    """What the joints show, as an answer."""
    named = [(one.joint, one.named, one.rivals) for one in joints if one.named is not None]
    effects, rivals, where, parts = [], [], [], []
    for joint, best, others in named:
        assert best is not None
        effects.append(_effect(base, best, _closed(joint, best)))
        parts.append(best.part)
        where.append(Whereabouts(best.part.candidate.kind, best.part.candidate.place, 1.0 / len(named)))
        rivals += [
            replace(_effect(base, one, float("nan")), tied=best.gained - one.gained < TIE) for one in others[1:4]
        ]
    if not named and joints:
        strongest = max(joints, key=lambda one: one.rivals[0].gained if one.rivals else -np.inf)
        rivals = [_effect(base, one, float("nan")) for one in strongest.rivals[:1]]
    verdict = parts[0].candidate.verdict if parts else "no_gap"
    channels = tuple(f"net_{one.joint.port}" for one in joints)
    units = tuple(sensor.unit for sensor in base.sensors) if joints else ()
    held = _gap(joints, [one.named.predicted if one.named else 0.0 for one in joints])
    train = _gap(joints, [one.named.explained if one.named else 0.0 for one in joints])
    found = Discovery(
        verdict, "", tuple(where), tuple(effects), tuple(rivals), train, held, channels, units, _runs(joints)
    )
    return sentence_of(found, base, tuple(parts))


def _effect(base: Simulation, one: Named, closed: float) -> FoundEffect:
    candidate = one.part.candidate
    return FoundEffect(
        candidate.kind,
        candidate.place,
        candidate.name,
        one.part.term,
        named_estimates(one.part, one.covariance, base),
        closed,
        one.gained,
        bounds=candidate.bounds,
    )


def _closed(joint: LeftMoment, one: Named) -> float:
    return float(1 - np.sum((joint.left - one.predicted) ** 2) / max(np.sum(joint.left**2), 1e-300))


def _gap(joints: list[JointFinding], taken: list[Values | float]) -> GapSize:
    if not joints:
        return GapSize(0.0, 0.0, 0.0)
    sizes = {}
    for one, effect in zip(joints, taken, strict=True):
        before, after = (float(np.sqrt(np.mean(each**2))) for each in (one.joint.left, one.joint.left - effect))
        sizes[f"net_{one.joint.port}"] = (before, after, one.joint.floor)
    spreads = np.array([max(float(np.std(one.joint.demanded)), 1e-9) for one in joints])
    whole = np.sqrt(np.mean((np.array(list(sizes.values())).T / spreads) ** 2, axis=1))
    tests = [one.named.test for one in joints if one.named]
    first = min(tests, key=lambda test: test.p) if tests else None
    before, after, floor = map(float, whole)
    return GapSize(before, after, floor, first.p if first else float("nan"), sizes, first.pieces if first else 0)


def _runs(joints: list[JointFinding]) -> Runs:
    """Both parts of the time, each with what was learned from the other."""
    none = np.empty((0, 0))
    if not joints:
        return Runs(np.zeros(0, int), none, none, none, none, none)
    length = min(len(half) for half in joints[0].joint.halves)
    cut = [half[:length] for half in joints[0].joint.halves]
    every = {
        "measured": [one.joint.demanded for one in joints],
        "simulated": [one.joint.demanded - one.joint.left for one in joints],
        "augmented": [
            one.joint.demanded - one.joint.left + (one.named.predicted if one.named else 0.0) for one in joints
        ],
    }
    stacked = {word: np.array([np.column_stack(some)[half] for half in cut]) for word, some in every.items()}
    time = np.array([joints[0].joint.time[half] for half in cut])
    names = ("first part", "second part")
    return Runs(np.arange(2), time, np.zeros((2, 0)), **stacked, names=names)


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


def _shows(walk: Pass, number: int, found: JointFinding) -> Finding:
    """What a joint can show, and what is left there."""
    one, joint = walk.engine.coordinates[number], found.joint
    unit = one.force_unit
    spring = found.least(walk.dense(walk.motion.q[:, number] - walk.motion.q[:, number].mean()))
    damper = found.least(walk.dense(walk.motion.v[:, number]))
    shares = [
        f"{100 * found.least(walk.dense(walk.groups[name])):.2g} % of its {name.split('_')[-2]} muscles"
        for name in walk.groups_at(number)
    ]
    left = float(np.sqrt(np.mean(joint.left**2)))
    what = (
        f"{one.called}: {left:.3g} {unit} are left of {np.std(joint.demanded):.3g}, noise {joint.floor:.2g}; it shows "
        f"a spring from {spring:.2g} {unit}/{one.unit}, a damper from {damper:.2g} {unit} s/{one.unit}"
        + "".join(f", {each}" for each in shares)
    )
    unexplained = float(np.sqrt(np.mean((joint.left - (found.named.explained if found.named else 0.0)) ** 2)))
    if unexplained > BEYOND * joint.floor and found.named is None:
        return Finding("warning", "without a name", "model", what, "what is left there: nothing weighed explains it")
    return Finding("note", "joint", "model", what, "", one.called)


def _only_residuals(walk: Pass) -> str:
    sizes = [
        f"{amount(float(np.sqrt(np.mean(walk.dense(walk.demanded[:, k]) ** 2))))} {one.force_unit} at {one.called}"
        for k, one in enumerate(walk.engine.coordinates)
        if k in walk.engine.base
    ]
    return (
        "Nothing can be named at a joint: no file gives the muscles' forces, and whatever acts between two segments is "
        f"taken for muscles. Ground and body alone leave {', '.join(sizes)} (root mean square)."
    )
