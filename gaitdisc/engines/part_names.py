"""Names of a model's parts as they may stand in an expression."""

from __future__ import annotations

import keyword
import re
from collections.abc import Collection

from gaitdisc.simulation.expression import RESERVED

LONGEST = 40  # characters, which leaves room for what a kind of number is called behind it


def part_name(called: str, kind: str, taken: Collection[str] = ()) -> str:
    """Name for a part of a model: letters, digits and _; of one whose name is taken, its kind stands behind it.

    >>> part_name("knee-angle r", "joint"), part_name("lambda", "joint"), part_name("1st", "motor")
    ('knee_angle_r', 'lambda_joint', 'motor_1st')
    >>> part_name("elbow", "control", {"elbow"}), part_name("elbow", "control", {"elbow", "elbow_control"})
    ('elbow_control', 'elbow_control_2')
    """
    name = re.sub(r"[^A-Za-z0-9_]", "_", called)[:LONGEST]
    if not re.match("[A-Za-z]", name):
        name = f"{kind}_{name.lstrip('_')}"
    if keyword.iskeyword(name) or name in RESERVED or name in taken:
        name = f"{name}_{kind}"
    free, number = name, 1
    while free in taken:
        number += 1
        free = f"{name}_{number}"
    return free


def new_name(called: str, kind: str, taken: set[str]) -> str:
    """Name of a part, which is taken from then on."""
    name = part_name(called, kind, taken)
    taken.add(name)
    return name
