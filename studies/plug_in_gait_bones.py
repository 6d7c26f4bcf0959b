"""Segments as Plug-in Gait itself put them into a C3D file: kinetics alone, whatever makes the poses elsewhere."""

from __future__ import annotations

from pathlib import Path

import numpy as np

import gaitdisc as gd
from gaitdisc.kinematics.pose import Pose
from gaitdisc.kinetics.newton_euler import nearest_rotations
from gaitdisc.kinetics.plate_steps import FootPath, foot_paths
from gaitdisc.signals.direction import marker_position

WALKERS = ("HC002D", "HC030A", "HC031A", "HC032A", "HC033A", "HC036A")
TRUNK = ("C7", "T10", "CLAV", "STRN")
HEELS, TOES = {"r": "RHEE", "l": "LHEE"}, {"r": "RTOE", "l": "LTOE"}


def feet(trial: gd.Trial) -> dict[str, FootPath]:
    """Paths of both feet by their markers."""
    return foot_paths(trial.stream("markers"), HEELS, TOES)


def static_file(gait: Path, person: str) -> Path:
    """Static trial of a person, which lies in one of two folders."""
    folders = gait / "young_static" / person, gait / "young_straight_and_turn" / person / "static"
    return next(file for folder in folders for file in folder.glob("*.c3d"))


def bones(trial: gd.Trial) -> dict[str, Pose]:
    """Poses of pelvis, thighs, shanks, feet from the points O (origin), A, L, P (forward, left, proximal) of each."""
    markers = trial.stream("markers")

    def frame(name):
        origin = marker_position(markers, f"{name}O")
        return origin, *((marker_position(markers, f"{name}{axis}") - origin) for axis in "ALP")

    def pose(origin, forward, up, left):
        axes = np.stack([forward, up, -left], axis=2)
        return Pose(origin, nearest_rotations(axes / np.linalg.norm(axes, axis=1, keepdims=True)))

    origin, ahead, left, up = frame("PEL")
    poses = {"pelvis": pose(origin, ahead, up, left)}
    for side in "lr":
        knee, ahead, left, up = frame(f"{side.upper()}FE")
        poses[f"thigh_{side}"] = pose(knee + up, ahead, up, left)
        ankle, ahead, left, up = frame(f"{side.upper()}TI")
        poses[f"shank_{side}"] = pose(knee, ahead, up, left)
        _, dorsal, left, heelwards = frame(f"{side.upper()}FO")
        poses[f"foot_{side}"] = pose(ankle, -heelwards, dorsal, left)
    return poses
