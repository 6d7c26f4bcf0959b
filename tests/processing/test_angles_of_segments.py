"""A trial of segments alone gets joint angles; one that has angles keeps them."""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from gaitdisc.channel import Channel
from gaitdisc.processing.markers_to_moments import with_segment_angles
from gaitdisc.recording import Recording, Trial

LABELS = ("pelvis", *(f"{side}_{part}" for part in ("thigh", "shank", "foot") for side in "lr"))
HEIGHTS = {"pelvis": 1.0, "thigh": 0.9, "shank": 0.5, "foot": 0.1}


def standing() -> Recording:
    """A body upright, all axes along the laboratory's."""
    row, channels = [], []
    for label in LABELS:
        row += [0.0, 0.0, HEIGHTS[label.split("_")[-1]], *np.eye(3).ravel()]
        channels += [Channel(f"{label}.{axis}", "translation", "m") for axis in "xyz"]
        channels += [Channel(f"{label}.r{i}{j}", "signal", "1") for i in "123" for j in "123"]
    return Recording(np.arange(100) / 100, np.tile(row, (100, 1)), tuple(channels))


def test_angles_are_added_under_the_name_of_the_trial():
    trial = with_segment_angles(Trial("P01 walk", {"segments": standing()}, subject="P01", condition="walk"))
    angles = trial.stream("kinematics")
    assert (angles.subject, angles.condition) == ("P01", "walk")
    assert np.abs(angles.selected_by(lambda one: one.quantity == "angle").values).max() < 1e-9
    assert any(finding.kind == "segments" for finding in trial.findings)


def test_angles_of_the_file_stay_and_a_lacking_segment_is_said():
    own = Recording(np.arange(9) / 9, np.ones((9, 1)), (Channel("knee_angle_r", "angle", "deg", "r"),))
    both = Trial("a", {"segments": standing(), "kinematics": own})
    assert with_segment_angles(both) is both
    some = standing()
    less = some.selected([name for name in some.names if not name.startswith("pelvis")])
    found = with_segment_angles(replace(both, streams={"segments": less}))
    assert "kinematics" not in found.streams
    assert "has no pelvis" in next(one.what for one in found.findings if one.kind == "no angles")
