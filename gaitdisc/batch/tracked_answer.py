"""What the joints of a recorded walk show, as a discovery: effects, rivals, the gap before and after."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
from numpy.typing import NDArray

from gaitdisc.discovery.criteria import CRITERIA
from gaitdisc.discovery.estimates import named_estimates
from gaitdisc.discovery.prescribed import JointFinding, LeftMoment, Named
from gaitdisc.discovery.wording import sentence_of
from gaitdisc.results.discovery import Discovery, FoundEffect, GapSize, Runs, Whereabouts
from gaitdisc.simulation.simulation import Simulation

Values = NDArray[np.float64]


def discovery_of(base: Simulation, joints: list[JointFinding]) -> Discovery:
    """Return what the joints show, as an answer."""
    named = [(one.joint, one.named, one.rivals) for one in joints if one.named is not None]
    effects, rivals, where, parts = [], [], [], []
    for joint, best, others in named:
        assert best is not None
        effects.append(_effect(base, best, _closed(joint, best)))
        parts.append(best.part)
        where.append(Whereabouts(best.part.candidate.kind, best.part.candidate.place, 1.0 / len(named)))
        rivals += [
            replace(_effect(base, one, float("nan")), tied=best.gained - one.gained < CRITERIA.tie)
            for one in others[1:4]
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
