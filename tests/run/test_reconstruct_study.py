"""Reconstruction, of a study's walks and of one recording: which windows, which targets, which answer."""

from dataclasses import replace

import numpy as np
import pytest
import torch
from texts import says

from gaitdisc.channel import Channel
from gaitdisc.cohort.cohort import make_walks, the_twelve
from gaitdisc.cohort.demonstration import write_demonstration
from gaitdisc.errors import ChannelError, SamplingError, SchemaError, TrainingError, UnitError
from gaitdisc.ingest.reading import read_trial
from gaitdisc.ingest.storage import write_storage
from gaitdisc.ingest.study import Conditions, Participant, Study
from gaitdisc.ingest.table import write_table
from gaitdisc.reconstruction.model_folder import save_model
from gaitdisc.reconstruction.page import reconstruction_sentences
from gaitdisc.reconstruction.reconstruct_study import (
    ReconstructionSettings,
    reconstruct_recording,
    reconstruct_study,
    search_study,
)
from gaitdisc.reconstruction.sensed_walks import EDGE_S, read_walks, target_walk
from gaitdisc.recording import Recording

KINDS = ("linear", "delay ridge")


def test_every_participant_is_reconstructed_from_own_walks(study):
    done, people = reconstruct_study(study, ("knee_angle_r",), ReconstructionSettings(kinds=KINDS))
    assert done.participants == ("P01", "P02")
    rmse = done.over_participants()["rmse_deg"]
    assert rmse["delay ridge"] < rmse["linear"]
    assert "knee_angle_r" not in set(done.errors["state"])
    assert says(done.split, "temporal: first 70 % of each trial")
    assert len(done.provenance.files) == 4
    assert people[0].fitted[1].reconstructor.sensing.lags.count == 25


def test_where_it_was_fitted_is_said(study):
    done, people = reconstruct_study(study, ("knee_angle_r",), ReconstructionSettings(kinds=KINDS))
    assert done.provenance.settings["reconstruct"]["device"] == "cpu"
    assert {model.reconstructor.device for person in people for model in person.fitted} == {"cpu"}


@pytest.mark.skipif(torch.cuda.is_available(), reason="a GPU is there")
def test_a_gpu_that_is_not_there_is_refused_before_anything_is_fitted(study):
    with pytest.raises(TrainingError, match=r"'cuda'.*no GPU.*CPU.*'auto'"):
        reconstruct_study(study, ("knee_angle_r",), ReconstructionSettings(kinds=("linear", "shred"), device="cuda"))


@pytest.mark.parametrize(
    ("settings", "error", "words"),
    [
        ({"split": "subject"}, SamplingError, r"least.*training.*2"),
        ({"history_s": 40.0}, SamplingError, r"39\.96 s.*29"),
        ({"split": "condition"}, SchemaError, r"must have walks of.*condition.*--condition"),
    ],
)
def test_a_split_or_a_history_for_which_the_walks_do_not_do_is_refused(study, settings, error, words):
    with pytest.raises(error, match=words):
        reconstruct_study(study, ("knee_angle_r",), ReconstructionSettings(kinds=KINDS, **settings))


def test_forces_are_reconstructed_in_newtons_and_no_number_is_in_degrees(tmp_path):
    study = write_demonstration(tmp_path, 30.0, 1)
    settings = ReconstructionSettings(kinds=KINDS, condition="nominal", targets="forces")
    done, _ = reconstruct_study(study, ("hip_flexion_r", "knee_angle_r"), settings)
    assert set(done.errors["unit"]) == {"N"}
    assert done.summary["rmse_deg"].isna().all()
    over = done.over_participants()["relative_l2"]
    assert over["delay ridge"] < 0.5 * over["linear"]
    said = " ".join(reconstruction_sentences(done))
    assert says(said, "4 channels [N]", "L2", "0") and "deg" not in said
    later, _ = reconstruct_study(study, ("hip_flexion_r", "knee_angle_r"), replace(settings, ahead_s=0.1))
    assert later.states == done.states  # the sensors' own future was not asked for


def test_one_condition_is_reconstructed_from_the_other(study):
    settings = ReconstructionSettings(split="condition", condition="exo", kinds=KINDS)
    done, _ = reconstruct_study(study, ("knee_angle_r",), settings)
    within, _ = reconstruct_study(study, ("knee_angle_r",), ReconstructionSettings(kinds=KINDS))
    assert says(done.split, "condition: each condition is reconstructed")
    assert done.over_participants()["rmse_deg"]["delay ridge"] > within.over_participants()["rmse_deg"]["delay ridge"]


def test_states_ahead_of_the_last_reading(study):
    done, people = reconstruct_study(study, ("knee_angle_r",), ReconstructionSettings(kinds=KINDS, ahead_s=0.1))
    assert "knee_angle_r" in set(done.errors["state"])
    assert {"persistence", "phase average"} < set(done.models)
    assert says(done.history, "the states 0.10 s")
    assert people[0].fitted[0].reconstructor.sensing.lags.ahead == 10
    assert "reconstructs 5 future states" in reconstruction_sentences(done)[0]


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
        (ReconstructionSettings(targets="emg"), "requested: emg, 0 s ahead"),
        (ReconstructionSettings(ahead_s=0.1), "requested: states, 0.1 s ahead"),
    ],
)
def test_no_search_for_what_is_not_a_present_state(study, settings, found):
    words = rf"possible only for the present states.*{found}.*name the sensors with --sensors"
    with pytest.raises(SchemaError, match=words):
        search_study(study, 2, settings)


@pytest.fixture(scope="module")
def model(study, tmp_path_factory):
    settings = ReconstructionSettings(kinds=("delay ridge",), condition="nominal")
    _, people = reconstruct_study(study, ("knee_angle_r", "hip_flexion_r"), settings)
    folder = tmp_path_factory.mktemp("models") / "model"
    save_model(people[0].fitted[0], folder)
    return folder


def test_states_of_another_walk_are_reconstructed_written_and_compared(model, recordings, tmp_path):
    done = reconstruct_recording(recordings / "P01_nominal.mot", model, tmp_path / "states.mot")
    assert set(done.rmse) == {"ankle_angle_r", "hip_flexion_l", "knee_angle_l"}
    assert done.lines()[0].startswith("3 states of 29.")
    kept = read_trial(tmp_path / "states.mot").stream("kinematics")
    assert kept.names == done.states.names
    other = reconstruct_recording(recordings / "P01_exo.mot", model, tmp_path / "exo.mot")
    assert other.rmse["ankle_angle_r"] > done.rmse["ankle_angle_r"]


def test_sensors_alone_are_enough_and_without_one_it_is_refused(model, recordings, tmp_path):
    kinematics = read_trial(recordings / "P01_nominal.mot").stream("kinematics")
    write_storage(kinematics.selected(["hip_flexion_r", "knee_angle_r"]), tmp_path / "two.mot")
    assert reconstruct_recording(tmp_path / "two.mot", model, tmp_path / "states.mot").rmse == {}
    write_storage(kinematics.selected(["knee_angle_r"]), tmp_path / "one.mot")
    with pytest.raises(ChannelError, match="'hip_flexion_r' is"):
        reconstruct_recording(tmp_path / "one.mot", model, tmp_path / "states.mot")


def test_a_walk_with_all_states_corrects_the_model_for_another_person(model, recordings, tmp_path):
    other, out = recordings / "P02_exo.mot", tmp_path / "states.mot"
    before = reconstruct_recording(other, model, out)
    after = reconstruct_recording(other, model, out, calibration=recordings / "P02_nominal.mot")
    rms = [np.sqrt(np.mean(np.square(list(done.rmse.values())))) for done in (before, after)]
    assert rms[1] < 0.95 * rms[0]


def test_a_calibration_without_a_state_is_refused(model, recordings, tmp_path):
    kinematics = read_trial(recordings / "P01_nominal.mot").stream("kinematics")
    write_storage(kinematics.selected(["hip_flexion_r", "knee_angle_r"]), tmp_path / "two.mot")
    with pytest.raises(ChannelError, match="'ankle_angle_r' is"):
        reconstruct_recording(
            recordings / "P02_exo.mot", model, tmp_path / "states.mot", calibration=tmp_path / "two.mot"
        )


def test_missing_readings_are_bridged_on_request(model, recordings, tmp_path):
    kinematics = read_trial(recordings / "P01_nominal.mot").stream("kinematics")
    values = kinematics.values.copy()
    values[1000:1060, kinematics.index("knee_angle_r")] = np.nan
    write_storage(kinematics.with_values(values), tmp_path / "gap.mot")
    done = {
        way: reconstruct_recording(tmp_path / "gap.mot", model, tmp_path / f"{way}.mot", missing=way)
        for way in ("none", "last")
    }
    assert np.isnan(done["none"].states.values).any()
    assert np.isfinite(done["last"].states.values).all()
    assert np.isfinite(list(done["last"].rmse.values())).all()
    with pytest.raises(SchemaError, match=r"treatment of missing samples must be none, mean or last; found 'zero'"):
        reconstruct_recording(tmp_path / "gap.mot", model, tmp_path / "zero.mot", missing="zero")


def test_every_walk_is_filtered_trimmed_and_cut_into_strides(study):
    walks = read_walks(study, ("knee_angle_r",))
    assert list(walks.people) == ["P01", "P02"]
    assert [len(found) for found in walks.people.values()] == [2, 2]
    walk = walks.people["P01"][0]
    assert len(walk.recording.time) == pytest.approx(3000 - 200 * EDGE_S, abs=2)
    assert np.isfinite(walk.phi).mean() > 0.9
    assert [c.name for c in walks.channels][-2:] == ["hip_flexion_l", "knee_angle_l"]
    assert len(walks.files) == 4
    assert walks.named(("knee_angle_l", "knee_angle_r")) == (walks.channels[-1], walks.channels[1])


def test_one_condition_alone(study):
    assert [len(found) for found in read_walks(study, ("knee_angle_r",), "exo").people.values()] == [1, 1]


def test_a_sensor_that_was_not_recorded(study):
    with pytest.raises(ChannelError, match=r"refused. The first: .*'knee_ange_r'"):
        read_walks(study, ("knee_ange_r",))


def test_other_quantities_than_movement(tmp_path):
    study = write_demonstration(tmp_path, 15.0, 1)
    walks = read_walks(study, ("knee_angle_r",), "nominal", "forces")
    assert [channel.unit for channel in walks.channels] == ["deg", "N", "N", "N", "N"]
    [walk] = walks.people["W01"]
    assert len(walk.phi) == len(walk.recording.time)
    assert np.isfinite(walk.phi).mean() > 0.8
    with pytest.raises(SchemaError, match="'torque'"):
        read_walks(study, ("knee_angle_r",), "nominal", "torque")


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
        read_walks(both, ("knee_angle_r",), targets="emg")


SENSORS = ("hip_flexion_r", "knee_angle_r")
STUDY = Study(conditions=Conditions(nominal="nominal", device="exo"), participants=(Participant(id="W01"),))


@pytest.fixture(scope="module")
def trial():
    return make_walks(the_twelve()[0], 12.0).trials["nominal"]


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
    with pytest.raises(SchemaError, match="'power'"):
        target_walk(trial, STUDY, SENSORS, "power")
    with pytest.raises(ChannelError, match="'knee_ange_r' is"):
        target_walk(trial, STUDY, ("knee_ange_r",), "emg")
    with pytest.raises(ChannelError, match="moments; it has kinematics, emg"):
        target_walk(trial, STUDY, SENSORS, "moments")
    late = trial.stream("emg")
    late = replace(late, time=late.time + 100)
    with pytest.raises(SamplingError, match=r"emg.*sensors last.*0"):
        target_walk(with_stream(trial, "emg", late), STUDY, SENSORS, "emg")


def test_ground_forces_from_markers_of_a_real_walk(gait_data):
    trial = read_trial(gait_data / "treadmill_c3d_emg" / "walking_1.c3d")
    both, strides, findings = target_walk(trial, STUDY, ("RCAL.z", "LCAL.z"), "forces")
    assert {channel.unit for channel in both.channels[2:]} == {"N"}
    assert 600 < both["plate_1_fz"].max() < 1200
    assert len(strides) >= 5 and findings == []
