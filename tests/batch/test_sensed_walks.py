from __future__ import annotations

import numpy as np
import pytest

from gaitdisc.batch.demonstration import write_demonstration
from gaitdisc.batch.sensed_walks import EDGE_S, sensed_walks
from gaitdisc.channel import Channel
from gaitdisc.errors import ChannelError, SchemaError, UnitError
from gaitdisc.ingest.table import write_table
from gaitdisc.recording import Recording


def test_every_walk_is_filtered_trimmed_and_cut_into_strides(study):
    walks = sensed_walks(study, ("knee_angle_r",))
    assert list(walks.people) == ["P01", "P02"]
    assert [len(found) for found in walks.people.values()] == [2, 2]
    walk = walks.people["P01"][0]
    assert len(walk.recording.time) == pytest.approx(3000 - 200 * EDGE_S, abs=2)
    assert np.isfinite(walk.phi).mean() > 0.9
    assert [c.name for c in walks.channels][-2:] == ["hip_flexion_l", "knee_angle_l"]
    assert len(walks.files) == 4
    assert walks.named(("knee_angle_l", "knee_angle_r")) == (walks.channels[-1], walks.channels[1])


def test_one_condition_alone(study):
    assert [len(found) for found in sensed_walks(study, ("knee_angle_r",), "exo").people.values()] == [1, 1]


def test_a_sensor_that_was_not_recorded(study):
    with pytest.raises(ChannelError, match=r"refused, the first.*'knee_ange_r'"):
        sensed_walks(study, ("knee_ange_r",))


def test_other_quantities_than_movement(tmp_path):
    study = write_demonstration(tmp_path, 15.0, 1)
    walks = sensed_walks(study, ("knee_angle_r",), "nominal", "forces")
    assert [channel.unit for channel in walks.channels] == ["deg", "N", "N", "N", "N"]
    [walk] = walks.people["W01"]
    assert len(walk.phi) == len(walk.recording.time)
    assert np.isfinite(walk.phi).mean() > 0.8
    with pytest.raises(SchemaError, match="'torque' is none"):
        sensed_walks(study, ("knee_angle_r",), "nominal", "torque")


def test_one_unit_in_all_walks(study, tmp_path):
    noise = np.random.default_rng(0).normal(0.0, 0.2, (30_000, 1))
    people = []
    for person, unit in zip(study.participants, ("V", "1"), strict=True):
        emg = Recording(np.arange(30_000) / 1000, noise, (Channel("emg_sol_r", "emg", unit, "r"),))
        write_table(emg, tmp_path / f"{person.id}.csv")
        files = (str(study.path_of(person.trials[0].files[0])), str(tmp_path / f"{person.id}.csv"))
        people.append(person.model_copy(update={"trials": (person.trials[0].model_copy(update={"files": files}),)}))
    both = study.model_copy(update={"participants": tuple(people)})
    with pytest.raises(UnitError, match=r"emg_sol_r.*'V'.*'1'"):
        sensed_walks(both, ("knee_angle_r",), targets="emg")
