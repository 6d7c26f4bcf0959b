"""Several files of one walk become one trial; what is written comes back."""

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from hypothesis.extra.numpy import arrays
from texts import says

from gaitdisc.channel import Channel, vocabulary
from gaitdisc.errors import ChannelError, ReadError, SamplingError, StrideError, UnitError
from gaitdisc.ingest.reading import READERS, WRITERS, read_planned_trial, read_trial
from gaitdisc.ingest.storage import write_storage
from gaitdisc.ingest.study import Conditions, Participant, PlannedTrial, Study
from gaitdisc.recording import Recording


def _csv(folder, name, header, rate=100.0, count=50, start=0.0):
    rows = "".join(
        ",".join([repr(start + i / rate), *["1"] * header.count(",")]) + "\n" for i in range(count)
    )  # fmt: skip
    (folder / name).write_text(header + "\n" + rows)
    return folder / name


def test_real_files_of_one_walk(gait_data):
    folder = gait_data / "opensim_walks" / "mrs_emg_walking"
    names = ["IK_gait.mot", "GRF_gait.mot", "EMG_gait.mot", "ID_gait.sto", "TRC_gait.trc"]
    trial = read_trial([folder / name for name in names], subject="P01", condition="natural", crop_s=(1.06, 3.2))
    assert {key: r.rate_hz for key, r in trial.streams.items()} == {
        "kinematics": 100,
        "forces": 1000,
        "emg": 1000,
        "moments": 100,
        "markers": 100,
    }
    assert all(r.subject == "P01" and r.condition == "natural" for r in trial.streams.values())
    assert trial.streams["emg"].time[0] == pytest.approx(1.06)
    together = trial.on_one_base(100.0, ("kinematics", "emg"))
    assert together.values.shape == (214, 37 + 24)


def test_a_real_c3d_goes_with_the_others(gait_data):
    trial = read_trial(gait_data / "opensim_walks" / "c3d_walk_noemg" / "walking2.c3d", subject="P01")
    assert trial.streams["markers"].rate_hz == 250
    assert trial.subject == "P01"


def test_columns_on_one_base_are_joined_and_the_sources_named(tmp_path):
    paths = [_csv(tmp_path, "l.csv", "time,emg_sol_l"), _csv(tmp_path, "r.csv", "time,emg_sol_r,knee_angle_r")]
    trial = read_trial(paths)
    assert trial.streams["emg"].names == ("emg_sol_l", "emg_sol_r")
    assert trial.streams["emg"].source.file == "l.csv + r.csv"
    assert len(trial.streams["emg"].source.sha256) == 129
    assert trial.streams["kinematics"].source.file == "r.csv"


def test_what_cannot_be_joined_is_refused(tmp_path):
    one = _csv(tmp_path, "a.csv", "time,emg_sol_l")
    with pytest.raises(SamplingError, match=r"a\.csv.*b\.csv.*50 samples.*0 s.*100 Hz.*50.*0 s.*200"):
        read_trial([one, _csv(tmp_path, "b.csv", "time,emg_sol_r", 200.0)])
    with pytest.raises(ChannelError, match=r"a\.csv.*b\.csv.*'emg_sol_l' \(1"):
        read_trial([one, _csv(tmp_path, "b.csv", "time,emg_sol_l")])
    trial = read_trial([_csv(tmp_path, "a.csv", "time,x [V]"), _csv(tmp_path, "b.csv", "time,y [V]", 200.0)])
    assert trial.streams["signals"].names == ("x",)
    assert says(trial.findings[0].what, "excluded", "different time base")


def test_unknown_endings_are_refused_with_the_list(tmp_path):
    with pytest.raises(ReadError, match=r"\.c3d.*'\.cvs'.*'\.csv'"):
        read_trial(tmp_path / "walk.cvs")
    with pytest.raises(ReadError, match=r"walk.*ending is ''"):
        read_trial(tmp_path / "walk")
    with pytest.raises(ReadError, match="a trial must have at least one file"):
        read_trial([])


def test_the_crop_keeps_its_part_and_must_lie_inside(tmp_path):
    path = _csv(tmp_path, "a.csv", "time,knee_angle_r")
    walk = read_trial(path, crop_s=(0.1, 0.2)).streams["kinematics"]
    np.testing.assert_allclose(walk.time, np.arange(10, 20) / 100)
    with pytest.raises(SamplingError, match=r"5.*6 s.*0.*0\.49 s"):
        read_trial(path, crop_s=(5, 6))


def test_the_unit_of_angles_is_checked_in_what_the_crop_leaves(tmp_path):
    time = np.arange(400) / 100
    hip, knee = 0.4 * np.cos(2 * np.pi * time), 0.5 - 0.5 * np.cos(4 * np.pi * time)
    hip[200:], knee[200:] = 9 * np.sin(time[200:]), 8 * np.cos(time[200:])  # a fit that lost its markers
    channels = tuple(one for one in vocabulary().channels if one.name in ("hip_flexion_r", "knee_angle_r"))
    write_storage(Recording(time, np.column_stack([hip, knee]), channels), tmp_path / "ik.mot")
    assert "kinematics" in read_trial(tmp_path / "ik.mot").streams  # nothing shows it in the whole
    with pytest.raises(UnitError, match=r"ik\.mot"):
        read_trial(tmp_path / "ik.mot", crop_s=(0.0, 1.99))


def test_labels_of_the_study_that_no_file_has_are_reported(tmp_path):
    path = _csv(tmp_path, "a.csv", "time,ch 1")
    trial = read_trial(path, {"ch 1": "emg_sol_r", "ch 2": "emg_sol_l"})
    assert len(trial.findings) == 1 and says(trial.findings[0].what, "[channels]", "'ch 2'")


def test_events_of_a_table_lie_within_the_recording(tmp_path):
    walk, events = _csv(tmp_path, "walk.csv", "time,knee_angle_r"), tmp_path / "walk_events.csv"
    events.write_text("event,side,time\nheel strike,r,0.2\nfoot off,r,0.4\n")
    assert [(one.label, one.time) for one in read_trial([walk, events]).events] == [
        ("initial contact", 0.2),
        ("foot off", 0.4),
    ]
    events.write_text("event,side,time\nheel strike,r,0.2\nfoot off,r,2.4\n")
    with pytest.raises(SamplingError, match=r"walk_events.csv: .* from 0.00 to 0.49 s; .* 1 of 2 \(first: 2.40 s\)"):
        read_trial([walk, events])


def test_a_trial_that_the_study_leaves_out_is_not_read(tmp_path):
    planned = PlannedTrial(condition="walk", files=("walk.csv",), leave_out="tripped")
    person = Participant(id="P01", trials=(planned,))
    study = Study(conditions=Conditions(nominal="walk"), participants=(person,)).placed(tmp_path)
    with pytest.raises(StrideError, match="leaves out this trial; tripped"):
        read_planned_trial(study, person, planned)


def test_a_planned_trial_has_the_name_of_the_plan(tmp_path):
    _csv(tmp_path, "a.csv", "time,ch 1")
    trials = tuple(PlannedTrial(condition="natural", files=("a.csv",), crop_s=(0.1 * i, 0.4)) for i in range(2))
    person = Participant(id="P07", trials=trials)
    conditions = Conditions(nominal="natural", device="exo")
    study = Study(conditions=conditions, channels={"ch 1": "emg_sol_r"}, participants=(person,)).placed(tmp_path)
    trial = read_planned_trial(study, person, person.trials[1])
    assert (trial.name, trial.subject, trial.condition) == ("P07 natural 2", "P07", "natural")
    assert trial.streams["emg"].time[0] == pytest.approx(0.1)


SHARED = [*vocabulary().channels, Channel("RHEE.x", "marker", "m"), Channel("pelvis_tx_force", "force", "N")]
SHARED += [Channel(c.name, "emg", "1", c.side) for c in vocabulary().channels if c.quantity == "emg"]
STATED = [  # by the header of a storage file alone
    Channel("sync pulse", "signal", "V"),
    Channel("strain", "signal", "deg/s"),
    Channel("device_angle_r", "angle", "deg", "r"),
    Channel("m=1 [x]", "signal", "1"),
    Channel("ground_force_r_vx_", "force", "N/kg", "r"),
]
QUOTED = [
    Channel("emg_sol_x", "emg", "1"),
    Channel("sync, pulse", "signal", "V"),
    Channel('say "x" [y]', "signal", "N"),
    Channel("exo_r", "angle", "deg", "r"),
]


@st.composite
def recordings(draw, channels):
    chosen = draw(st.lists(st.sampled_from(channels), min_size=1, max_size=6, unique_by=lambda c: c.name))
    count, rate = draw(st.integers(2, 8)), draw(st.sampled_from([60.0, 100.0, 148.148, 2000.0]))
    values = draw(arrays(float, (count, len(chosen)), elements=st.floats(-1e6, 1e6)))
    column = draw(st.integers(0, len(chosen) - 1))
    if "force" not in chosen[column].quantity and draw(st.booleans()):
        values[draw(st.integers(0, count - 1)), column] = np.nan
    return Recording(draw(st.sampled_from([0.0, 0.45, 3.3, 12.3])) + np.arange(count) / rate, values, tuple(chosen))


@pytest.mark.parametrize(("ending", "own"), [(".sto", STATED), (".csv", QUOTED), (".parquet", QUOTED)])
@given(data=st.data())
def test_round_trip(tmp_path_factory, ending, own, data):
    recording = data.draw(recordings(SHARED + own))
    path = WRITERS[ending](recording, tmp_path_factory.mktemp("rt") / f"walk{ending}")
    streams = READERS[ending](path).streams.values()
    back = {c.name: (c, stream[c.name], stream.time) for stream in streams for c in stream.channels}
    assert set(back) == set(recording.names)
    for channel in recording.channels:
        found, values, time = back[channel.name]
        assert found == channel
        np.testing.assert_array_equal(values, recording[channel.name])
        np.testing.assert_array_equal(time, recording.time)
