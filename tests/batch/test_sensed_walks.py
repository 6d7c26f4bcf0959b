from __future__ import annotations

import numpy as np
import pytest

from gaitdisc.batch.sensed_walks import EDGE_S, sensed_walks
from gaitdisc.errors import ChannelError


def test_every_walk_is_filtered_trimmed_and_cut_into_strides(study):
    walks = sensed_walks(study, ("knee_angle_r",))
    assert list(walks.people) == ["P01", "P02"]
    assert [len(found) for found in walks.people.values()] == [2, 2]
    walk = walks.people["P01"][0]
    assert len(walk.recording.time) == pytest.approx(3000 - 200 * EDGE_S, abs=2)
    assert np.isfinite(walk.phi).mean() > 0.9
    assert [c.name for c in walks.channels][-2:] == ["hip_flexion_l", "knee_angle_l"]
    assert len(walks.files) == 4


def test_one_condition_alone(study):
    assert [len(found) for found in sensed_walks(study, ("knee_angle_r",), "exo").people.values()] == [1, 1]


def test_a_sensor_that_was_not_recorded(study):
    with pytest.raises(ChannelError, match=r"all are refused, the first: .*channel 'knee_ange_r' is needed"):
        sensed_walks(study, ("knee_ange_r",))
