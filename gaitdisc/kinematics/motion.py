"""Segments, joint centres and joint angles of a trial, from markers and a static trial, or from given poses."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from pathlib import Path
from types import MappingProxyType

import numpy as np
from numpy.typing import NDArray
from scipy.spatial.transform import Rotation

from gaitdisc.channel import Channel
from gaitdisc.errors import ChannelError, ShapeError
from gaitdisc.kinematics.calibration import Calibration, calibrate_body
from gaitdisc.kinematics.exchanged_labels import (
    UNFIT,
    Exchange,
    exchange_findings,
    find_exchanged_pairs,
    without_exchanged,
)
from gaitdisc.kinematics.marker_set import MarkerSet, marker_set, recognise_marker_set
from gaitdisc.kinematics.markers import WalkingFrame, check_right_handed, marker_labels, up_axis, walking_frame
from gaitdisc.kinematics.pose import (
    JOINT_CHANNELS,
    SEGMENTS,
    SEGMENTS_OF,
    Pose,
    angle_signs,
    clinical_angles,
    fit_pose,
    residual_m,
)
from gaitdisc.kinematics.segment_poses import (
    FARTHEST_M,
    PlacedMarkers,
    free_poses,
    join_poses,
    name_places,
    place_markers,
)
from gaitdisc.recording import Finding, Recording
from gaitdisc.recording.arrays import Values, finite_values, spans_s
from gaitdisc.recording.trial import BodyMeasures

ANOTHER_SHAPE_M = 0.01  # median; with their own static trials six people have up to 5.5 mm, with others 12.5 or more
ROLLED_DEG = 8.0  # 95th percentile; 48 feet in 26 walks have 6.8 at most, four feet of two people 8.1 to 13
LABELS = {"pelvis": "pelvis"} | {
    f"{part}_{side}": f"{side}_{part}" for part in ("thigh", "shank", "foot") for side in "lr"
}
TURN = np.array([1, 2, 0])  # x to the right, y forward, z up of Theia3D, as x forward, y up, z to the right
SKEWED = 0.01  # largest difference of R^T R from the identity that rounding makes


@dataclass(frozen=True, eq=False)
class Motion:
    """A trial as segments that move."""

    angles: Recording  # joint, pelvis and foot progression angles [deg] (`hip_flexion_r`, ...), pelvis translations [m]
    # segment (`pelvis`, `thigh_l`, ...) -> origin and axes in the laboratory's frame, frame by frame
    poses: Mapping[str, Pose]
    walking: WalkingFrame  # forward, up and right of the walker
    # each (frame,) [m], segment -> root mean square distance of its markers from where the static trial has them
    residual_m: Mapping[str, Values]
    calibration: Calibration  # of the person, with the marker set that was used
    markers: Recording  # of the trial, without those that bear another's label
    exchanged: tuple[Exchange, ...]  # pairs of labels, and in which frames
    findings: tuple[Finding, ...] = ()  # what was inferred, bridged or left out


def move_body(
    markers: Recording,
    static: Recording | None,
    marker_set: MarkerSet | str | Path | None = None,
    measures: BodyMeasures | None = None,
    forward: Sequence[float] | None = None,
    joints: str | None = None,
) -> Motion:
    """Calibrate a body by its static trial and follow it through a trial.

    static: markers of the same person standing, with the same markers; None is refused
    marker_set: a set, its name, or its file; recognised by the labels where it is not given
    forward: direction of walking in the laboratory's axes; found from the pelvis where it is not given
    joints: `free`, `held` or `planar`; as the marker set says where it is not given
    """
    if static is None:
        raise ChannelError(
            "for angles from markers, a static trial of the person must be given",
            "none is given",
            "Record a static trial with all markers of the set, or name such a trial.",
        )
    chosen = choose_marker_set(markers, static, marker_set)
    chosen = chosen if joints is None else chosen.with_joints(joints)
    return motion(markers, calibrate_body(static, chosen, measures), forward)


def choose_marker_set(markers: Recording, static: Recording, given: MarkerSet | str | Path | None = None) -> MarkerSet:
    """Marker set of a trial: the one given, or the one that the labels of both trials are of."""
    if isinstance(given, MarkerSet):
        return given
    if given is not None:
        return marker_set(given)
    return recognise_marker_set(marker_labels(static), marker_labels(markers), static.source.file)


def motion(markers: Recording, calibration: Calibration, forward: Sequence[float] | None = None) -> Motion:
    """Segments, joint centres and angles of a trial; forward in laboratory axes, else found from the pelvis."""
    file = markers.source.file or "the trial"
    places = name_places(markers, calibration)
    placed = place_markers(places, calibration, file)
    up = up_axis(_middle(placed, ("pelvis",)), _middle(placed, ("foot_l", "foot_r")), file)
    pelvis = fit_pose(*placed["pelvis"]).pose.rotation
    legs = _middle(placed, ("thigh_r", "shank_r")) - _middle(placed, ("thigh_l", "shank_l"))
    if np.nanmedian(np.einsum("fi,fi->f", np.cross(pelvis[:, :, 0], up), legs)) < 0:  # the legs too, not two spines
        check_right_handed(pelvis, up, file)
    exchanges, broken = find_exchanged_pairs(places, calibration, up)
    unfit = {
        s: np.any([broken[s], *(e.frames for e in exchanges if s in e.segments)], axis=0) | (s in calibration.spoiled)
        for s in SEGMENTS
    }
    exchanged = exchange_findings(exchanges, broken, calibration, markers, up)
    if unfit["pelvis"].all():
        raise ShapeError(
            "the pelvis markers must lie as in the static trial",
            f"{file}: {next(finding.what for finding in (*calibration.findings, *exchanged) if finding.kind in UNFIT)}",
            "Correct the labels, or use the static trial of this person and session.",
        )
    for segment, frames in unfit.items():
        hidden = np.where(frames[:, None, None], np.nan, placed[segment].seen)
        placed[segment] = placed[segment]._replace(seen=hidden)
    free = free_poses(placed, calibration)
    check_right_handed(free["pelvis"].rotation, up, file)
    facing = free["pelvis"].rotation[:, :, 0]
    walking = walking_frame(free["pelvis"].origin, facing, up, markers.rate_hz, forward)
    joined = join_poses(free, placed, calibration, walking.rotation)
    spoiled = np.any([*unfit.values()], axis=0)  # nothing is carried over by a body of which a part is unknown
    poses = {s: joined[s].without(unfit[s] | (spoiled & ~free[s].known)) for s in SEGMENTS}
    residuals = {segment: residual_m(poses[segment], *placed[segment]) for segment in SEGMENTS}
    bridged = {s: poses[s].known & ~np.isfinite(placed[s].seen).all(axis=(1, 2)) for s in SEGMENTS}
    findings = [
        *calibration.findings,
        Finding("note", "marker set", file, _set_words(calibration), ""),
        Finding("note", "direction", file, walking.how, ""),
        *exchanged,
    ]
    for segment in SEGMENTS:
        findings += _gaps_and_shape(segment, ~poses[segment].known, bridged[segment], residuals[segment], markers)
    angles = angles_of_poses(markers, poses, bridged, walking)
    findings += [finding for side in "rl" for finding in _rolled_foot(side, angles, poses, file)]
    if calibration.marker_set.joints == "planar":  # only what a planar body has
        flexions = {f"{names[0]}_{side}" for names, _ in JOINT_CHANNELS.values() for side in "rl"}
        angles = angles.selected_by(lambda c: c.name in flexions | {"pelvis_tilt", "pelvis_tx", "pelvis_ty"})
    return Motion(
        angles,
        poses=MappingProxyType(poses),
        walking=walking,
        residual_m=MappingProxyType(residuals),
        calibration=calibration,
        markers=without_exchanged(markers, exchanges, calibration),
        exchanged=tuple(exchanges),
        findings=tuple(findings),
    )


def _set_words(calibration: Calibration) -> str:
    """Marker set that was taken, and how its axes differ from Plug-in Gait's."""
    chosen, usual = calibration.marker_set, marker_set("plug_in_gait")
    ways = [(joint, chosen.joint_centres[joint], usual.joint_centres[joint]) for joint in ("hip", "knee", "ankle")]
    ways += [(part, chosen.tracked[part], usual.tracked[part]) for part in ("thigh", "shank", "foot")]
    other = [f"{key} by {' '.join(way)}, not {' '.join(pig)}" for key, way, pig in ways if way != pig]
    differs = f"; unlike in Plug-in Gait, {'; '.join(other)}, which rotates the axes" if other else ""
    return f"{chosen.name}: {chosen.title}; joints {chosen.joints}{differs}".replace("{S}", "")


def _middle(placed: Mapping[str, PlacedMarkers], segments: Sequence[str]) -> Values:
    """Mean place of those markers of some segments that are seen in a frame (frame, 3) [m]."""
    places = np.concatenate([placed[segment].seen for segment in segments], axis=1)
    seen = np.isfinite(places).all(axis=2, keepdims=True)
    count = seen.sum(axis=1)
    return np.where(count > 0, np.where(seen, places, 0.0).sum(axis=1) / np.maximum(count, 1), np.nan)


def _gaps_and_shape(
    segment: str, unknown: NDArray[np.bool_], bridged: NDArray[np.bool_], residual: Values, markers: Recording
) -> list[Finding]:
    """Say where a segment is carried although a marker is missing, where it is unknown, or has another shape."""
    file, frames = markers.source.file or "the trial", len(markers.time)
    findings = []
    if bridged.any():
        what = f"{segment}: a marker was missing in {int(bridged.sum())} of {frames} frames; "
        what += "the other markers define the segment there"
        findings.append(Finding("note", "bridged", file, what, "", spans=spans_s(markers.time, bridged)))
    if unknown.any():
        what = f"the pose of {segment} is unknown in {int(unknown.sum())} of {frames} frames: fewer than 3 "
        what += "of its points can be used there, or the points are collinear"
        spoils = "the segment's joints there; fill the gaps, or add a marker off the line"
        findings.append(Finding("warning", "gap", file, what, spoils, spans=spans_s(markers.time, unknown)))
    typical = float(np.nanmedian(residual)) if np.isfinite(residual).any() else 0.0
    if typical > ANOTHER_SHAPE_M:
        what = f"the markers of {segment} are {typical * 1000:.0f} mm from their positions in the static trial"
        spoils = "these angles; check that the static trial is of this person and session, and that labels are right"
        findings.append(Finding("warning", "another shape", file, what, spoils))
    return findings


def _rolled_foot(side: str, angles: Recording, poses: Mapping[str, Pose], file: str) -> list[Finding]:
    """Say that an ankle's flexion is not what its foot's line from heel to toes shows, about which the foot rolls."""
    shank, foot = (poses[f"{part}_{side}"].rotation for part in ("shank", "foot"))
    line = np.degrees(np.arcsin(np.clip(np.einsum("fi,fi->f", foot[:, :, 0], shank[:, :, 1]), -1.0, 1.0)))
    apart = angles[f"ankle_angle_{side}"] - line
    known = finite_values(apart)
    most = float(np.percentile(np.abs(known - np.median(known)), 95)) if len(known) else 0.0
    what = f"ankle_angle_{side} lies more than {most:.0f} deg from the line from heel to toe in 5 % of the frames: the "
    what += "foot rolls about that line, which the markers of a foot show poorly"
    spoils = "the angles of this ankle, mostly in swing; compare them with a video"
    return [Finding("warning", "rolled foot", file, what, spoils)] if most > ROLLED_DEG else []


def angles_of_poses(
    base: Recording, poses: Mapping[str, Pose], bridged: Mapping[str, NDArray[np.bool_]], walking: WalkingFrame
) -> Recording:
    """Joint and foot angles [deg], pelvis translations [m] of segments, on `base`'s times; bridged is suspect."""
    turns = {segment: pose.rotation for segment, pose in poses.items()}
    columns: list[tuple[Channel, Values, NDArray[np.bool_]]] = []

    def add(names: Sequence[str], side: str, values: Values, doubt: NDArray[np.bool_]) -> None:
        for name, column in zip(names, values.T, strict=True):
            full = f"{name}_{side}" if side else name
            columns.append((Channel(full, "angle", "deg", side), column, doubt))

    pelvis = clinical_angles(walking.rotation, turns["pelvis"])
    add(("pelvis_tilt", "pelvis_list", "pelvis_rotation"), "", pelvis, bridged["pelvis"])
    for side in "rl":
        for joint, (names, _) in JOINT_CHANNELS.items():
            above, below = (part if part == "pelvis" else f"{part}_{side}" for part in SEGMENTS_OF[joint])
            values = clinical_angles(turns[above], turns[below]) * angle_signs(joint, side)
            add(names, side, values, bridged[above] | bridged[below])
        foot = clinical_angles(walking.rotation, turns[f"foot_{side}"])
        add(("foot_progression_angle",), side, foot[:, 2:] * (1 if side == "r" else -1), bridged[f"foot_{side}"])
    # steps, each along its own frame's axes: in a turn the laboratory's origin is behind, then beside the walker
    known = poses["pelvis"].known
    if not known.any():
        raise ShapeError(
            f"in at least one frame, the segments must lie within {FARTHEST_M * 1000:.0f} mm of the markers",
            f"{base.source.file or 'the trial'} has no such frame (root mean square over all markers)",
            'Check the static trial and the direction of walking, or use joints = "free".',
        )
    path = np.stack([np.interp(base.time, base.time[known], axis[known]) for axis in poses["pelvis"].origin.T], axis=1)
    place = np.einsum("fji,fj->fi", walking.rotation, np.diff(path, axis=0, prepend=0 * path[:1])).cumsum(axis=0)
    place[~known] = np.nan
    for name, column in zip(("pelvis_tx", "pelvis_ty", "pelvis_tz"), place.T, strict=True):
        columns.append((Channel(name, "translation", "m"), column, bridged["pelvis"]))
    return replace(
        base,
        values=np.stack([values for _, values, _ in columns], axis=1),
        channels=tuple(channel for channel, _, _ in columns),
        suspect=np.stack([doubt for _, _, doubt in columns], axis=1),
    )


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
            "for angles from segments, the file must have pelvis, thighs, shanks and feet, as pelvis, l_thigh, ...",
            f"{file} has no {', '.join(lacking)}; it has {', '.join(sorted(there))}",
            "Export these segments too, or export the joint angles.",
        )
    poses = {segment: _pose_in_file(segments, LABELS[segment], file) for segment in SEGMENTS}
    pelvis = poses["pelvis"]
    up = up_axis(pelvis.origin, (poses["foot_l"].origin + poses["foot_r"].origin) / 2, file)
    check_right_handed(pelvis.rotation, up, file)
    walking = walking_frame(pelvis.origin, pelvis.rotation[:, :, 0], up, segments.rate_hz)
    sure = {segment: np.zeros(len(pelvis), bool) for segment in SEGMENTS}
    angles = angles_of_poses(replace(segments, suspect=None), poses, sure, walking)
    findings = [
        Finding("note", "segments", file, f"angles are computed from {len(SEGMENTS)} segments of the file", ""),
        Finding("note", "direction", file, walking.how, ""),
    ]
    counts = {segment: int((~poses[segment].known).sum()) for segment in SEGMENTS}
    for count in sorted(set(counts.values()) - {0}):
        which = ", ".join(LABELS[segment] for segment in SEGMENTS if counts[segment] == count)
        what = f"{which}: the pose is unknown in {count} of {len(pelvis)} frames"
        findings.append(Finding("warning", "gap", file, what, "the joints of these segments in these frames"))
    return angles, tuple(findings)


def _pose_in_file(segments: Recording, label: str, file: str) -> Pose:
    """Pose of a segment whose axes are square to the last bit; a file holds seven digits."""
    origin = np.stack([segments[f"{label}.{axis}"] for axis in "xyz"], axis=1)
    cells = [segments[f"{label}.r{row}{column}"] for row in "123" for column in "123"]
    axes = np.stack(cells, axis=1).reshape(-1, 3, 3)[:, :, TURN]
    known: NDArray[np.intp] = np.flatnonzero(np.isfinite(axes).all(axis=(1, 2)))
    some = axes[known]
    skew = np.abs(np.swapaxes(some, 1, 2) @ some - np.eye(3)).max(axis=(1, 2), initial=0.0)
    wrong: NDArray[np.intp] = np.flatnonzero((skew > SKEWED) | (np.linalg.det(some) < 0))
    if len(wrong):
        raise ShapeError(
            "the axes of a segment must have length 1, be perpendicular and be right-handed",
            f"{file}: the axes of {label} in frame {known[wrong[0]] + 1} deviate by {skew[wrong[0]]:.2g}, and their "
            f"determinant is {np.linalg.det(some[wrong[0]]):.3g}",
            "Export the trial again.",
        )
    rotation = np.full(axes.shape, np.nan)
    if len(known):
        rotation[known] = Rotation.from_matrix(some).as_matrix()
    return Pose(origin, rotation)
