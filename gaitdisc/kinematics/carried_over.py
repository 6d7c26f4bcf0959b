"""Segments that lost a marker, carried through the gap by those that are held to them."""

from __future__ import annotations

from collections.abc import Mapping

import numpy as np
from numpy.typing import NDArray
from scipy.spatial.transform import Rotation, Slerp

from gaitdisc.kinematics.held_joints import Placed, Points, held_together
from gaitdisc.kinematics.pose import SEGMENTS, Pose

STEADY_M = 0.06  # a thigh of Plug-in Gait that lost its wand has less, and may be wrong by 30 deg
FROM_STRAIGHT_DEG = 30.0  # a shank that turns by 300 deg/s one way and back again over 0.2 s


def held_in_gaps(free: Mapping[str, Pose], placed: Placed, points: Mapping[str, Points]) -> dict[str, Pose]:
    """Poses of the body held together at its joints, in the frames in which some segment is unknown and beside them.

    free: each segment laid over its own points; NaN where these are too few
    placed each ((marker, 3), (frame, marker, 3)) [m]: as `held_together` takes them
    points each (3,) [m]: as `held_together` takes them
    returns: NaN in all other frames, and where the markers do not determine the segment
    """
    unknown = ~np.logical_and.reduce([free[segment].known for segment in SEGMENTS])
    beside = np.convolve(unknown, np.ones(3), "same") > 0
    rows: NDArray[np.intp] = np.flatnonzero(beside)
    held = {}
    some = {segment: (body, seen[rows]) for segment, (body, seen) in placed.items()}
    part = {segment: Pose(pose.origin[rows], pose.rotation[rows]) for segment, pose in free.items()}
    for segment, pose in held_together(part, some, points, steady_m=STEADY_M).items():
        origin, rotation = np.full((len(unknown), 3), np.nan), np.full((len(unknown), 3, 3), np.nan)
        origin[rows], rotation[rows] = pose.origin, pose.rotation
        held[segment] = Pose(origin, rotation)
    return held


def carried_over(free: Pose, held: Pose) -> Pose:
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


def _between(known: NDArray[np.intp], rotations: NDArray[np.float64], where: NDArray[np.intp]) -> NDArray[np.float64]:
    """Rotations at frames between known ones, on the shortest way from one to the next."""
    if len(known) == 1:
        return np.tile(rotations, (len(where), 1, 1))
    return Slerp(known, Rotation.from_matrix(rotations))(where).as_matrix()
