"""Knee flexion is positive inside: turned files are mended, right ones never touched, on every real file there is."""

from dataclasses import replace

import numpy as np
import pytest
from texts import says

from gaitdisc.channel import Channel
from gaitdisc.ingest.columns import name_channel
from gaitdisc.ingest.plausible import with_flexion_positive
from gaitdisc.ingest.reading import read_trial
from gaitdisc.ingest.storage import write_storage
from gaitdisc.ingest.table import write_table
from gaitdisc.recording import Recording, Source

KNEES = ("knee_angle_r", "knee_angle_l")
GAIT = 20 + 35 * np.sin(np.linspace(0, 6 * np.pi, 300))  # -15 to 55 deg


def _walk(**knees):
    channels = tuple(name_channel(name) for name in knees)
    return Recording(np.arange(300) / 100, np.column_stack(list(knees.values())), channels, source=Source("walk.mot"))


def _turned(recording, names=KNEES):
    signs = np.array([-1.0 if name in names else 1.0 for name in recording.names])
    return recording.with_values(recording.values * signs)


def _said(trial):
    return [finding for finding in trial.findings if finding.kind == "knee sign"]


def test_a_turned_knee_is_turned_back_and_named():
    streams, findings = with_flexion_positive({"kinematics": _walk(knee_angle_r=-GAIT, knee_angle_l=-GAIT)})
    np.testing.assert_array_equal(streams["kinematics"]["knee_angle_r"], GAIT)
    assert [(f.severity, f.file, f.channel) for f in findings] == [
        ("note", "walk.mot", "knee_angle_r"),
        ("note", "walk.mot", "knee_angle_l"),
    ]
    assert says(findings[0].what, "knee_angle_r", "-55", "15 deg")


@pytest.mark.parametrize(
    "knee",
    [GAIT, GAIT + 30, np.full(300, -8.0), 10 * np.sin(GAIT), np.full(300, np.nan), GAIT - 10],
    ids=["gait", "crouch", "standing", "stiff", "not there", "recurvatum"],
)
def test_a_knee_that_may_be_right_stays(knee):
    streams, findings = with_flexion_positive({"kinematics": _walk(knee_angle_r=knee)})
    np.testing.assert_array_equal(streams["kinematics"]["knee_angle_r"], knee)
    assert findings == []


def test_a_stiff_knee_follows_the_other_one():
    stiff = -10 + 5 * np.sin(np.arange(300) / 20)
    streams, findings = with_flexion_positive({"kinematics": _walk(knee_angle_r=-GAIT, knee_angle_l=stiff)})
    np.testing.assert_array_equal(streams["kinematics"]["knee_angle_l"], -stiff)
    assert says(findings[1].what, "takes the sign of the other")


def test_two_knees_of_two_signs_are_a_warning():
    streams, findings = with_flexion_positive({"kinematics": _walk(knee_angle_r=GAIT, knee_angle_l=-GAIT)})
    np.testing.assert_array_equal(streams["kinematics"].values, np.column_stack([GAIT, GAIT]))
    assert findings[-1].severity == "warning"
    assert says(findings[-1].what, "knee_angle_r", "knee_angle_l")


def test_a_knee_that_bends_both_ways_is_named_and_left():
    both = 60 * np.sin(np.arange(300) / 20)
    streams, (finding,) = with_flexion_positive({"kinematics": _walk(knee_angle_r=both)})
    np.testing.assert_array_equal(streams["kinematics"]["knee_angle_r"], both)
    assert finding.severity == "warning" and says(finding.what, "-60", "60 deg")


def test_a_few_absurd_cells_decide_nothing():
    knee = GAIT.copy()
    knee[100:102] = -1e6
    streams, findings = with_flexion_positive({"kinematics": _walk(knee_angle_r=knee)})
    assert findings == [] and streams["kinematics"]["knee_angle_r"][0] == knee[0]


def test_speed_and_generalised_moment_go_with_the_knee():
    speeds = Recording(np.arange(300) / 100, GAIT[:, None], (Channel("knee_angle_r/speed", "signal", "deg/s", "r"),))
    moments = Recording(
        np.arange(300) / 100, GAIT[:, None], (name_channel("knee_angle_r_moment"),), source=Source(reader="sto")
    )
    streams = {"kinematics": _walk(knee_angle_r=-GAIT), "signals": speeds, "moments": moments}
    turned, (finding,) = with_flexion_positive(streams)
    np.testing.assert_array_equal(turned["signals"].values, -speeds.values)
    np.testing.assert_array_equal(turned["moments"].values, -moments.values)
    assert finding.what.endswith("; the same holds for knee_angle_r/speed, knee_angle_r_moment")
    of_table = {**streams, "moments": replace(moments, source=Source(reader="csv"))}  # may be of another convention
    np.testing.assert_array_equal(with_flexion_positive(of_table)[0]["moments"].values, moments.values)


@pytest.mark.parametrize("ending", [".mot", ".csv", ".c3d"])
def test_every_reader_turns_a_turned_copy_of_a_real_walk(gait_data, tmp_path, write_c3d, ending):
    real = read_trial(gait_data / "treadmill_walk_ik" / "S01DE504_ik.mot")
    assert _said(real) == []
    walk = real.stream("kinematics").selected(KNEES)
    labels = ["RKneeAngles", "LKneeAngles"]
    for recording in (walk, _turned(walk)):
        path = tmp_path / f"walk{ending}"
        if ending == ".c3d":
            points = np.stack([recording.values.T, *[np.zeros(recording.values.T.shape)] * 2])
            write_c3d(path, points, parameters={("POINT", "LABELS"): labels, ("POINT", "ANGLES"): labels})
        else:
            {".mot": write_storage, ".csv": write_table}[ending](recording, path)
        read = read_trial(path)
        found = read.stream("kinematics").selected(KNEES).values
        np.testing.assert_allclose(found, walk.values, atol=1e-4, err_msg="C3D has single precision")
        assert [f.channel for f in _said(read)] == ([] if recording is walk else list(KNEES))


def test_a_real_gait2392_walk_agrees_with_its_markers(gait_data):
    """OpenSim's gait10dof counts knee flexion negative; the swing knee of a walk bends to 60 to 70 deg."""
    folder = gait_data.parent / "opensim_gait10dof"
    trial = read_trial([folder / "IK" / "subject01_walk_IK.mot"])
    assert [f.channel for f in _said(trial)] == list(KNEES)
    for knee in KNEES:
        angle = trial.stream("kinematics")[knee]
        assert 65 < angle.max() < 72 and -6 < angle.min() < 0


def test_the_crop_decides_what_is_checked(gait_data):
    """Outside of 1.06 to 3.23 s, where its inverse dynamics stand, this file is not tracked: knees from -239 to 89."""
    path = gait_data / "opensim_walks" / "mrs_emg_walking" / "IK_gait.mot"
    assert {f.severity for f in _said(read_trial(path))} == {"warning"}
    cropped = read_trial(path, crop_s=(1.06, 3.23))
    assert {f.severity for f in _said(cropped)} == {"note"}
    assert cropped.stream("kinematics")["knee_angle_r"].max() > 60


@pytest.mark.slow
def test_no_other_real_file_is_turned(real_trials):
    """Of all files with knees, those of gait10dof alone count flexion negative."""
    turned = {
        path.parent.name
        for path, _, findings in real_trials
        if any((f.kind, f.severity) == ("knee sign", "note") for f in findings)
    }
    assert sum("knee_angle_r" in names for _, names, _ in real_trials) > 25
    assert turned == {"IK", "results_no_spring", "results_spring"}
