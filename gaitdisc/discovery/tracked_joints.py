"""What is left of each joint of a recorded walk, searched for a name."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import replace

import numpy as np
from numpy.typing import NDArray

from gaitdisc.discovery.candidate import Candidate, candidates_of
from gaitdisc.discovery.catalogue import ALL, Request, Shape, known_shapes
from gaitdisc.discovery.joint_and_trials import EFFECTS, STRENGTH
from gaitdisc.discovery.places import Place
from gaitdisc.discovery.prescribed import JointFinding, ResidualMoment, joint_finding
from gaitdisc.discovery.record_filter import DENSE
from gaitdisc.discovery.tracked_pass import Pass
from gaitdisc.engines.mapping import drafted
from gaitdisc.errors import SamplingError
from gaitdisc.recording import Finding
from gaitdisc.simulation.evaluating import Points, evaluate
from gaitdisc.simulation.parts import Input, Parameter, Sensor
from gaitdisc.simulation.simulation import Simulation

Values = NDArray[np.float64]
FEWEST = 20  # samples that hold what passes the low-pass
BEYOND = 3.0  # times the noise of a joint, from which what is left is worth a word


def joints_of(walk: Pass, angle_noise: Values, request: Request = ALL) -> tuple[Simulation, list[JointFinding]]:
    """Name what is left at each joint beside what noise makes of it; the simulation says what the numbers are."""
    if len(walk.times) < FEWEST:
        raise SamplingError(
            f"what is left is named from {FEWEST / DENSE / walk.cutoff_hz:.2g} s or more at a low-pass of "
            f"{walk.cutoff_hz:g} Hz",
            f"motion and forces share {np.ptp(walk.motion.time):.2g} s",
            "Record longer.",
        )
    base = _simulation(walk)
    candidates = _candidates(base, walk, request.shapes)
    joints = []
    for number in walk.joints:
        request.progress(f"weighing what is left at {walk.engine.coordinates[number].called}")
        joint = _left(walk, base, number, angle_noise)
        joints.append(joint_finding(joint, candidates[number], len(walk.joints)))
    return base, joints


def _simulation(walk: Pass) -> Simulation:
    """The walk as a simulation: what its muscles' groups may do otherwise, and a port at each joint."""
    plain, numbers = drafted(walk.engine), []
    for name in walk.groups:
        numbers.append(Parameter(f"{name}_strength", 1.0, "1", 1 - STRENGTH, 1 + STRENGTH, "against the file's forces"))
        numbers.append(Parameter(f"{name}_delay", 0.0, "s", meaning="by which they act later than in the file"))
    seen, sensors = [], []
    for k in walk.joints:
        one = walk.engine.coordinates[k]
        terms = [f"{name}_strength*delay({name}, {name}_delay)" for name in walk.groups_at(k)]
        seen.append((f"net_{one.port}", " + ".join([*terms, one.port])))
        sensors.append(Sensor(f"net_{one.port}", one.force_unit))
    return replace(
        plain,
        title=f"tracked walk of {walk.engine.path.name}",
        model="",
        inputs=tuple(Input(name, "N m", "of the forces' file") for name in walk.groups),
        parameters=tuple(numbers),
        observations=tuple(seen) or plain.observations,
        sensors=tuple(sensors),
    )


def _candidates(base: Simulation, walk: Pass, more: tuple[Shape, ...]) -> dict[int, tuple[Candidate, ...]]:
    """What may act at each joint: a device's shapes at its port, its muscles stronger or later, effects of the user."""
    joints = {k: walk.engine.coordinates[k] for k in walk.joints}
    places = [Place("port", one.port, ((one.name, one.speed),), (), (), one.unit == "rad") for one in joints.values()]
    every = candidates_of(base, tuple(places), (*known_shapes(), *more))
    effects = {*EFFECTS, *(shape.name for shape in more)}
    possible = [one for one in every if one.kind == "parameter" or (one.name in effects and not one.states)]
    found = {}
    for k, one in joints.items():
        mine = {one.port, *(f"{name}_{word}" for name in walk.groups_at(k) for word in ("strength", "delay"))}
        found[k] = tuple(each for each in possible if each.place in mine)
    return found


def _left(walk: Pass, base: Simulation, number: int, angle_noise: Values) -> ResidualMoment:
    motion, one = walk.motion, walk.engine.coordinates[number]
    points = Points(motion.time, np.hstack([motion.q, motion.v]), np.zeros((len(motion.time), len(base.inputs))))
    known: dict[object, Values] = {}

    def columns(candidate: Candidate, constants: Mapping[str, float]) -> Values:
        key = (candidate.identity, *constants.values())
        if key not in known:
            known[key] = walk.dense(acting(candidate, constants))
        return known[key]

    def acting(candidate: Candidate, constants: Mapping[str, float]) -> Values:
        if candidate.verdict == "wrong_parameter":
            group, _, word = candidate.place.rpartition("_")
            own = walk.groups[group]
            if word == "delay":
                own = np.interp(motion.time - constants["value"], motion.time, own) - own
            return own[:, None]
        extras = replace(points, extras={f"_{name}": value for name, value in constants.items()})
        pieces = [np.broadcast_to(evaluate(base, piece, extras), len(motion.time)) for piece in candidate.pieces]
        return np.column_stack(pieces)

    return ResidualMoment(
        one.port,
        walk.times,
        walk.dense(walk.left[:, number]),
        walk.dense(walk.demanded[:, number]),
        angle_noise[:, :, number],
        motion.q[:, number],
        columns,
    )


def shown_by(walk: Pass, number: int, found: JointFinding) -> Finding:
    """Return what a joint can show, and what is left there."""
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


def doubts(shown: list[Finding]) -> list[Finding]:
    """Warn where joints are left far beyond their noise and have no name: the forces may answer another motion."""
    unnamed = [one for one in shown if one.severity == "warning"]
    if not unnamed:
        return []
    what = (
        f"{len(unnamed)} of {len(shown)} joints have no name for what is left, {BEYOND:g} times their noise or more: "
        "the forces may have been computed for another motion, or for angles of another low-pass (lowpass_hz)"
    )
    return [Finding("warning", "forces in doubt", "model", what, "what is named at the other joints")]
