"""The segments of a person through a trial: each over its own markers, or all held together at their joints."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import replace

import numpy as np
from numpy.typing import NDArray

from gaitdisc.errors import ChannelError
from gaitdisc.kinematics.calibration import Calibration
from gaitdisc.kinematics.held_joints import carried_over, held_in_gaps, held_together
from gaitdisc.kinematics.marker_set import METHODS
from gaitdisc.kinematics.markers import marker_labels, marker_places
from gaitdisc.kinematics.pose import FEWEST_POINTS, SEGMENTS, Pose, RigidFit, fitted_pose
from gaitdisc.recording import Recording

PlacedMarkers = dict[str, tuple[NDArray[np.float64], NDArray[np.float64]]]


def named_places(markers: Recording, calibration: Calibration) -> dict[str, NDArray[np.float64]]:
    """Places of a trial's markers, each (frame, 3) [m], by the names of the marker set."""
    names = calibration.marker_set.names(marker_labels(markers))
    return dict(zip(names, marker_places(markers, [*names.values()]).swapaxes(0, 1), strict=True))


def placed_markers(
    places: Mapping[str, NDArray[np.float64]], calibration: Calibration, file: str = ""
) -> PlacedMarkers:
    """By segment, markers that both trials have: own frame (marker, 3), laboratory (frame, marker, 3) [m]."""
    placed = {}
    for segment, body in calibration.body.items():
        points = [point for point in body if point in METHODS or point in places]
        if len(points) < FEWEST_POINTS:
            absent = [point for point in body if point not in points]
            raise ChannelError(
                f"segment {segment} needs {FEWEST_POINTS} points that follow it",
                f"{file or 'the trial'} has {', '.join(points) or 'none'}, and no {', '.join(absent)}",
                "Give the marker set of these labels, or name the markers in its [aliases].",
            )
        own = [point for point in points if point in places]
        placed[segment] = np.array([body[point] for point in own]), np.stack([places[p] for p in own], axis=1)
    return placed


def free_fits(
    placed: PlacedMarkers, calibration: Calibration, held: Mapping[str, Pose] | None = None
) -> dict[str, RigidFit]:
    """Each segment over its own points, pelvis first; `held` carries one through frames with too few points."""
    fits: dict[str, RigidFit] = {}
    poses: dict[str, Pose] = {}
    for segment in SEGMENTS:
        body, places = placed[segment]
        for joint in METHODS:
            if joint in calibration.body[segment]:
                body = np.vstack([calibration.body[segment][joint], body])
                above = carried_joint(f"{joint}{segment[-2:]}", poses, calibration)
                places = np.concatenate([above[:, None], places], axis=1)
        fits[segment] = fitted_pose(body, places)
        poses[segment] = fits[segment].pose
        if held is not None:
            poses[segment] = carried_over(poses[segment], held[segment])
            fits[segment] = replace(fits[segment], pose=poses[segment])
    return fits


def free_poses(
    placed: PlacedMarkers, calibration: Calibration, held: Mapping[str, Pose] | None = None
) -> dict[str, Pose]:
    """Poses of `free_fits`."""
    return {segment: fit.pose for segment, fit in free_fits(placed, calibration, held).items()}


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
    """A joint centre (frame, 3) [m] as the segment above carries it."""
    name, side = joint.split("_")
    above = {"hip": "pelvis", "knee": f"thigh_{side}", "ankle": f"shank_{side}"}[name]
    return poses[above].to_laboratory(calibration.points[above][joint])
