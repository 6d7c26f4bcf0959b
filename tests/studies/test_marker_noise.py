"""The study of skin and dropout: what is lost and what slides is what the tables say."""

import numpy as np
import pytest
from marker_noise import SHOWN, errors
from moved_markers import LOST_S, bodies, lost, slid


@pytest.fixture(scope="module")
def several(gait_data):
    return bodies(gait_data.parent)


def test_skin_slides_by_what_the_table_says(several):
    body = several[-1]
    sliding = slid(body, 10.0, np.random.default_rng(0)).values - body.rigid.values
    thigh = [body.rigid.index(f"{side}.Thigh.{place}.{axis}") for side in "RL"
             for place in ("Upper", "Front", "Rear") for axis in "xyz"]  # fmt: skip
    assert 1e3 * np.sqrt(np.mean(sliding[:, thigh] ** 2)) == pytest.approx(10, rel=0.2)


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
