"""Do the embedded cohort's muscles behave as people's? EMG between people, its floor, the spring, moments from EMG.

    python studies/cohort_muscles.py [--quick]

docs/cohort.md holds the tables that it prints, with what the sources are worth.
"""

from __future__ import annotations

from command_line import QUICK, command_line

GIVEN = command_line(__name__, __doc__, QUICK)  # before the slow imports

import numpy as np
from numpy.typing import NDArray

from gaitdisc import envelope
from gaitdisc.cohort.cohort import the_twelve
from gaitdisc.cohort.measurement import measured
from gaitdisc.cohort.person import MUSCLES, Person, Spring
from gaitdisc.cohort.walk import TrueWalk, walked

WALK_S = 60.0
SEED = 700
JOINTS = {"hip": (0, 0), "knee": (3, 1), "ankle": (4, 2)}  # column of the angles, of the moments
ELECTRODE_BEFORE_MOMENT_S = 0.05  # electromechanical delay and activation, found by hand
RIDGE = 1e-3


def envelopes(walk: TrueWalk) -> NDArray[np.float64]:
    """EMG envelopes of the right leg as the package makes them (time at 1000 Hz, muscle) [V]."""
    return envelope(measured(walk, "walk", "nominal").stream("emg")).values[:, : len(MUSCLES)]


def alike(curves: NDArray[np.float64]) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
    """How alike people's mean envelopes are: median correlation over pairs, and the coefficient of variation."""
    shapes = curves / curves.mean(axis=1, keepdims=True)  # each profile over its own mean, as Winter and Yack (1987)
    pairs = np.triu_indices(len(curves), 1)
    like = [np.median(np.corrcoef(shapes[:, :, muscle])[pairs]) for muscle in range(curves.shape[2])]
    return np.array(like), np.sqrt(shapes.var(axis=0, ddof=1).mean(axis=0)) / shapes.mean(axis=(0, 1))


def explained(walk: TrueWalk, emg: NDArray[np.float64]) -> dict[str, float]:
    """Held-out R2 of each joint's moment from seven envelopes, that joint's angle and rate, and their products."""
    every = round((len(emg) - 1) / (len(walk.slow_s) - 1))
    shift = round(ELECTRODE_BEFORE_MOMENT_S * 1000)
    early = np.roll(emg, shift, axis=0)[::every][: len(walk.slow_s)]
    early = early / early.std(axis=0)
    found = {}
    for joint, (angle, moment) in JOINTS.items():
        flexion = walk.angles[:, 0, angle]
        rate = np.gradient(flexion, 0.01)
        motion = np.column_stack([flexion, rate])
        motion = (motion - motion.mean(axis=0)) / motion.std(axis=0)
        x = np.hstack([early, motion, early * motion[:, :1], early * motion[:, 1:], np.ones((len(early), 1))])
        train = slice(100, 3 * len(x) // 4)
        held = slice(3 * len(x) // 4 + 100, None)
        y = walk.moments[:, 0, moment]
        left, right = x[train].T @ x[train], x[train].T @ y[train]
        weights = np.linalg.solve(left + RIDGE * len(x) * np.eye(x.shape[1]), right)
        off = y[held] - x[held] @ weights
        found[joint] = 1 - float(np.sum(off**2) / np.sum((y[held] - y[held].mean()) ** 2))
    return found


def run(quick: bool = False) -> dict[str, NDArray[np.float64]]:
    """Walk the twelve, print the table of muscles and that of moments, and return what was found."""
    people, duration_s = (the_twelve()[:3], 20.0) if quick else (the_twelve(), WALK_S)
    curves, change, r2 = [], [], []
    for number, person in enumerate(people):
        curve, changed, fit = _of(person, duration_s, SEED + number)
        curves.append(curve)
        change.append(changed)
        r2.append(fit)
    found = {"curves": np.array(curves), "change": np.array(change), "explained": np.array(r2)}
    correlation, variation = alike(found["curves"])
    mean = found["curves"] / found["curves"].max(axis=1, keepdims=True)
    floor = mean.min(axis=1).mean(axis=0)
    print(f"n = {len(people)} people, {duration_s:.0f} s, right side\n")
    print("| muscle | correlation between people | coefficient of variation | floor of peak | spring: mean EMG |")
    print("|---|---|---|---|---|")
    for muscle, name in enumerate(MUSCLES):
        by = found["change"][:, muscle]
        spread = f"{100 * by.mean():+.0f} % ({100 * by.min():+.0f} to {100 * by.max():+.0f})"
        between = f"{correlation[muscle]:.3f} | {variation[muscle]:.2f}"
        print(f"| {name} | {between} | {100 * floor[muscle]:.0f} % | {spread} |")
    print("\n| joint | moment from EMG, angle and rate, held-out R2: median (least) |\n|---|---|")
    for column, joint in enumerate(JOINTS):
        by = found["explained"][:, column]
        print(f"| {joint} | {np.median(by):.2f} ({by.min():.2f}) |")
    return found


def _of(person: Person, duration_s: float, seed: int) -> tuple[NDArray[np.float64], NDArray[np.float64], list[float]]:
    """Mean envelopes, relative change of the mean EMG with the spring, and R2 of the moments."""
    nominal = walked(person, None, duration_s, seed)
    exo = walked(person.adapted_to(Spring()), Spring(), duration_s, seed)
    free, worn = envelopes(nominal), envelopes(exo)
    change = worn.mean(axis=0) / free.mean(axis=0) - 1
    return nominal.mean_stride(free)[:100], change, list(explained(nominal, free).values())


if __name__ == "__main__":
    run(GIVEN.quick)
