from __future__ import annotations

import pytest

from gaitdisc.batch.reconstruct_study import ReconstructionSettings
from gaitdisc.batch.search_study import search_study
from gaitdisc.errors import SchemaError


def test_sensors_are_searched_for_all_participants_together(study):
    found = search_study(study, 2, ReconstructionSettings(spacing_s=0.1))
    assert found["sensors"].tolist() == [1, 2]
    assert found["fits"].tolist() == [5 * 2, 10 * 2]
    assert set(found["names"][1].split(", ")) <= {"hip_flexion_r", "knee_angle_r", "ankle_angle_r", "hip_flexion_l",
                                                  "knee_angle_l"}  # fmt: skip
    assert found["loss"][1] < found["loss"][0]


@pytest.mark.parametrize(
    ("settings", "found"),
    [
        (ReconstructionSettings(targets="emg"), "emg are to be reconstructed 0 s ahead"),
        (ReconstructionSettings(ahead_s=0.1), "states are to be reconstructed 0.1 s ahead"),
    ],
)
def test_no_search_for_what_is_not_a_present_state(study, settings, found):
    with pytest.raises(SchemaError, match=rf"searched for the states.*{found}.*name the sensors with --sensors"):
        search_study(study, 2, settings)
