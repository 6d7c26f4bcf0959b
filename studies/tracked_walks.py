"""Walks with recorded forces in OpenSim models: what is planted into them, and what `discover` then names.

    python studies/tracked_walks.py WALKS [WALKS ...] [--seeds 1] [--noise 0.3] [--out OUT.csv] [--quick]

WALKS are a mapping and its kinematics, then the next pair. Each mapping names ground forces and the forces of static
optimisation, or of computed muscle control, for its walk (docs/engines.md, `[tracked]`). Angles get noise that went
through the 6 Hz low-pass (seed 1 and on, never the draws that the search whitens with). Then at each ankle and knee,
one at a time: a one-sided spring that takes its moment from the muscle group that pulls its way, the stronger group's
moment 40 ms late, or 25 % less of it. Untouched: each walk, and its halves where they are long enough. Beside: the
largest residual at the joint with the ground, which is all that residual reduction has to work on, and a plain
regression of what is left on angle and rate, learned from the other half.
"""

from __future__ import annotations

from pathlib import Path

from command_line import QUICK, argument, command_line

GIVEN = command_line(
    __name__,
    __doc__,
    argument("walks", "mapping and kinematics of a walk, then of the next", nargs="+", type=Path),
    argument("--seeds", "how many draws of noise", 1),
    argument("--noise", "standard deviation of the noise of angles [deg]; 0 where the record has its own", 0.3),
    argument("--out", "CSV that gets the table (default: none)", type=Path),
    QUICK,
)  # before the slow imports

from collections.abc import Iterator
from dataclasses import replace

import numpy as np
import pandas as pd
from scipy.signal import butter, sosfiltfilt

from gaitdisc.batch.tracked_joints import FEWEST, joints_of
from gaitdisc.batch.tracked_pass import Pass, moments_of_angle_noise, tracked_pass
from gaitdisc.discovery.prescribed import CLOSED, LeftMoment
from gaitdisc.engines.tracked_files import read_tracked
from gaitdisc.signals.derivatives import differentiated

LATE_S, STRENGTH, WHITENED_DEG = 0.04, 0.75, 0.3
STIFFNESS = {"ankle": 300.0, "knee": 60.0}  # [N m/rad]
HIDDEN = ("spring", "late", "scaled")


def run(walks: list[tuple[Path, Path]], seeds: int, noise_deg: float, quick: bool) -> pd.DataFrame:
    """Search every walk, untouched and with each thing planted."""
    rows = []
    for mapping, kinematics in walks:
        tracked = read_tracked(mapping)
        assert tracked is not None, f"{mapping} has no [tracked]"
        walk = tracked_pass(tracked, kinematics)
        draws = moments_of_angle_noise(walk, WHITENED_DEG)
        for seed in range(1, seeds + 1):
            noisy = shaken(walk, noise_deg, seed) if noise_deg else walk
            for hidden, port, truth, planted in cases(noisy, quick):
                rows.append(
                    {
                        "walk": mapping.parent.name,
                        "seed": seed,
                        **searched(planted, draws[:, -len(planted.times) :], hidden, port, truth),
                    }
                )
                print(rows[-1], flush=True)
    return pd.DataFrame(rows)


def shaken(walk: Pass, noise_deg: float, seed: int) -> Pass:
    """A walk whose angles have the noise of markers."""
    motion, rate = walk.motion, walk.motion.rate_hz
    spare, sections = int(rate), butter(4, walk.cutoff_hz, fs=rate, output="sos")
    sizes = [np.radians(noise_deg) if one.unit == "rad" else noise_deg / 300 for one in walk.engine.coordinates]
    white = np.random.default_rng([seed, 2026]).normal(size=(len(motion.time) + 2 * spare, len(sizes)))
    noise = sosfiltfilt(sections, white, axis=0)
    noise *= sizes / noise.std(axis=0)
    q, v, a = (
        each[spare : spare + len(motion.time)] for each in (noise, *(differentiated(noise, rate, k) for k in (1, 2)))
    )
    moved = replace(motion, q=motion.q + q, v=motion.v + v, a=motion.a + a)
    return replace(walk, motion=moved, demanded=walk.engine.demanded(moved.time, (moved.q, moved.v, moved.a)))


def cases(walk: Pass, quick: bool) -> Iterator[tuple[str, str, float, Pass]]:
    """What is hidden, where, its number, and the walk with it."""
    yield "nothing", "", np.nan, walk
    middle = len(walk.motion.time) // 2
    for half in (slice(0, middle), slice(middle, None)):
        part = part_of(walk, half)
        if len(part.times) >= FEWEST:
            yield "nothing", "", np.nan, part
    for number, one in enumerate(walk.engine.coordinates):
        joint = one.name.partition("_")[0]
        if joint not in STIFFNESS or (quick and one.name != "ankle_angle_r"):
            continue
        names = [f"{one.name}_{word}_muscles" for word in ("raising", "lowering")]
        strong = max(names, key=lambda name: float(np.mean(walk.groups[name] ** 2)))
        moment, time = walk.groups[strong], walk.motion.time
        angle = walk.motion.q[:, number]
        spring = -STIFFNESS[joint] * np.maximum(0.0, angle - np.median(angle))
        weaker = {names[1]: walk.groups[names[1]] - spring}
        yield (
            "spring",
            one.port,
            STIFFNESS[joint],
            replace(with_less(walk, number, spring), groups={**walk.groups, **weaker}),
        )
        late = np.interp(time - LATE_S, time, moment) - moment
        yield "late", f"{strong}_delay", LATE_S, with_less(walk, number, late)
        yield "scaled", f"{strong}_strength", STRENGTH, with_less(walk, number, (STRENGTH - 1) * moment)


def part_of(walk: Pass, some: slice) -> Pass:
    """Some of the time of a walk."""
    motion = walk.motion
    arrays = {name: getattr(motion, name)[some] for name in ("time", "q", "v", "a", "forces")}
    groups = {name: moment[some] for name, moment in walk.groups.items()}
    return replace(
        walk,
        motion=replace(motion, **arrays),
        demanded=walk.demanded[some],
        pulls=walk.pulls[some],
        groups=groups,
    )


def with_less(walk: Pass, number: int, moment: np.ndarray) -> Pass:
    """A walk whose muscles give less at a coordinate than its motion demands."""
    pulls = walk.pulls.copy()
    pulls[:, 0, number] -= moment
    return replace(walk, pulls=pulls)


def searched(walk: Pass, draws: np.ndarray, hidden: str, port: str, truth: float) -> dict[str, object]:
    """One search: what it names beside what is true."""
    _, joints = joints_of(walk, draws)
    named = [(one.named.part.candidate.place, one.named.part.candidate.name, one) for one in joints if one.named]
    right = {"spring": "one_sided_spring", "late": "wrong_parameter", "scaled": "wrong_parameter", "nothing": ""}[
        hidden
    ]
    mine = next((one for place, name, one in named if (place, name) == (port, right)), None)
    value = np.nan
    if mine is not None and mine.named is not None:
        values = mine.named.part.values
        value = -values["factor"] if hidden == "spring" else values["value"]
    touched = max(joints, key=lambda one: float(np.mean(one.joint.left**2) / one.joint.floor**2)).joint
    residual = [np.sqrt(np.mean(walk.dense(walk.demanded[:, k]) ** 2)) for k in walk.engine.base]
    return {
        "hidden": hidden,
        "place": port,
        "right": bool(mine) if hidden != "nothing" else not named,
        "elsewhere": len(named) - bool(mine),
        "truth": truth,
        "value": value,
        "named": ", ".join(f"{name} at {place}" for place, name, _ in named),
        "left_nm": float(np.sqrt(np.mean(touched.left**2))),
        "after_nm": float(np.sqrt(np.mean((touched.left - mine.named.predicted) ** 2)))
        if mine and mine.named
        else np.nan,
        "regression_nm": regressed(walk, touched),
        "regressions_named": sum(plain_name(walk, one.joint) for one in joints),
        "pelvis_residual": float(np.max(residual)),
        "joints": len(joints),
    }


def regressed(walk: Pass, joint: LeftMoment) -> float:
    """What a plain regression on angle and rate, learned from the other half, leaves of a joint's moment [N m]."""
    number = next(k for k, one in enumerate(walk.engine.coordinates) if one.port == joint.port)
    columns = np.column_stack(
        [np.ones(len(joint.time)), *(walk.dense(each[:, number]) for each in (walk.motion.q, walk.motion.v))]
    )
    rest = np.zeros(len(joint.time))
    for held, learned in joint.blocks:
        factors = np.linalg.lstsq(columns[learned], joint.left[learned], rcond=None)[0]
        rest[held] = joint.left[held] - columns[held] @ factors
    return float(np.sqrt(np.mean(rest**2)))


def plain_name(walk: Pass, joint: LeftMoment) -> bool:
    """Whether the plain regression takes as much of a joint's moment on held-out time as a name has to."""
    return regressed(walk, joint) ** 2 < (1 - CLOSED) * float(np.mean(joint.left**2))


def summary(table: pd.DataFrame) -> pd.DataFrame:
    """How many are right of how many, and the moments left [N m], by what was hidden."""
    rows = table.assign(off=100 * (table["value"] / table["truth"] - 1).abs())
    groups = rows.groupby("hidden", sort=False)
    counts = groups.agg(
        n=("right", "size"),
        right=("right", "sum"),
        elsewhere=("elsewhere", "sum"),
        regressions=("regressions_named", "sum"),
    )
    return counts.join(groups[["off", "left_nm", "after_nm", "regression_nm", "pelvis_residual"]].median())


if __name__ == "__main__":
    pairs = list(zip(GIVEN.walks[::2], GIVEN.walks[1::2], strict=True))
    table = run(pairs, GIVEN.seeds, GIVEN.noise, GIVEN.quick)
    print(table.round(3).to_string(), summary(table).round(3).to_string(), sep="\n")
    if GIVEN.out:
        table.to_csv(GIVEN.out, index=False)
