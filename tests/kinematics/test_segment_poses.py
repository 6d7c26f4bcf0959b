"""Segments through a trial: each over its own points, or all held together."""

from __future__ import annotations

import numpy as np
import pytest
from manufactured_body import (
    MEASURES,
    PLUG_IN_GAIT,
    RAJAGOPAL,
    body_frames,
    known_angles,
    markers_of,
    static_of,
    without,
)

from gaitdisc.errors import ChannelError
from gaitdisc.kinematics.calibration import calibrated
from gaitdisc.kinematics.marker_set import marker_set
from gaitdisc.kinematics.segment_poses import carried_joint, free_poses, joined_poses, named_places, placed_markers

KNOWN = known_angles(40)
WALKER = np.tile(np.eye(3), (40, 1, 1))


def test_markers_that_the_static_trial_lacks_are_not_followed():
    calibration = calibrated(without(static_of(RAJAGOPAL), "RTH3"), marker_set("rajagopal"))
    body, places = placed_markers(named_places(markers_of(KNOWN, RAJAGOPAL), calibration), calibration)["thigh_r"]
    assert (body.shape, places.shape) == ((3, 3), (40, 3, 3))


def test_too_few_points_in_the_trial_are_refused():
    calibration = calibrated(static_of(RAJAGOPAL), marker_set("rajagopal"))
    markers = without(markers_of(KNOWN, RAJAGOPAL), "LTB1", "LTB2")
    with pytest.raises(ChannelError, match=r"shank_l.*3 points.*LTB3, LLMAL.*no LTB1, LTB2"):
        placed_markers(named_places(markers, calibration), calibration, markers.source.file)


@pytest.mark.parametrize("joints", ["free", "held"])
def test_the_chain_from_the_pelvis_down_is_that_of_the_body(joints):
    calibration = calibrated(static_of(PLUG_IN_GAIT), marker_set("plug_in_gait").with_joints(joints), MEASURES)
    placed = placed_markers(named_places(markers_of(KNOWN, PLUG_IN_GAIT), calibration), calibration)
    poses = joined_poses(free_poses(placed, calibration), placed, calibration, WALKER)
    for segment, (origin, rotation) in body_frames(KNOWN).items():
        np.testing.assert_allclose(poses[segment].origin, origin, atol=1e-9, err_msg=segment)
        np.testing.assert_allclose(poses[segment].rotation, rotation, atol=1e-9, err_msg=segment)
    np.testing.assert_allclose(carried_joint("ankle_l", poses, calibration), poses["foot_l"].origin, atol=1e-9)
