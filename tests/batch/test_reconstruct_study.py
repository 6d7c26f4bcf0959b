from __future__ import annotations

from dataclasses import replace

import pytest
import torch
from texts import says

from gaitdisc.batch.demonstration import write_demonstration
from gaitdisc.batch.reconstruct_study import ReconstructionSettings, reconstruct_study, search_study
from gaitdisc.errors import SamplingError, SchemaError, TrainingError
from gaitdisc.report.reconstruction_page import reconstruction_sentences

KINDS = ("linear", "delay ridge")


def test_every_participant_is_reconstructed_from_own_walks(study):
    done, people = reconstruct_study(study, ("knee_angle_r",), ReconstructionSettings(kinds=KINDS))
    assert done.participants == ("P01", "P02")
    rmse = done.over_participants()["rmse_deg"]
    assert rmse["delay ridge"] < rmse["linear"]
    assert "knee_angle_r" not in set(done.errors["state"])
    assert says(done.split, "temporal: each trial", "70 %")
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


def test_a_population_needs_three_people(study):
    with pytest.raises(SamplingError, match=r"least.*fit, to check.*2"):
        reconstruct_study(study, ("knee_angle_r",), ReconstructionSettings(split="subject", kinds=KINDS))


def test_a_history_longer_than_the_trial(study):
    settings = ReconstructionSettings(history_s=40.0, kinds=KINDS)
    with pytest.raises(SamplingError, match=r"39\.96 s.*29"):
        reconstruct_study(study, ("knee_angle_r",), settings)


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
    assert says(done.split, "condition: walks of one condition")
    assert done.over_participants()["rmse_deg"]["delay ridge"] > within.over_participants()["rmse_deg"]["delay ridge"]


def test_a_split_across_conditions_needs_the_one_that_is_tested(study):
    settings = ReconstructionSettings(split="condition", kinds=KINDS)
    with pytest.raises(SchemaError, match=r"needs walks of.*condition.*--condition"):
        reconstruct_study(study, ("knee_angle_r",), settings)


def test_states_ahead_of_the_last_reading(study):
    done, people = reconstruct_study(study, ("knee_angle_r",), ReconstructionSettings(kinds=KINDS, ahead_s=0.1))
    assert "knee_angle_r" in set(done.errors["state"])
    assert {"persistence", "phase average"} < set(done.models)
    assert says(done.history, "gives the states 0.10 s")
    assert people[0].fitted[0].reconstructor.sensing.lags.ahead == 10
    assert "future states are reconstructed" in reconstruction_sentences(done)[0]


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
