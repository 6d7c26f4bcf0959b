from __future__ import annotations

import numpy as np
import pytest

from gaitdisc.batch.reconstruct_study import ReconstructionSettings, reconstruct_recording, reconstruct_study
from gaitdisc.errors import ChannelError, SchemaError
from gaitdisc.ingest.reading import read_trial
from gaitdisc.ingest.storage import write_storage
from gaitdisc.sensing.model_folder import save_model


@pytest.fixture
def model(study, tmp_path):
    settings = ReconstructionSettings(kinds=("delay ridge",), condition="nominal")
    _, people = reconstruct_study(study, ("knee_angle_r", "hip_flexion_r"), settings)
    save_model(people[0].fitted[0], tmp_path / "model")
    return tmp_path / "model"


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
    with pytest.raises(ChannelError, match="'hip_flexion_r' is needed"):
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
    with pytest.raises(ChannelError, match="'ankle_angle_r' is needed"):
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
    with pytest.raises(SchemaError, match=r"of three ways; 'zero'.*none"):
        reconstruct_recording(tmp_path / "gap.mot", model, tmp_path / "zero.mot", missing="zero")
