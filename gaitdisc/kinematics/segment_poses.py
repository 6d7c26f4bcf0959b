"""The segments of a person through a trial: each over its own markers, or all held together at their joints."""

from __future__ import annotations

from collections.abc import Mapping

import numpy as np
from numpy.typing import NDArray

from gaitdisc.errors import ChannelError
from gaitdisc.kinematics.calibration import Calibration
from gaitdisc.kinematics.carried_over import carried_over, held_in_gaps
from gaitdisc.kinematics.held_joints import held_together
from gaitdisc.kinematics.marker_set import METHODS
from gaitdisc.kinematics.markers import marker_labels, marker_places
from gaitdisc.kinematics.pose import SEGMENTS, Pose
from gaitdisc.kinematics.rigid_fit import FEWEST_POINTS, fitted_pose
from gaitdisc.recording import Recording

PlacedMarkers = dict[str, tuple[NDArray[np.float64], NDArray[np.float64]]]


def placed_markers(markers: Recording, calibration: Calibration) -> PlacedMarkers:
    """Markers of each segment, in its frame and in the laboratory.

    returns each ((marker, 3), (frame, marker, 3)) [m]: those that both trials have; NaN where one is not seen
    """
    names = calibration.marker_set.names(marker_labels(markers))
    placed = {}
    for segment, body in calibration.body.items():
        points = [point for point in body if point in METHODS or point in names]
        if len(points) < FEWEST_POINTS:
            absent = [point for point in body if point not in points]
            raise ChannelError(
                f"segment {segment} needs {FEWEST_POINTS} points that follow it",
                f"{markers.source.file or 'the trial'} has {', '.join(points) or 'none'}, and no {', '.join(absent)}",
                "Give the marker set of these labels, or name the markers in its [aliases].",
            )
        own = [point for point in points if point in names]
        placed[segment] = np.array([body[point] for point in own]), marker_places(markers, [names[p] for p in own])
    return placed


def free_poses(
    placed: PlacedMarkers, calibration: Calibration, held: Mapping[str, Pose] | None = None
) -> dict[str, Pose]:
    """Each segment laid over its own points, the pelvis first: each carries the joint below it.

    placed each ((marker, 3), (frame, marker, 3)) [m]: as `placed_markers` returns them
    held: carries a segment through frames in which its own points are too few
    """
    poses: dict[str, Pose] = {}
    for segment in SEGMENTS:
        body, places = placed[segment]
        for joint in METHODS:
            if joint in calibration.body[segment]:
                body = np.vstack([calibration.body[segment][joint], body])
                above = carried_joint(f"{joint}{segment[-2:]}", poses, calibration)
                places = np.concatenate([above[:, None], places], axis=1)
        poses[segment] = fitted_pose(body, places).pose
        if held is not None:
            poses[segment] = carried_over(poses[segment], held[segment])
    return poses


def joined_poses(
    free: Mapping[str, Pose], placed: PlacedMarkers, calibration: Calibration, walker: NDArray[np.float64]
) -> dict[str, Pose]:
    """The segments with their joints as the marker set has them: free, held, or in the plane of walking.

    placed each ((marker, 3), (frame, marker, 3)) [m]: as `placed_markers` returns them
    calibration: of the same person; its marker set says how the joints are
    walker (frame, 3, 3): the walker's forward, up and right as columns
    returns: free segments that lost markers are carried by the others where these determine them
    """
    joints = calibration.marker_set.joints
    if joints != "free":
        return held_together(free, placed, calibration.points, walker if joints == "planar" else None)
    if all(free[segment].known.all() for segment in SEGMENTS):
        return dict(free)
    return free_poses(placed, calibration, held_in_gaps(free, placed, calibration.points))


def carried_joint(joint: str, poses: Mapping[str, Pose], calibration: Calibration) -> NDArray[np.float64]:
    """A joint centre as the segment above carries it.

    returns (frame, 3) [m]
    """
    name, side = joint.split("_")
    above = {"hip": "pelvis", "knee": f"thigh_{side}", "ankle": f"shank_{side}"}[name]
    return poses[above].to_laboratory(calibration.points[above][joint])
