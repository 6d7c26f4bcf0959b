"""The study of angles against other software, on one person and on OpenSim's walk."""

import numpy as np
import pytest
from markers_to_angles import against_opensim
from plug_in_gait_angles import WRITTEN_WITH, against_plug_in_gait, nearest_axis, people


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


def test_opensim_s_planar_model_is_nearest_to_ours_in_the_plane(data):
    rows = against_opensim(data)
    free, planar = (np.median([float(row[column]) for row in rows]) for column in (2, 4))
    assert planar <= 3 < max(float(row[2]) for row in rows)
    assert planar < free


def test_plug_in_gait_takes_an_axis_for_the_direction():
    assert nearest_axis(np.array([0.05, -0.99, 0.0])) == (0.0, -1.0, 0.0)
