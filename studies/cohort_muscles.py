"""Do the embedded cohort's muscles behave as people's? EMG between people, its floor, the spring, moments from EMG.

    python studies/cohort_muscles.py [--quick]

studies/results/cohort.md holds the tables that it prints, with what the sources are worth.
"""

from __future__ import annotations

from command_line import QUICK, command_line

GIVEN = command_line(__name__, __doc__, QUICK)  # before the slow imports

import numpy as np
from markdown_table import markdown_table
from numpy.typing import NDArray

from gaitdisc import envelope
from gaitdisc.cohort.cohort import the_twelve
from gaitdisc.cohort.measurement import measure
from gaitdisc.cohort.person import MUSCLES, Spring
from gaitdisc.cohort.walk import TrueWalk, walked

WALK_S = 60.0
SEED = 700
JOINTS = {"hip": (0, 0), "knee": (3, 1), "ankle": (4, 2)}  # column of the angles, of the moments
ELECTRODE_BEFORE_MOMENT_S = 0.05  # electromechanical delay and activation, found by hand
RIDGE = 1e-3


def envelopes(walk: TrueWalk) -> NDArray[np.float64]:
    """EMG envelopes of the right leg as the package makes them (time at 1000 Hz, muscle) [V]."""
    return envelope(measure(walk, "walk", "nominal").stream("emg")).values[:, : len(MUSCLES)]


def alike(curves: NDArray[np.float64]) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
    """How alike people's mean envelopes are: median correlation over pairs, and the coefficient of variation."""
    shapes = curves / curves.mean(axis=1, keepdims=True)  # each profile over its own mean, as Winter and Yack (1987)
    pairs = np.triu_indices(len(curves), 1)
    like = [np.median(np.corrcoef(shapes[:, :, muscle])[pairs]) for muscle in range(curves.shape[2])]
    return np.array(like), np.sqrt(shapes.var(axis=0, ddof=1).mean(axis=0)) / shapes.mean(axis=(0, 1))


def explained(walk: TrueWalk, emg: NDArray[np.float64]) -> dict[str, float]:
    """Held-out R2 of each joint's moment from seven envelopes, that joint's angle and rate, and their products."""
    every, shift = round((len(emg) - 1) / (len(walk.slow_s) - 1)), round(ELECTRODE_BEFORE_MOMENT_S * 1000)
    early = np.roll(emg, shift, axis=0)[::every][: len(walk.slow_s)]
    early = early / early.std(axis=0)
    found = {}
    for joint, (angle, moment) in JOINTS.items():
        flexion = walk.angles[:, 0, angle]
        motion = np.column_stack([flexion, np.gradient(flexion, 0.01)])
        motion = (motion - motion.mean(axis=0)) / motion.std(axis=0)
        x = np.hstack([early, motion, early * motion[:, :1], early * motion[:, 1:], np.ones((len(early), 1))])
        train, held = slice(100, 3 * len(x) // 4), slice(3 * len(x) // 4 + 100, None)
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
    for number, person in enumerate(people, SEED):
        nominal = walked(person, None, duration_s, number)
        free, worn = envelopes(nominal), envelopes(walked(person.adapt_to(Spring()), Spring(), duration_s, number))
        curves.append(nominal.strides(free).mean(axis=0)[:100])
        change.append(worn.mean(axis=0) / free.mean(axis=0) - 1)
        r2.append(list(explained(nominal, free).values()))
    found = {"curves": np.array(curves), "change": np.array(change), "explained": np.array(r2)}
    correlation, variation = alike(found["curves"])
    mean = found["curves"] / found["curves"].max(axis=1, keepdims=True)
    floor = mean.min(axis=1).mean(axis=0)
    print(f"n = {len(people)} people, {duration_s:.0f} s, right side\n")
    rows = []
    for muscle, name in enumerate(MUSCLES):
        by = 100 * found["change"][:, muscle]
        spread = f"{by.mean():+.0f} % ({by.min():+.0f} to {by.max():+.0f})"
        between = (f"{correlation[muscle]:.3f}", f"{variation[muscle]:.2f}", f"{100 * floor[muscle]:.0f} %")
        rows.append((name, *between, spread))
    head = "muscle | correlation between people | coefficient of variation | floor of peak | spring: mean EMG"
    print(markdown_table(head, rows), end="\n\n")
    fits = [
        (joint, f"{np.median(by):.2f} ({by.min():.2f})") for joint, by in zip(JOINTS, np.transpose(r2), strict=True)
    ]
    print(markdown_table("joint | moment from EMG, angle and rate, held-out R2: median (least)", fits))
    return found


if __name__ == "__main__":
    run(GIVEN.quick)
