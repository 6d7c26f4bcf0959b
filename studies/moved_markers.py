"""Markers that slide on their segments, or are lost, on bodies whose angles are known."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, replace
from pathlib import Path

import numpy as np
from markers_to_angles import opensim
from plug_in_gait_angles import people

import gaitdisc as gd
from gaitdisc.kinematics.calibration import Calibration, calibrate_body
from gaitdisc.kinematics.marker_set import METHODS, marker_set
from gaitdisc.kinematics.motion import motion

PART_OF_SKIN = {"pelvis": 0.5, "thigh": 1.0, "shank": 0.5, "foot": 0.25}
COMMON = 0.5
STRIDE_S, LOST_S = 1.0, 0.2
FORWARD = (1.0, 0.0, 0.0)


@dataclass(frozen=True, eq=False)
class Body:
    """A recording, its person, and the markers where rigid segments have them."""

    name: str
    calibration: Calibration
    markers: gd.Recording
    rigid: gd.Recording

    def angles(self, markers: gd.Recording) -> gd.Recording:
        """Angles of other markers of this person."""
        return motion(markers, self.calibration, FORWARD).angles


def bodies(data: Path) -> list[Body]:
    """Each set on the recording it was worn in, with joints free and held."""
    [person] = people(data, ("HC030A",))
    static, walk, _ = opensim(data)
    found, worn = [], ("plug_in_gait", "oxford_foot", "gait2354")
    for chosen, joints in (*((name, "free") for name in worn), ("gait2354", "held")):
        of = (walk, static) if chosen == "gait2354" else (person.walks["straight"], person.static)
        markers, standing = (trial.stream("markers") for trial in of)
        calibration = calibrate_body(standing, marker_set(chosen).with_joints(joints), person.measures)
        found.append(Body(f"{chosen}, {joints}", calibration, markers, rigid(markers, calibration)))
    return found


def rigid(markers: gd.Recording, calibration: Calibration) -> gd.Recording:
    """The markers where their segments have them, joints held together so that no segment leaves its joint."""
    held = replace(calibration, marker_set=calibration.marker_set.with_joints("held"))
    poses = motion(markers, held, FORWARD).poses
    labels, values = labels_of(calibration, markers), np.array(markers.values)
    for segment, body in calibration.body.items():
        for point in (point for point in body if point not in METHODS and point in labels):
            values[:, columns(markers, labels[point])] = poses[segment].to_laboratory(body[point])
    return markers.with_values(values)


def labels_of(calibration: Calibration, markers: gd.Recording) -> Mapping[str, str]:
    """Label of each point of the set that is among the markers."""
    return calibration.marker_set.names([name[:-2] for name in markers.names if name.endswith(".x")])


def columns(markers: gd.Recording, label: str) -> list[int]:
    """The three columns of a marker."""
    return [markers.index(f"{label}.{axis}") for axis in "xyz"]


def slid(body: Body, size_mm: float, random: np.random.Generator) -> gd.Recording:
    """Markers that slide on their segments."""
    labels, values = labels_of(body.calibration, body.rigid), np.array(body.rigid.values)

    def wave() -> np.ndarray:
        harmonics = np.arange(1, 3)[:, None, None] * body.rigid.time[None, :, None] * 2 * np.pi / STRIDE_S
        return np.sin(harmonics + random.uniform(0, 2 * np.pi, (2, 1, 3))).sum(axis=0)

    for segment, points in body.calibration.body.items():
        size = size_mm / 1000 * PART_OF_SKIN[segment.split("_")[0]]
        common = wave()
        for point in (point for point in points if point not in METHODS and point in labels):
            sliding = np.sqrt(COMMON) * common + np.sqrt(1 - COMMON) * wave()
            values[:, columns(body.rigid, labels[point])] += size * sliding
    return body.rigid.with_values(values)


def lost(body: Body, share: float, random: np.random.Generator) -> gd.Recording:
    """The real markers with a share of samples missing, 0.2 s at a time."""
    values, length = np.array(body.markers.values), round(LOST_S * body.markers.rate_hz)
    for label in labels_of(body.calibration, body.markers).values():
        missing = np.zeros(len(values), bool)
        for first in random.integers(0, len(values), random.poisson(share / 100 * len(values) / length)):
            missing[first : first + length] = True
        values[np.flatnonzero(missing)[:, None], columns(body.markers, label)] = np.nan
    return body.markers.with_values(values)
