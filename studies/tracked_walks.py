"""Walks with recorded forces in OpenSim models: what is planted into them, and what `discover` then names.

    python studies/tracked_walks.py WALKS [WALKS ...] [--seed 1] [--seeds 1] [--untouched 1] [--noise 0.3] [--out CSV]

WALKS are a mapping ([tracked], docs/engines.md) and its kinematics, then the next pair. Angles get noise that went
through the low-pass. At each ankle and knee, one at a time: a one-sided spring that takes its moment from the muscles
that pull its way, the stronger muscles' moment late, or less of it; each drawn, 0.6 to 1.4 times 300 (knee 60) N m/rad,
40 ms, 25 %. On each segment of the legs: 0.6 to 1.4 times 3 kg, which the muscles bear in the true motion.
"""

from __future__ import annotations

from pathlib import Path

from command_line import QUICK, argument, command_line

GIVEN = command_line(
    __name__,
    __doc__,
    argument("walks", "mapping and kinematics of a walk, then of the next", nargs="+", type=Path),
    argument("--seed", "the first draw of noise and sizes", 1),
    argument("--seeds", "how many draws", 1),
    argument("--untouched", "how many draws of noise where nothing is planted", 1),
    argument("--noise", "standard deviation of the noise of angles [deg]; 0 where the record has its own", 0.3),
    argument("--out", "CSV that gets the table (default: none)", type=Path),
    QUICK,
)  # before the slow imports

from collections.abc import Iterator
from dataclasses import replace

import numpy as np
import pandas as pd

from gaitdisc.discovery.discover_tracked import search_joints
from gaitdisc.discovery.prescribed import CLOSED, ResidualMoment
from gaitdisc.discovery.tracked_pass import Pass, compute_pass, moments_of_angle_noise, with_angle_noise
from gaitdisc.engines.tracked_mapping import read_tracked

WHITENED_DEG, SIZES = 0.3, (0.6, 1.4)
STIFFNESS, LATE_S, LESS = {"ankle": 300.0, "knee": 60.0}, 0.04, 0.25  # [N m/rad], [s], share: of the middle size
MORE_KG = 3.0
SHAPES = {"spring": "one_sided_spring", "nothing": ""} | dict.fromkeys(("late", "scaled", "mass"), "wrong_parameter")


def run(walk: Pass, seeds: range, untouched: range, noise_deg: float, quick: bool) -> pd.DataFrame:
    """Search a walk with each thing planted, and with nothing."""
    draws, rows = moments_of_angle_noise(walk, WHITENED_DEG), []
    for seed in sorted({*seeds, *untouched}):
        rng = np.random.default_rng([seed, 2026])
        noisy = with_angle_noise(walk, noise_deg, rng) if noise_deg else walk
        hidden = [("nothing", "", np.nan, noisy)] if seed in untouched else []
        hidden += cases(noisy, rng, quick) if seed in seeds else []
        hidden += masses(walk, noisy, rng) if seed in seeds and not quick else []
        for what, place, truth, planted in hidden:
            rows.append({"seed": seed, "hidden": what, "place": place, "truth": truth} | searched(planted, draws))
            rows[-1]["right"] = rows[-1]["named"] == (f"{SHAPES[what]} at {place}" if place else "")
            print(rows[-1], flush=True)
    return pd.DataFrame(rows)


def cases(walk: Pass, rng: np.random.Generator, quick: bool = False) -> Iterator[tuple[str, str, float, Pass]]:
    """What is hidden, where, its number, and the walk with it."""
    for number, one in enumerate(walk.engine.coordinates):
        joint = one.name.partition("_")[0]
        if joint not in STIFFNESS or (quick and one.name != "ankle_angle_r"):
            continue
        stiffness, late_s, strength = rng.uniform(*SIZES, 3) * (STIFFNESS[joint], LATE_S, -LESS) + (0, 0, 1)
        names = [f"{one.name}_{word}_muscles" for word in ("raising", "lowering")]
        strong = max(names, key=lambda name: float(np.mean(walk.groups[name] ** 2)))
        moment, time, angle = walk.groups[strong], walk.motion.time, walk.motion.q[:, number]
        spring = -stiffness * np.maximum(0.0, angle - np.median(angle))
        weaker = {**walk.groups, names[1]: walk.groups[names[1]] - spring}
        yield "spring", one.port, stiffness, replace(with_less(walk, number, spring), groups=weaker)
        late = np.interp(time - late_s, time, moment) - moment
        yield "late", f"{strong}_delay", late_s, with_less(walk, number, late)
        yield "scaled", f"{strong}_strength", strength, with_less(walk, number, (strength - 1) * moment)


def masses(walk: Pass, noisy: Pass, rng: np.random.Generator) -> Iterator[tuple[str, str, float, Pass]]:
    """What a heavier body's muscles bear in the true motion, beside the noisy angles."""
    files = {one.name: one.value for one in walk.engine.parameters}
    for name in sorted(walk.masses_by_joints()):
        more, pulls = MORE_KG * rng.uniform(*SIZES), noisy.pulls.copy()
        pulls[:, 0] += more * walk.demanded_by_mass[name]
        yield "mass", name, files[name] + more, replace(noisy, pulls=pulls)


def with_less(walk: Pass, number: int, moment: np.ndarray) -> Pass:
    """A walk whose muscles give less at a coordinate than its motion demands."""
    pulls = walk.pulls.copy()
    pulls[:, 0, number] -= moment
    return replace(walk, pulls=pulls)


def searched(walk: Pass, draws: np.ndarray) -> dict[str, object]:
    """One search: what it names, and what stands beside."""
    joints = search_joints(walk, draws)[1]
    named = [one.named for one in joints if one.named]
    touched = max(joints, key=lambda one: float(np.mean(one.joint.left**2) / one.joint.floor**2))
    residual = [np.sqrt(np.mean(walk.dense(walk.demanded[:, k]) ** 2)) for k in walk.engine.base]
    numbers = named[0].values if len({one.candidate.place for one in named}) == 1 else {}
    rest = touched.joint.left - (touched.named.predicted if touched.named else 0.0)
    pairs = [(regressed(walk, one.joint) ** 2, float(np.mean(one.joint.left**2))) for one in joints]
    return {
        "named": ", ".join(dict.fromkeys(f"{one.candidate.name} at {one.candidate.place}" for one in named)),
        "value": abs(numbers.get("value", numbers.get("factor", np.nan))),
        "left_nm": float(np.sqrt(np.mean(touched.joint.left**2))),
        "after_nm": float(np.sqrt(np.mean(rest**2))),
        "regression_nm": regressed(walk, touched.joint),
        "regressions": sum(after < (1 - CLOSED) * before for after, before in pairs),
        "pelvis_residual": float(np.max(residual)),
    }


def regressed(walk: Pass, joint: ResidualMoment) -> float:
    """What a plain regression on angle and rate, learned from the other blocks, leaves of a joint's moment [N m]."""
    number = next(k for k, one in enumerate(walk.engine.coordinates) if one.port == joint.port)
    rates = [walk.dense(each[:, number]) for each in (walk.motion.q, walk.motion.v)]
    columns, rest = np.column_stack([np.ones(len(joint.time)), *rates]), np.zeros(len(joint.time))
    for held, learned in joint.blocks:
        rest[held] = joint.left[held] - columns[held] @ np.linalg.lstsq(columns[learned], joint.left[learned])[0]
    return float(np.sqrt(np.mean(rest**2)))


def summary(table: pd.DataFrame) -> pd.DataFrame:
    """How many are right of how many, and medians of what is off [%] and left [N m], by walk and what was hidden."""
    off = 100 * (table["value"] / table["truth"] - 1).abs().where(table["right"])
    something = (table["named"] != "") & ~table["right"]
    groups = table.assign(off=off, wrong=something).groupby(["walk", "hidden"], sort=False)
    counts = groups.agg(n=("right", "size"), right=("right", "sum"), wrong=("wrong", "sum"))
    found = groups.agg(regressions=("regressions", lambda one: int((one > 0).sum())))
    return counts.join(found).join(groups[["off", "left_nm", "after_nm", "regression_nm", "pelvis_residual"]].median())


if __name__ == "__main__":
    tables = []
    for mapping, kinematics in zip(GIVEN.walks[::2], GIVEN.walks[1::2], strict=True):
        tracked, first = read_tracked(mapping), GIVEN.seed
        assert tracked is not None, f"{mapping} has no [tracked]"
        seeds, untouched = range(first, first + GIVEN.seeds), range(first, first + GIVEN.untouched)
        found = run(compute_pass(tracked, kinematics), seeds, untouched, GIVEN.noise, GIVEN.quick)
        tables.append(found.assign(walk=mapping.parent.name))
    table = pd.concat(tables)
    print(table.round(3).to_string(), summary(table).round(3).to_string(), sep="\n")
    if GIVEN.out:
        table.to_csv(GIVEN.out, index=False)
