"""Studies of angles and moments: other software, skin that slides, markers that drop out, real strides."""

import re

import gait10dof_segments
import moments
import moments_tables
import numpy as np
import pytest
import real_strides
from marker_noise import SHOWN, errors
from markers_to_angles import against_opensim
from moved_markers import LOST_S, bodies, lost, slid
from plug_in_gait_angles import WRITTEN_WITH, against_plug_in_gait, nearest_axis, people
from texts import says


@pytest.fixture(scope="module")
def data(gait_data):
    return gait_data.parent


def test_one_person_agrees_with_plug_in_gait(data):
    rows = against_plug_in_gait(people(data, WRITTEN_WITH[1:2]), "plug_in_gait")
    found = {row[0]: (float(row[1]), row[2], row[5]) for row in rows}
    for angle, (goal, *cells) in found.items():
        for cell in cells:
            assert cell == "-" or float(cell.split()[0]) <= goal, angle
    assert found["pelvis_tilt"][2] == "-"


@pytest.mark.slow
def test_opensim_s_planar_model_is_nearest_to_ours_in_the_plane(data):
    rows = against_opensim(data)
    free, planar = (np.median([float(row[column]) for row in rows]) for column in (2, 4))
    assert planar <= 3 < max(float(row[2]) for row in rows)
    assert planar < free


def test_plug_in_gait_takes_an_axis_for_the_direction():
    assert nearest_axis(np.array([0.05, -0.99, 0.0])) == (0.0, -1.0, 0.0)


@pytest.fixture(scope="module")
def several(gait_data):
    return bodies(gait_data.parent)


@pytest.mark.slow
def test_skin_slides_by_what_the_table_says(several):
    body = several[-1]
    sliding = slid(body, 10.0, np.random.default_rng(0)).values - body.rigid.values
    thigh = [body.rigid.index(f"{side}.Thigh.{place}.{axis}") for side in "RL"
             for place in ("Upper", "Front", "Rear") for axis in "xyz"]  # fmt: skip
    assert 1e3 * np.sqrt(np.mean(sliding[:, thigh] ** 2)) == pytest.approx(10, rel=0.2)


@pytest.mark.slow
def test_markers_are_lost_a_fifth_of_a_second_at_a_time(several):
    body = several[-1]
    gone = np.isnan(lost(body, 10, np.random.default_rng(0)).values) & np.isfinite(body.markers.values)
    assert gone.mean() == pytest.approx(0.10 * 26 / 41, rel=0.5)  # of 41 markers the set follows 26
    column = gone[:, gone.any(axis=0).argmax()]
    assert column.sum() >= round(LOST_S * body.markers.rate_hz) or column[-1]


@pytest.mark.slow  # tests/kinematics/test_held_joints.py holds it of one thigh
def test_joints_held_together_halve_what_skin_does_to_hip_and_knee(several):
    free, held = several[2:]
    wrong = {}
    for body in (free, held):
        angles = [body.angles(slid(body, 10.0, np.random.default_rng(seed))) for seed in range(3)]
        wrong[body.name] = errors(angles, body.angles(body.rigid))
    for angle in ("hip_flexion", "hip_adduction", "knee_angle", "knee_adduction", "ankle_angle"):
        assert angle in SHOWN
        assert wrong["gait2354, held"][angle] < 0.7 * wrong["gait2354, free"][angle], angle


@pytest.fixture(scope="module")
def found(gait_data):
    return moments.walks(gait_data.parent, quick=True)


def median(rows, source, channel):
    [row] = [row for row in rows if row[0] == source and row[1] == "6/20 Hz" and row[2] == channel]
    assert row[3].endswith(", 2")  # both plates of the straight walk
    return float(row[3].split(" ")[0])


def test_moments_from_markers_are_those_of_plug_in_gait_within_the_goal(found):
    rows = moments.against_plug_in_gait(found)
    goals = {"ankle_angle_moment": 0.08, "knee_angle_moment": 0.12, "hip_flexion_moment": 0.15}
    for channel, goal in goals.items():
        assert median(rows, "markers", channel) < 0.75 * goal
        assert median(rows, "markers, Harrington's hip", channel) < 1.1 * goal
        assert median(rows, "bones", channel) < 0.75 * goal


@pytest.mark.slow
def test_with_the_models_own_segments_opensim_is_met(gait_data):
    rows = gait10dof_segments.against_opensim(gait_data.parent / "opensim_gait10dof")
    own = {row[0]: [float(one) for one in row[2].split()] for row in rows if row[1] == "the model"}
    assert set(own) == {"ankle_angle", "knee_angle", "hip_flexion"}
    assert max(max(sizes) for sizes in own.values()) < 0.15
    ankles = [row[4] for row in rows if row[0] == "ankle_angle" and row[1] == "markers, joints free"]
    assert max(float(one) for one in ankles[0].split()) < 0.08


def test_the_filters_effect_is_a_sentence_with_its_numbers(found):
    sentence = moments.filter_effect(found)
    assert says(sentence, "knee extension moment", "3 steps", "median 0.")


def test_a_picture_is_drawn(found, tmp_path):
    moments.over_each_other({walk.person: walk.steps for walk in found[:1]}, str(tmp_path / "moments.png"))
    assert (tmp_path / "moments.png").stat().st_size > 20_000


def test_rms_counts_what_both_have():
    assert moments_tables.rms(np.array([1.0, 2.0, np.nan, 9.0]), np.array([1.5, 1.5, 3.0, 0.0])) == pytest.approx(0.5)
    assert np.isnan(moments_tables.rms(np.array([1.0]), np.array([0.0])))


@pytest.fixture(scope="module")
def printed(gait_data):
    found = real_strides.run(gait_data)
    return {(recordings, promise): words for recordings, promise, words in found}


def numbers(words):
    return [float(n) for n in re.findall(r"-?\d+\.?\d*", words)]


@pytest.mark.parametrize(("trial", "strides"), [("natural2", 83), ("exotendon3", 88), ("manual_ik", 90)])
def test_strides_of_the_running_trials(printed, trial, strides):
    assert numbers(printed[f"exotendon_run/{trial}", f"{strides} strides, +-1"])[0] == pytest.approx(strides, abs=1)


def test_strides_of_the_twelve_walks(printed):
    kept, dropped, whole = numbers(printed["treadmill_walk_ik, 12 walks", "221 strides, +-1 %"])
    assert kept + dropped == whole == pytest.approx(221, rel=0.01)


def test_the_hip_plateau_is_found_by_itself(printed):
    walks, *limits = numbers(printed["treadmill_walk_ik, 12 walks", "hip plateau at -29.9 deg"])
    assert walks == 12
    assert limits == pytest.approx([-29.9, -29.9], abs=0.2)


def test_calibration_trials_are_no_walks(printed):
    refused = printed["treadmill_walk_ik, 2 calibrations", "refused as walking"]
    assert "S01DE503" in refused and "S01DN603" in refused


def test_sixteen_emg_channels_and_strides_from_chattering_belts(printed):
    assert printed["treadmill_c3d_emg", "16 EMG channels apart"].startswith("16:")
    right, left = numbers(printed["treadmill_c3d_emg", "6-7 strides a leg"])
    assert {right, left} <= {6.0, 7.0}
