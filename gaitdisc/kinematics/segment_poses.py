"""Segments through a trial, each over its own markers or all held at their joints by one least squares a frame."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import replace
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray
from scipy.spatial.transform import Rotation, Slerp

from gaitdisc.errors import ChannelError
from gaitdisc.kinematics.calibration import Calibration, Points
from gaitdisc.kinematics.marker_set import METHODS
from gaitdisc.kinematics.markers import marker_labels, marker_places
from gaitdisc.kinematics.pose import FEWEST_POINTS, PARTS, SEGMENTS, Pose, RigidFit, fit_pose
from gaitdisc.recording import Recording
from gaitdisc.recording.arrays import Values

ROUNDS = 60
FARTHEST_M = 0.04  # root mean square over all markers; beyond it another minimum was found
DAMPING = 1e-9  # m2; keeps what no marker determines where it is
SETTLED = 1e-9  # rad and m; the step after is smaller by far
STEADY_M = 0.02  # lever of a turn; where all markers of a segment are off by 2 mm it is off by 6 deg
LONGEST_STEP_RAD = 0.5

Turns = dict[str, Values]
CARRIED_STEADY_M = 0.06  # a thigh of Plug-in Gait that lost its wand has less, and may be wrong by 30 deg
FROM_STRAIGHT_DEG = 30.0  # a shank that turns by 300 deg/s one way and back again over 0.2 s


class PlacedMarkers(NamedTuple):
    """Markers of one segment."""

    body: Values  # (marker, 3) [m], in the segment's own frame
    seen: Values  # (frame, marker, 3) [m], in the laboratory; NaN where one is missing

    def among(self, frames: NDArray[np.intp]) -> PlacedMarkers:
        """Return the same markers in some frames."""
        return PlacedMarkers(self.body, self.seen[frames])


def hold_together(
    first: Mapping[str, Pose],
    placed: Mapping[str, PlacedMarkers],
    points: Mapping[str, Points],
    plane: Values | None = None,
    steady_m: float = STEADY_M,
) -> dict[str, Pose]:
    """Poses with the joint centre of each segment where the segment above has it, nearest to all markers at once.

    Skin moves over bone: a thigh that is laid over its own markers leaves its hip by centimetres, and its angles are
    wrong by some degrees. Held together at the joints, each segment is steadied by those beside it, and one that has
    lost markers is carried by them. Joints turn freely about all three axes; in a plane, all turn about its normal, and
    the pelvis stays beside it.

    first: each segment laid over its own markers, where the search begins; where one is unknown, it begins between the
        frames before and after
    placed: markers by segment
    points each (3,) [m]: segment -> joint centre (`hip_r`, ...) -> place in its frame, for the segments on both sides
        of the joint
    plane (frame, 3, 3): the walker's forward, up and right, as columns, where only the plane of forward and up is
        wanted
    steady_m: a segment whose turn has a shorter lever is unknown (`levers_m`) [m]
    returns: a segment is NaN in frames whose markers do not determine it; all are where no pose is near them
    Source: Lu & O'Connor 1999, J Biomech 32:129. Differs from the source: all markers weigh the same.
    """
    turns, origin = _beginning(first)
    if plane is not None:
        for segment, turn in turns.items():  # the one about the normal of the plane that is nearest
            inside = np.swapaxes(plane, 1, 2) @ turn
            angle = np.arctan2(inside[:, 1, 0] - inside[:, 0, 1], inside[:, 0, 0] + inside[:, 1, 1])
            turns[segment] = Rotation.from_rotvec(angle[:, None] * plane[:, :, 2]).as_matrix() @ plane
    allowed = _allow_steps(len(origin), plane)
    moving: NDArray[np.intp] = np.arange(len(origin))
    for _ in range(ROUNDS):
        some = {segment: turn[moving] for segment, turn in turns.items()}
        there = {segment: markers.among(moving) for segment, markers in placed.items()}
        gradient, normal = _normal_equations(some, _origins(origin[moving], some, points), there)
        # a Gauss-Newton step, the smallest where markers do not determine all, turning by half a radian at most
        may = allowed[moving]
        some_normal, right = _among(normal, may), np.swapaxes(may, 1, 2) @ gradient[..., None]
        step = (may @ np.linalg.solve(some_normal + DAMPING * np.eye(may.shape[2]), right))[..., 0]
        longest = np.abs(step[:, 3:]).max(axis=1, initial=0.0)
        step *= np.minimum(1.0, LONGEST_STEP_RAD / np.maximum(longest, 1e-12))[:, None]
        origin[moving] += step[:, :3]
        for segment in SEGMENTS:
            for above in reversed(_chain(segment)):  # what is nearest turns first, the pelvis last
                some[segment] = Rotation.from_rotvec(step[:, _columns(above)]).as_matrix() @ some[segment]
            turns[segment][moving] = some[segment]
        moving = moving[np.abs(step).max(axis=1) > SETTLED]
        if not len(moving):
            break
    origins = _origins(origin, turns, points)
    _, normal = _normal_equations(turns, origins, placed)
    far = ~(_apart_m(turns, origins, placed) <= FARTHEST_M)
    for segment, lever in levers_m(normal, allowed).items():
        unknown = far | ~(lever >= steady_m)
        origins[segment][unknown], turns[segment][unknown] = np.nan, np.nan
    return {segment: Pose(origins[segment], turns[segment]) for segment in SEGMENTS}


def _chain(segment: str) -> tuple[str, ...]:
    """A segment and those that carry it, from the pelvis down."""
    part, _, side = segment.partition("_")
    return ("pelvis", *(f"{name}_{side}" for name in PARTS[1 : PARTS.index(part) + 1]))


def _beginning(first: Mapping[str, Pose]) -> tuple[Turns, Values]:
    """Rotations and the place of the pelvis, where they are unknown between those before and after."""
    turns, origin = {}, np.zeros(first["pelvis"].origin.shape)
    for segment in SEGMENTS:
        pose = first[segment]
        known, frames = np.flatnonzero(pose.known), np.arange(len(pose))
        if not len(known):
            turns[segment] = np.tile(np.eye(3), (len(pose), 1, 1))
        else:
            turns[segment] = _between(known, pose.rotation[known], np.clip(frames, known[0], known[-1]))
        if segment == "pelvis" and len(known):
            origin = np.stack([np.interp(frames, known, pose.origin[known, axis]) for axis in range(3)], axis=1)
    return turns, origin


def _origins(origin: Values, turns: Turns, points: Mapping[str, Points]) -> Turns:
    """Places of the proximal joints, from the pelvis down."""
    origins = {"pelvis": np.array(origin)}
    for segment in SEGMENTS[1:]:
        above = _chain(segment)[-2]
        joint = {"thigh": "hip", "shank": "knee", "foot": "ankle"}[segment[:-2]] + segment[-2:]
        centre = origins[above] + turns[above] @ points[above][joint]
        origins[segment] = centre - turns[segment] @ points[segment][joint]
    return origins


def _normal_equations(turns: Turns, origins: Turns, placed: Mapping[str, PlacedMarkers]) -> tuple[Values, Values]:
    """Right side and matrix of the normal equations of each frame; columns: place of the pelvis, then turns."""
    frames, width = len(origins["pelvis"]), 3 + 3 * len(SEGMENTS)
    gradient, normal = np.zeros((frames, width)), np.zeros((frames, width, width))
    for segment, (body, seen) in placed.items():
        there = np.asarray(np.isfinite(seen).all(axis=2))
        places = origins[segment][:, None] + np.einsum("fij,pj->fpi", turns[segment], body)
        apart = np.where(there[..., None], seen - places, 0.0)
        columns = np.concatenate([np.arange(3), *(_columns(above) for above in _chain(segment))])
        slope = np.zeros((frames, len(body), 3, len(columns)))
        slope[..., :3] = np.eye(3)
        for place, above in enumerate(_chain(segment)):
            x, y, z = np.moveaxis(places - origins[above][:, None], 2, 0)
            first = 3 + 3 * place  # columns of a turn: the axis it is about, crossed with the arm
            slope[..., 1, first], slope[..., 2, first] = -z, y
            slope[..., 0, first + 1], slope[..., 2, first + 1] = z, -x
            slope[..., 0, first + 2], slope[..., 1, first + 2] = -y, x
        flat = (slope * there[..., None, None]).reshape(frames, -1, len(columns))
        across = np.swapaxes(flat, 1, 2)
        gradient[:, columns] += (across @ apart.reshape(frames, -1, 1))[..., 0]
        normal[:, columns[:, None], columns] += across @ flat
    return gradient, normal


def _columns(segment: str) -> NDArray[np.intp]:
    """Columns of the turn of a segment's joint."""
    return np.arange(3) + 3 + 3 * SEGMENTS.index(segment)


def _allow_steps(frames: int, plane: Values | None) -> Values:
    """Columns of the steps that may be taken, (frame, all, allowed): all, or those in the plane."""
    width = 3 + 3 * len(SEGMENTS)
    if plane is None:
        return np.broadcast_to(np.eye(width), (frames, width, width))
    columns = np.zeros((frames, width, 2 + len(SEGMENTS)))
    columns[:, :3, :2] = plane[:, :, :2]
    for place in range(len(SEGMENTS)):
        columns[:, 3 + 3 * place : 6 + 3 * place, 2 + place] = plane[:, :, 2]
    return columns


def _apart_m(turns: Turns, origins: Turns, placed: Mapping[str, PlacedMarkers]) -> Values:
    """Root mean square distance of all markers from their bodies in each frame."""
    squares, count = 0.0, 0
    for segment, (body, seen) in placed.items():
        places = origins[segment][:, None] + np.einsum("fij,pj->fpi", turns[segment], body)
        apart = ((seen - places) ** 2).sum(axis=2)
        squares, count = squares + np.nansum(apart, axis=1), count + np.isfinite(apart).sum(axis=1)
    return np.sqrt(squares / np.maximum(count, 1))


def levers_m(normal: Values, allowed: Values) -> Turns:
    """Error of a marker over that of the turn it makes, by segment (frame,) [m], about the axis of the shortest."""
    some = _among(normal, allowed)
    spread = allowed @ np.linalg.inv(some + DAMPING * np.eye(some.shape[1])) @ np.swapaxes(allowed, 1, 2)
    levers = {}
    for segment in SEGMENTS:
        of_chain = np.concatenate([_columns(above) for above in _chain(segment)])
        blocks = spread[:, of_chain[:, None], of_chain].reshape(len(spread), -1, 3, len(of_chain) // 3, 3)
        levers[segment] = 1 / np.sqrt(np.linalg.eigvalsh(blocks.sum(axis=(1, 3)))[:, -1])
    return levers


def _among(normal: Values, allowed: Values) -> Values:
    return np.swapaxes(allowed, 1, 2) @ normal @ allowed


def hold_in_gaps(
    free: Mapping[str, Pose], placed: Mapping[str, PlacedMarkers], points: Mapping[str, Points]
) -> dict[str, Pose]:
    """Poses held together at the joints, in frames in which some segment is unknown and beside them; NaN in all others.

    free: each segment over its own points, NaN where too few; placed, points: as `hold_together` takes them
    """
    unknown = ~np.logical_and.reduce([free[segment].known for segment in SEGMENTS])
    rows: NDArray[np.intp] = np.flatnonzero(np.convolve(unknown, np.ones(3), "same") > 0)
    held = {}
    some = {segment: markers.among(rows) for segment, markers in placed.items()}
    part = {segment: Pose(pose.origin[rows], pose.rotation[rows]) for segment, pose in free.items()}
    for segment, pose in hold_together(part, some, points, steady_m=CARRIED_STEADY_M).items():
        origin, rotation = np.full((len(unknown), 3), np.nan), np.full((len(unknown), 3, 3), np.nan)
        origin[rows], rotation[rows] = pose.origin, pose.rotation
        held[segment] = Pose(origin, rotation)
    return held


def carry_over(free: Pose, held: Pose) -> Pose:
    """A segment's pose whose gaps are those of the held body, led over from known to known frame.

    Held together, two markers and a joint determine a pose. It differs from that of the segment's own points: skin
    moves; the difference at both ends of a gap is led over it, so that no step is made.

    free: laid over its own points; NaN where these are too few
    held: of the body held together; NaN where it is not determined
    returns: known frames as they were; NaN where the held body turns by more than 30 deg from the straight way between
        the ends, as it does in another minimum and in gaps that are too long
    """
    ends: NDArray[np.intp] = np.flatnonzero(free.known & held.known)
    gaps: NDArray[np.intp] = np.flatnonzero(~free.known & held.known)
    if not len(gaps) or not len(ends):
        return free
    turns = free.rotation[ends] @ np.swapaxes(held.rotation[ends], 1, 2)
    where = np.clip(gaps, ends[0], ends[-1])
    rotations = _between(ends, turns, where) @ held.rotation[gaps]
    known: NDArray[np.intp] = np.flatnonzero(free.known)
    straight = _between(known, free.rotation[known], np.clip(gaps, known[0], known[-1]))
    near = Rotation.from_matrix(rotations @ np.swapaxes(straight, 1, 2)).magnitude() <= np.radians(FROM_STRAIGHT_DEG)
    shift = free.origin[ends] - held.origin[ends]
    moved = np.stack([np.interp(where, ends, shift[:, axis]) for axis in range(3)], axis=1)
    origin, rotation = np.array(free.origin), np.array(free.rotation)
    origin[gaps[near]] = (held.origin[gaps] + moved)[near]
    rotation[gaps[near]] = rotations[near]
    return Pose(origin, rotation)


def _between(known: NDArray[np.intp], rotations: Values, where: NDArray[np.intp]) -> Values:
    """Rotations at frames between known ones, on the shortest way from one to the next."""
    if len(known) == 1:
        return np.tile(rotations, (len(where), 1, 1))
    return Slerp(known, Rotation.from_matrix(rotations))(where).as_matrix()


def name_places(markers: Recording, calibration: Calibration) -> dict[str, Values]:
    """Places of a trial's markers, each (frame, 3) [m], by the names of the marker set."""
    names = calibration.marker_set.names(marker_labels(markers))
    return dict(zip(names, marker_places(markers, [*names.values()]).swapaxes(0, 1), strict=True))


def place_markers(places: Mapping[str, Values], calibration: Calibration, file: str = "") -> dict[str, PlacedMarkers]:
    """Markers that both trials have, by segment."""
    placed = {}
    for segment, body in calibration.body.items():
        points = [point for point in body if point in METHODS or point in places]
        if len(points) < FEWEST_POINTS:
            absent = [point for point in body if point not in points]
            raise ChannelError(
                f"segment {segment} must have at least {FEWEST_POINTS} points",
                f"{file or 'the trial'} has {', '.join(points) or 'none'}; missing: {', '.join(absent)}",
                "Choose the marker set that matches the labels of the file, or name the markers in its [aliases].",
            )
        measured = [point for point in points if point in places]
        there = np.stack([places[point] for point in measured], axis=1)
        placed[segment] = PlacedMarkers(np.array([body[point] for point in measured]), there)
    return placed


def free_fits(
    placed: Mapping[str, PlacedMarkers], calibration: Calibration, held: Mapping[str, Pose] | None = None
) -> dict[str, RigidFit]:
    """Each segment over its own points, pelvis first; `held` carries one through frames with too few points."""
    fits: dict[str, RigidFit] = {}
    poses: dict[str, Pose] = {}
    for segment in SEGMENTS:
        body, places = placed[segment]
        for joint in METHODS:
            if joint in calibration.body[segment]:
                body = np.vstack([calibration.body[segment][joint], body])
                above = carry_joint(f"{joint}{segment[-2:]}", poses, calibration)
                places = np.concatenate([above[:, None], places], axis=1)
        fits[segment] = fit_pose(body, places)
        poses[segment] = fits[segment].pose
        if held is not None:
            poses[segment] = carry_over(poses[segment], held[segment])
            fits[segment] = replace(fits[segment], pose=poses[segment])
    return fits


def free_poses(
    placed: Mapping[str, PlacedMarkers], calibration: Calibration, held: Mapping[str, Pose] | None = None
) -> dict[str, Pose]:
    """Poses of `free_fits`."""
    return {segment: fit.pose for segment, fit in free_fits(placed, calibration, held).items()}


def join_poses(
    free: Mapping[str, Pose], placed: Mapping[str, PlacedMarkers], calibration: Calibration, walker: Values
) -> dict[str, Pose]:
    """The segments with their joints as the marker set has them: free, held, or in the plane of walking.

    Free ones that lost markers are carried by others; walker (frame, 3, 3): forward, up and right as columns.
    """
    joints = calibration.marker_set.joints
    if joints != "free":
        return hold_together(free, placed, calibration.points, walker if joints == "planar" else None)
    if all(free[segment].known.all() for segment in SEGMENTS):
        return dict(free)
    return free_poses(placed, calibration, hold_in_gaps(free, placed, calibration.points))


def carry_joint(joint: str, poses: Mapping[str, Pose], calibration: Calibration) -> Values:
    """A joint centre (frame, 3) [m] as the segment above carries it."""
    name, side = joint.split("_")
    above = {"hip": "pelvis", "knee": f"thigh_{side}", "ankle": f"shank_{side}"}[name]
    return poses[above].to_laboratory(calibration.points[above][joint])
