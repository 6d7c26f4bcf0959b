"""Markers, or segments alone, become angles and moments; a trial that has angles keeps them."""

from dataclasses import replace

import numpy as np
import pytest
from changed_trials import with_column, with_stream
from texts import says

from gaitdisc.channel import Channel
from gaitdisc.ingest.c3d import read_c3d
from gaitdisc.ingest.c3d_parameters import read_body_measures
from gaitdisc.kinematics.calibration import calibrate_body
from gaitdisc.kinematics.marker_set import marker_set
from gaitdisc.kinetics.body_inertia import Person
from gaitdisc.processing.markers_to_moments import compute_trial, with_segment_angles
from gaitdisc.recording import Recording, Trial


@pytest.fixture(scope="module")
def young(gait_data):
    """A straight walk, and what the static trial says of the person."""
    file = gait_data / "young_static" / "HC030A" / "HC030A01.c3d"
    body = calibrate_body(read_c3d(file).stream("markers"), marker_set("plug_in_gait"), read_body_measures(file))
    return read_c3d(gait_data / "young_straight_and_turn" / "HC030A" / "straight" / "HC030A05.c3d"), body, file


def kinds(trial):
    return [finding.kind for finding in trial.findings]


def test_a_walk_gets_angles_moments_and_powers_of_both_legs(young):
    walk, body, _ = young
    made = compute_trial(walk, body, Person(45.8)).trial
    moments = made.stream("moments")
    assert len(moments.channels) == 24
    assert {"hip_flexion_r", "knee_angle_l", "ankle_angle_r", "pelvis_tilt"} <= set(made.stream("kinematics").names)
    for side in "rl":
        theirs = walk.stream("moments")[f"ankle_angle_{side}_moment"]
        both = np.isfinite(moments[f"ankle_angle_{side}_moment"]) & np.isfinite(theirs) & (theirs != 0)
        apart = (moments[f"ankle_angle_{side}_moment"] - theirs)[both]
        assert np.sqrt(np.mean(apart**2)) < 0.08
    assert "own model" in kinds(made) and "force balance" in kinds(made)


def test_without_a_person_or_forces_there_are_angles_alone(young):
    walk, body, _ = young
    bare = replace(walk, streams={"markers": walk.stream("markers")})
    for made in (compute_trial(walk, body, None).trial, compute_trial(bare, body, Person(45.8)).trial):
        assert "moments" not in made.streams and "kinematics" in made.streams
    assert "own model" not in kinds(made)


def test_a_trial_without_a_clean_step_says_why_it_has_no_moments(young):
    _, body, file = young
    made = compute_trial(read_c3d(file), body, Person(45.8)).trial
    [finding] = [one for one in made.findings if one.kind == "no moments"]
    assert "moments" not in made.streams
    assert says(finding.line(), "HC030A01.c3d: no moments", "moments", "HC030A01.c3d", "plate_1", "0.00 s: both")


def test_a_heel_marker_that_is_missing_for_a_moment_costs_nothing(young):
    walk, body, _ = young
    blind = with_stream(walk, "markers", with_column(walk.stream("markers"), "RHEE", np.nan, slice(45, 53)))
    whole, bridged = (compute_trial(one, body, Person(45.8)).trial.stream("moments") for one in (walk, blind))
    step = np.isfinite(whole["knee_angle_r_moment"])
    assert step[45:53].all()
    apart = whole["knee_angle_r_moment"][step] - bridged["knee_angle_r_moment"][step]
    assert np.abs(apart).max() < 0.05


def y_up(trial):
    """Same trial in a laboratory whose y points up: x, y, z become z, x, y."""
    streams = {}
    for key in ("markers", "forces"):
        recording = trial.stream(key)
        named = {}
        for channel in recording.channels:
            other = channel.name[:-1] + {"x": "z", "y": "x", "z": "y"}[channel.name[-1]]
            named[other] = (replace(channel, name=other), recording[channel.name])
        columns = [named[name] for name in recording.names]
        values = np.stack([column for _, column in columns], axis=1)
        streams[key] = replace(recording, values=values, channels=tuple(channel for channel, _ in columns))
    surfaces = tuple(replace(one, corners=np.roll(one.corners, -1, axis=1)) for one in trial.surfaces)
    return replace(trial, streams=streams, surfaces=surfaces)


def test_a_laboratory_with_y_up_has_the_same_moments(young):
    walk, body, file = young
    still = read_c3d(file)
    turned = calibrate_body(y_up(still).stream("markers"), marker_set("plug_in_gait"), read_body_measures(file))
    here = compute_trial(walk, body, Person(45.8)).trial.stream("moments")
    there = compute_trial(y_up(walk), turned, Person(45.8)).trial.stream("moments")
    assert there.names == here.names
    known = np.isfinite(here.values)
    assert np.array_equal(known, np.isfinite(there.values))
    assert there.values[known] == pytest.approx(here.values[known], abs=1e-6)


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
