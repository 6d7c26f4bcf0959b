from __future__ import annotations

import numpy as np

from gaitdisc.channel import Channel, vocabulary
from gaitdisc.ingest.c3d_kinetics import read_body_measures
from gaitdisc.ingest.reading import read_trial
from gaitdisc.kinematics.motion import joint_angles
from gaitdisc.kinematics.pose import clinical_angles, rotation_of
from gaitdisc.processing.trial_cycles import PLUG_IN_GAIT, with_pelvis_and_foot
from gaitdisc.recording import Recording

LABELS = ("RPelvisAngles.x", "LPelvisAngles.y", "RPelvisAngles.z", "RFootProgressAngles.z", "LFootProgressAngles.z")


def _recording(*labels, unit="deg"):
    values = np.arange(1.0, 4.0)[:, None] * np.arange(1, len(labels) + 1)
    suspect = np.zeros(values.shape, bool)
    suspect[1, 0] = True
    quantity = "angle" if unit == "deg" else "signal"
    channels = tuple(Channel(label, quantity, unit) for label in labels)
    return Recording(np.arange(3) / 100, values, channels, suspect=suspect)


def test_plug_in_gait_tilts_forwards_and_the_house_backwards():
    found = with_pelvis_and_foot(_recording(*LABELS))
    assert found.names == (*LABELS, *PLUG_IN_GAIT)
    np.testing.assert_allclose(found["pelvis_tilt"], [-1.0, -2.0, -3.0])
    np.testing.assert_allclose(found["pelvis_list"], [2.0, 4.0, 6.0])
    np.testing.assert_allclose(found["foot_progression_angle_l"], [5.0, 10.0, 15.0])
    assert found.channels[-1] == vocabulary().named("foot_progression_angle_l")
    assert found.suspect[:, 5].tolist() == [False, True, False]


def test_what_is_there_already_stays_and_numbers_without_a_unit_are_no_angle():
    own = _recording("RPelvisAngles.x", "pelvis_tilt")
    assert with_pelvis_and_foot(own).names == own.names
    bare = _recording(*LABELS, unit="1")
    assert with_pelvis_and_foot(bare).names == LABELS


def test_a_pelvis_that_turns_keeps_its_tilt_and_list_about_its_own_heading():
    """Tilt 15 deg forwards and 4 deg of list throughout a quarter turn; about the laboratory's axes they change."""
    time = np.arange(300) / 100
    heading = np.clip((time - 0.5) * 45, 0, 90)
    own = rotation_of(np.tile([-15.0, 4.0, 0.0], (300, 1)))
    lab = clinical_angles(np.eye(3)[None], rotation_of(np.stack([0 * time, 0 * time, heading], axis=1)) @ own)
    values = np.column_stack([-lab[:, 0], lab[:, 1], lab[:, 2], 0 * time, 0 * time])
    channels = tuple(Channel(label, "angle", "deg") for label in LABELS)
    found = with_pelvis_and_foot(Recording(time, values, channels))
    assert np.ptp(lab[:, 0]) > 10.0
    steady = (time > 1.0) & (time < 2.0)
    np.testing.assert_allclose(found["pelvis_tilt"][steady], -15.0, atol=0.5)
    np.testing.assert_allclose(found["pelvis_list"][steady], 4.0, atol=0.5)
    assert np.isnan(found["pelvis_rotation"]).all()
    assert np.isnan(found["foot_progression_angle_r"]).all()


def test_tilt_and_list_of_real_turns_are_those_of_the_markers(gait_data):
    """Against `gaitdisc angles` of the same markers; about the laboratory's axes they differ by 5 to 15 deg (rms)."""
    folder = gait_data / "young_straight_and_turn"
    for name, file in (("HC030A", "HC030A22.c3d"), ("HC002D", "HC002D25.c3d")):
        static = next(iter([*(gait_data / "young_static" / name).glob("*"), *(folder / name / "static").glob("*")]))
        walk = read_trial(folder / name / "turn" / file)
        ours = joint_angles(
            walk.stream("markers"), read_trial(static).stream("markers"), measures=read_body_measures(static)
        )
        found = with_pelvis_and_foot(walk.stream("kinematics"))
        for angle in ("pelvis_tilt", "pelvis_list"):
            assert np.sqrt(np.nanmean((found[angle] - ours[angle]) ** 2)) < 1.0, (name, angle)
