import importlib

import numpy as np
import pytest
from texts import says


def study(name):
    return importlib.import_module(name)


@pytest.fixture(scope="module")
def found(gait_data):
    return study("moments").walks(gait_data.parent, quick=True)


def median(rows, source, channel):
    [row] = [row for row in rows if row[0] == source and row[1] == "6/20 Hz" and row[2] == channel]
    assert row[3].endswith(", 2")  # both plates of the straight walk
    return float(row[3].split(" ")[0])


def test_moments_from_markers_are_those_of_plug_in_gait_within_the_goal(found):
    rows = study("moments").against_plug_in_gait(found)
    goals = {"ankle_angle_moment": 0.08, "knee_angle_moment": 0.12, "hip_flexion_moment": 0.15}
    for channel, goal in goals.items():
        assert median(rows, "markers", channel) < 0.75 * goal
        assert median(rows, "markers, Harrington's hip", channel) < 1.1 * goal
        assert median(rows, "bones", channel) < 0.75 * goal


def test_with_the_models_own_segments_opensim_is_met(gait_data):
    rows = study("gait10dof_segments").against_opensim(gait_data.parent / "opensim_gait10dof")
    own = {row[0]: [float(one) for one in row[2].split()] for row in rows if row[1] == "the model"}
    assert set(own) == {"ankle_angle", "knee_angle", "hip_flexion"}
    assert max(max(sizes) for sizes in own.values()) < 0.15
    ankles = [row[4] for row in rows if row[0] == "ankle_angle" and row[1] == "markers, joints free"]
    assert max(float(one) for one in ankles[0].split()) < 0.08


def test_the_filters_effect_is_a_sentence_with_its_numbers(found):
    sentence = study("moments").filter_effect(found)
    assert says(sentence, "knee extension moment", "3 steps", "median 0.")


def test_a_picture_is_drawn(found, tmp_path):
    module = study("moments")
    module.over_each_other({walk.person: walk.steps for walk in found[:1]}, str(tmp_path / "moments.png"))
    assert (tmp_path / "moments.png").stat().st_size > 20_000


def test_rms_counts_what_both_have():
    module = study("moments_tables")
    assert module.rms(np.array([1.0, 2.0, np.nan, 9.0]), np.array([1.5, 1.5, 3.0, 0.0])) == pytest.approx(0.5)
    assert np.isnan(module.rms(np.array([1.0]), np.array([0.0])))
