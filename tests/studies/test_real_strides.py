import importlib
import re

import pytest


def study(name):
    return importlib.import_module(name)


@pytest.fixture(scope="module")
def rows(gait_data):
    found = study("real_strides").run(gait_data)
    return {(recordings, promise): words for recordings, promise, words in found}


def numbers(words):
    return [float(n) for n in re.findall(r"-?\d+\.?\d*", words)]


@pytest.mark.parametrize(("trial", "strides"), [("natural2", 83), ("exotendon3", 88), ("manual_ik", 90)])
def test_strides_of_the_running_trials(rows, trial, strides):
    assert numbers(rows[f"exotendon_run/{trial}", f"{strides} strides, +-1"])[0] == pytest.approx(strides, abs=1)


def test_strides_of_the_twelve_walks(rows):
    kept, dropped, whole = numbers(rows["treadmill_walk_ik, 12 walks", "221 strides, +-1 %"])
    assert kept + dropped == whole == pytest.approx(221, rel=0.01)


def test_the_hip_plateau_is_found_by_itself(rows):
    walks, *limits = numbers(rows["treadmill_walk_ik, 12 walks", "hip plateau at -29.9 deg"])
    assert walks == 12
    assert limits == pytest.approx([-29.9, -29.9], abs=0.2)


def test_calibration_trials_are_no_walks(rows):
    refused = rows["treadmill_walk_ik, 2 calibrations", "refused as walking"]
    assert "S01DE503" in refused and "S01DN603" in refused


def test_sixteen_emg_channels_and_strides_from_chattering_belts(rows):
    assert rows["treadmill_c3d_emg", "16 EMG channels apart"].startswith("16:")
    right, left = numbers(rows["treadmill_c3d_emg", "6-7 strides a leg"])
    assert {right, left} <= {6.0, 7.0}
