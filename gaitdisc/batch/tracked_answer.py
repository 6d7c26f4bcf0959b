"""What the joints of a recorded walk show, as a discovery: effects, rivals, the gap before and after."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
from numpy.typing import NDArray

from gaitdisc.discovery.criteria import CRITERIA
from gaitdisc.discovery.estimates import named_estimates
from gaitdisc.discovery.prescribed import JointFinding, Named
from gaitdisc.discovery.wording import sentence_of
from gaitdisc.results.discovery import Discovery, FoundEffect, GapSize, Runs, Whereabouts
from gaitdisc.results.effect_words import amount, at_place, spoken
from gaitdisc.simulation.simulation import Simulation

Values = NDArray[np.float64]


def discovery_of(base: Simulation, joints: list[JointFinding]) -> Discovery:
    """Return what the joints show, as an answer."""
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
    candidate = one.part.candidate
    place = candidate.kind, candidate.place, candidate.name
    numbers = named_estimates(one.part, one.covariance, base)
    return FoundEffect(*place, one.part.term, numbers, closed, one.gained, bounds=candidate.bounds)


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
    """The whole walk, each block of its time with what was learned from the rest."""
    none = np.empty((0, 0))
    if not joints:
        return Runs(np.zeros(0, int), none, none, none, none, none)
    each = [one.joint for one in joints]
    measured = np.column_stack([one.demanded for one in each])
    simulated = measured - np.column_stack([one.left for one in each])
    named = np.column_stack([one.named.predicted if one.named else 0.0 * one.joint.left for one in joints])
    whole = [one[None] for one in (measured, simulated, simulated + named)]
    return Runs(np.arange(1), each[0].time[None], np.zeros((1, 0)), *whole, names=("whole walk",))
