from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from gaitdisc.batch.target_walks import target_walk
from gaitdisc.channel import Channel
from gaitdisc.cohort.cohort import the_twelve, walks_of
from gaitdisc.errors import ChannelError, SamplingError, SchemaError
from gaitdisc.ingest.reading import read_trial
from gaitdisc.ingest.study import Conditions, Participant, Study
from gaitdisc.recording import Recording

SENSORS = ("hip_flexion_r", "knee_angle_r")
STUDY = Study(conditions=Conditions(nominal="nominal", device="exo"), participants=(Participant(id="W01"),))


@pytest.fixture(scope="module")
def trial():
    return walks_of(the_twelve()[0], 12.0).trials["nominal"]


def with_stream(trial, key, recording):
    return replace(trial, streams={**trial.streams, key: recording})


@pytest.mark.parametrize(("targets", "unit", "count"), [("emg", "V", 14), ("forces", "N", 4)])
def test_sensors_then_targets_on_the_base_of_the_sensors(trial, targets, unit, count):
    both, strides, findings = target_walk(trial, STUDY, SENSORS, targets)
    assert both.names[:2] == SENSORS
    assert [channel.unit for channel in both.channels[2:]] == [unit] * count
    assert both.rate_hz == pytest.approx(100.0)
    assert (strides.side, findings) == ("r", [])
    assert both.subject == "W01"


def test_forces_keep_their_size(trial):
    both, _, _ = target_walk(trial, STUDY, SENSORS, "forces")
    raw = trial.stream("forces")["ground_force_r_vy"]
    inner = slice(50, -50)
    assert both["ground_force_r_vy"][inner].mean() == pytest.approx(raw.mean(), rel=0.05)


def test_joint_moments(trial):
    channel = Channel("ankle_angle_r_moment", "moment", "N m", "r")
    power = Channel("ankle_angle_r_power", "power", "W", "r")
    time = np.arange(1200) / 100
    moments = Recording(time, np.column_stack([80 + np.sin(6 * time), time]), (channel, power))
    both, _, _ = target_walk(with_stream(trial, "moments", moments), STUDY, SENSORS, "moments")
    assert both.names == (*SENSORS, "ankle_angle_r_moment")


def test_a_dead_muscle_is_left_out_and_reported(trial):
    emg = trial.stream("emg")
    values = emg.values.copy()
    values[:, 3] = 0.0
    both, _, [finding] = target_walk(with_stream(trial, "emg", emg.with_values(values)), STUDY, SENSORS, "emg")
    assert emg.names[3] not in both.names and len(both.names) == 2 + 13
    assert (finding.channel, finding.kind) == (emg.names[3], "left out")


def test_refusals(trial):
    with pytest.raises(SchemaError, match=r"kind of quantity; 'power'.*none"):
        target_walk(trial, STUDY, SENSORS, "power")
    with pytest.raises(ChannelError, match="'knee_ange_r' is needed"):
        target_walk(trial, STUDY, ("knee_ange_r",), "emg")
    with pytest.raises(ChannelError, match="moments; it has kinematics, emg"):
        target_walk(trial, STUDY, SENSORS, "moments")
    late = trial.stream("emg")
    late = replace(late, time=late.time + 100)
    with pytest.raises(SamplingError, match=r"emg.*common; sensors last.*0"):
        target_walk(with_stream(trial, "emg", late), STUDY, SENSORS, "emg")


def test_ground_forces_from_markers_of_a_real_walk(gait_data):
    trial = read_trial(gait_data / "treadmill_c3d_emg" / "walking_1.c3d")
    both, strides, findings = target_walk(trial, STUDY, ("RCAL.z", "LCAL.z"), "forces")
    assert {channel.unit for channel in both.channels[2:]} == {"N"}
    assert 600 < both["plate_1_fz"].max() < 1200
    assert len(strides) >= 5 and findings == []
