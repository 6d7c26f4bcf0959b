"""Joint angles of segments whose poses a system without markers gives: no static trial, no joint centre is needed."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
from numpy.typing import NDArray
from scipy.spatial.transform import Rotation

from gaitdisc.errors import ChannelError, ShapeError
from gaitdisc.kinematics.laboratory import check_right_handed, up_axis, walking_frame
from gaitdisc.kinematics.motion import angles_of_poses
from gaitdisc.kinematics.pose import SEGMENTS, Pose
from gaitdisc.recording import Finding, Recording

LABELS = {"pelvis": "pelvis"} | {
    f"{part}_{side}": f"{side}_{part}" for part in ("thigh", "shank", "foot") for side in "lr"
}
TURN = np.array([1, 2, 0])  # x to the right, y forward, z up of Theia3D, as x forward, y up, z to the right
SKEWED = 0.01  # largest difference of R^T R from the identity that rounding makes


def segment_angles(segments: Recording) -> tuple[Recording, tuple[Finding, ...]]:
    """Joint angles [deg] of a trial's segments after Grood and Suntay, and what was found on the way.

    segments: `<segment>.x`, ... [m] and `<segment>.r11`, ... of `pelvis`, `l_thigh`, `l_shank`, `l_foot` and the right
        leg's, whose axes point to the right, forward and up, as Theia3D writes them
    """
    file = segments.source.file or "the trial"
    there = {name.rpartition(".")[0] for name in segments.names}
    lacking = [label for label in LABELS.values() if label not in there]
    if lacking:
        raise ChannelError(
            "angles from segments need pelvis, thighs, shanks and feet, as pelvis, l_thigh, ...",
            f"{file} has no {', '.join(lacking)}; it has {', '.join(sorted(there))}",
            "Export these segments too, or the joint angles themselves.",
        )
    poses = {segment: _pose(segments, LABELS[segment], file) for segment in SEGMENTS}
    pelvis = poses["pelvis"]
    up = up_axis(pelvis.origin, (poses["foot_l"].origin + poses["foot_r"].origin) / 2, file)
    check_right_handed(pelvis.rotation, up, file)
    walking = walking_frame(pelvis.origin, pelvis.rotation[:, :, 0], up, segments.rate_hz)
    sure = {segment: np.zeros(len(pelvis), bool) for segment in SEGMENTS}
    angles = angles_of_poses(replace(segments, suspect=None), poses, sure, walking)
    findings = [
        Finding("note", "segments", file, f"angles of the poses of {len(SEGMENTS)} segments that the file holds", ""),
        Finding("note", "direction", file, walking.how, ""),
    ]
    counts = {segment: int((~poses[segment].known).sum()) for segment in SEGMENTS}
    for count in sorted(set(counts.values()) - {0}):
        which = ", ".join(LABELS[segment] for segment in SEGMENTS if counts[segment] == count)
        what = f"{which}: not known in {count} of {len(pelvis)} frames"
        findings.append(Finding("warning", "gap", file, what, "their joints there"))
    return angles, tuple(findings)


def _pose(segments: Recording, label: str, file: str) -> Pose:
    origin = np.stack([segments[f"{label}.{axis}"] for axis in "xyz"], axis=1)
    cells = [segments[f"{label}.r{row}{column}"] for row in "123" for column in "123"]
    axes = np.stack(cells, axis=1).reshape(-1, 3, 3)[:, :, TURN]
    return Pose(origin, _square(axes, label, file))


def _square(axes: NDArray[np.float64], label: str, file: str) -> NDArray[np.float64]:
    """Axes that are square to the last bit; a file holds seven digits."""
    known: NDArray[np.intp] = np.flatnonzero(np.isfinite(axes).all(axis=(1, 2)))
    some = axes[known]
    skew = np.abs(np.swapaxes(some, 1, 2) @ some - np.eye(3)).max(axis=(1, 2), initial=0.0)
    wrong: NDArray[np.intp] = np.flatnonzero((skew > SKEWED) | (np.linalg.det(some) < 0))
    if len(wrong):
        raise ShapeError(
            "poses of segments need axes of length 1, at right angles, right-handed",
            f"{file}: {label} in frame {known[wrong[0]] + 1} differs from that by {skew[wrong[0]]:.2g}, "
            f"its determinant is {np.linalg.det(some[wrong[0]]):.3g}",
            "Export the trial again.",
        )
    found = np.full(axes.shape, np.nan)
    if len(known):
        found[known] = Rotation.from_matrix(some).as_matrix()
    return found
