"""Joint angles from the markers of real people against those that Plug-in Gait wrote into the same files."""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path

import numpy as np
from plug_in_gait_bones import static_file

import gaitdisc as gd
from gaitdisc.ingest.c3d_parameters import read_body_measures
from gaitdisc.kinematics.calibration import calibrate_body
from gaitdisc.kinematics.marker_set import marker_set
from gaitdisc.kinematics.motion import motion
from gaitdisc.recording.trial import BodyMeasures

Row = tuple[str, ...]
WRITTEN_WITH, HELD_BACK = ("HC002D", "HC030A", "HC031A", "HC032A"), ("HC033A", "HC036A")
JOINT_ANGLES = {  # ours, without its side: the axis of Plug-in Gait's label, and the goal [deg]
    "hip_flexion": ("HipAngles.x", 2), "hip_adduction": ("HipAngles.y", 4), "hip_rotation": ("HipAngles.z", 4),
    "knee_angle": ("KneeAngles.x", 2), "knee_adduction": ("KneeAngles.y", 4), "knee_rotation": ("KneeAngles.z", 4),
    "ankle_angle": ("AnkleAngles.x", 2), "ankle_rotation": ("AnkleAngles.z", 4),
}  # fmt: skip
LEVEL_ANGLES = {  # against the laboratory: label, sign of ours in it, goal
    "pelvis_tilt": ("RPelvisAngles.x", -1, 2), "pelvis_list": ("LPelvisAngles.y", 1, 4),
    "pelvis_rotation": ("RPelvisAngles.z", 1, 4), "foot_progression_angle_r": ("RFootProgressAngles.z", 1, 4),
    "foot_progression_angle_l": ("LFootProgressAngles.z", 1, 4),
}  # fmt: skip


@dataclass(frozen=True, eq=False)
class Person:
    """The recordings of one person."""

    name: str
    static: gd.Trial
    walks: dict[str, gd.Trial]
    measures: BodyMeasures


def people(data: Path, names: tuple[str, ...]) -> list[Person]:
    """Static trial, straight walk, turn and measures of each."""
    found = []
    with gd.C3DReader() as reader:
        for name in names:
            walks, static = data / "gait" / "young_straight_and_turn" / name, static_file(data / "gait", name)
            trials = {kind: gd.read(next(walks.glob(f"{kind}/*.c3d")), reader=reader) for kind in ("straight", "turn")}
            found.append(Person(name, gd.read(static, reader=reader), trials, read_body_measures(static)))
    return found


def nearest_axis(direction: np.ndarray) -> tuple[float, ...]:
    """The axis of the laboratory that Plug-in Gait takes for the direction of walking."""
    axis = int(np.argmax(np.abs(direction)))
    return tuple(float(np.sign(direction[axis])) * np.eye(3)[axis])


def theirs(trial: gd.Trial, ours: str) -> np.ndarray:
    """An angle of the file, with our sign."""
    angles = trial.stream("kinematics")
    if ours in LEVEL_ANGLES:
        label, sign, _ = LEVEL_ANGLES[ours]
        return sign * angles[label]
    label = f"{ours[-1].upper()}{JOINT_ANGLES[ours[:-2]][0]}"
    return angles[ours] if ours in angles.names else angles[label]


def curves(person: Person, chosen: str, kind: str) -> dict[str, tuple[np.ndarray, np.ndarray]]:
    """Ours and theirs over a walk; joint angles without the difference of the static trial.

    chosen: a set that comes along; `plug_in_gait, harrington` has Harrington's hips in place of Plug-in Gait's own
    """
    plain, _, hip = chosen.partition(", ")
    worn = marker_set(plain).with_hip(hip) if hip else marker_set(plain)
    calibration = calibrate_body(person.static.stream("markers"), worn, person.measures)
    walk, markers = person.walks[kind], person.walks[kind].stream("markers")
    forward = nearest_axis(motion(markers, calibration).walking.rotation[0, :, 0])
    ours = motion(markers, calibration, forward).angles
    still = motion(person.static.stream("markers"), calibration).angles
    found = {}
    for name in (f"{joint}_{side}" for joint in JOINT_ANGLES for side in "rl"):
        offset = float(np.nanmedian(still[name] - theirs(person.static, name)))
        found[name] = ours[name] - offset, theirs(walk, name)
    if kind == "straight":  # on a turn the two take another direction of walking
        found |= {name: (ours[name], theirs(walk, name)) for name in LEVEL_ANGLES}
    return found


def drawn_curves(person: Person) -> dict[str, tuple[np.ndarray, np.ndarray]]:
    """Curves of the straight walk that are drawn: the right leg, and the pelvis."""
    pairs = curves(person, "plug_in_gait", "straight")
    rows = [*(f"{joint}_r" for joint in JOINT_ANGLES), *(name for name in LEVEL_ANGLES if name[-2:] != "_l")]
    return {name: pairs[name] for name in rows}


def rms(pair: tuple[np.ndarray, np.ndarray]) -> float:
    """Root mean square difference [deg]."""
    return float(np.sqrt(np.nanmean((pair[0] - pair[1]) ** 2)))


def against_plug_in_gait(several: list[Person], chosen: str) -> list[Row]:
    """Median and largest difference over legs and people, each kind of walk; the two held back apart."""
    found = {(p.name, kind): curves(p, chosen, kind) for p in several for kind in ("straight", "turn")}
    rows = []
    for joint, (*_, goal) in {**JOINT_ANGLES, **LEVEL_ANGLES}.items():
        cells = []
        for kind in ("straight", "turn"):
            for group in (WRITTEN_WITH, HELD_BACK, WRITTEN_WITH + HELD_BACK):
                errors = [
                    rms(pair) for (name, walked), pairs in found.items() if walked == kind and name in group
                    for angle, pair in pairs.items() if angle == joint or angle[:-2] == joint
                ]  # fmt: skip
                cells.append(f"{np.median(errors):.2f} ({max(errors):.2f})" if errors else "-")
        rows.append((joint, f"{goal:g}", *cells))
    return rows
