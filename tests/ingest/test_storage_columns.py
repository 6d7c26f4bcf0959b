"""What the labels of OpenSim files mean."""

from __future__ import annotations

import pytest

from gaitdisc.ingest.storage_columns import naming_findings, storage_columns
from gaitdisc.ingest.storage_header import StorageHeader


def _column(label, title="", channels=None, file="a.sto"):
    return storage_columns(StorageHeader(title, ("time", label), 3), file, channels)[0]


@pytest.mark.parametrize(
    ("label", "title", "name", "quantity", "unit"),
    [
        ("/jointset/hip_r/hip_flexion_r/value", "Coordinates", "hip_flexion_r", "angle", "deg"),
        ("/jointset/hip_r/hip_flexion_r/speed", "states", "hip_flexion_r/speed", "signal", "deg/s"),
        ("/jointset/ground_pelvis/pelvis_tx/speed", "states", "pelvis_tx/speed", "signal", "m/s"),
        ("/forceset/soleus_r/activation", "states", "/forceset/soleus_r/activation", "signal", "1"),
        ("knee_angle_r", "Speeds", "knee_angle_r/speed", "signal", "deg/s"),
        ("knee_angle_r", "Accelerations", "knee_angle_r/accel", "signal", "deg/s2"),
        ("patella_tx", "Coordinates", "patella_tx", "translation", "m"),
        ("neck_flexion", "Coordinates", "neck_flexion", "angle", "deg"),
        ("arm_flex_l_moment", "Inverse Dynamics", "arm_flex_l_moment", "moment", "N m"),
        ("pelvis_ty_force", "Inverse Dynamics", "pelvis_ty_force", "force", "N"),
        ("ground_force_vy", "grf", "ground_force_r_vy", "vertical_force", "N"),
        ("1_ground_force_pz", "grf", "ground_force_l_pz", "pressure_centre", "m"),
        ("1_ground_torque_y", "grf", "ground_torque_l_y", "moment", "N m"),
        ("2_ground_force_vy", "grf", "2_ground_force_vy", "vertical_force", "N"),
        ("2_ground_force_vx", "grf", "2_ground_force_vx", "force", "N"),
        ("2_ground_torque_x", "grf", "2_ground_torque_x", "moment", "N m"),
        ("grf_force_px", "grf", "grf_force_px", "pressure_centre", "m"),
        ("HamL_r", "EMG", "emg_hamlat_r", "emg", "1"),
        ("soleus", "Electromyography", "emg_sol", "emg", "1"),
        ("gracilis_l", "EMG", "emg_gracilis_l", "emg", "1"),
        ("knee_angle_r [rad]", "x", "knee_angle_r", "angle", "deg"),
        ("Sol_r [mV]", "x", "emg_sol_r", "emg", "V"),
        ("sync", "x", "sync", "signal", "1"),
    ],
)
def test_labels_become_channels(label, title, name, quantity, unit):
    channel = _column(label, title).channel
    assert (channel.name, channel.quantity, channel.unit) == (name, quantity, unit)


def test_the_study_comes_before_the_vocabulary():
    assert _column("Sol_r", channels={"Sol_r": "emg_sol_l [mV]"}).channel.name == "emg_sol_l"
    assert _column("Sol_r", channels={"Sol_r": "emg_sol_l [mV]"}).unit == "mV"
    assert _column("Sol_r", channels={"sol r": "emg_sol_l"}).channel.unit == "1"
    assert _column("ch 7", channels={"ch 7": "load [N]"}).channel.unit == "N"
    assert _column("ch 7", channels={"ch 7": "load"}).guessed == "its name is in [channels], its unit is not"


def test_guesses_are_told_together():
    header = StorageHeader("x", ("time", *(f"c{i}" for i in range(9))), 3)
    (finding,) = naming_findings(storage_columns(header, "a.sto"), "a.sto")
    assert finding.what == "c0, c1, c2, c3, c4, c5 and 3 more: unknown name, kept as a signal without a unit"


def test_sides_of_unmarked_ground_forces_are_told():
    header = StorageHeader("grf", ("time", "ground_force_vy", "1_ground_force_vy"), 3)
    (finding,) = naming_findings(storage_columns(header, "a.mot"), "a.mot")
    assert "ground_force_ is taken as the right foot" in finding.what


def test_names_known_to_the_vocabulary_are_no_guess():
    header = StorageHeader("Coordinates", ("time", "hip_flexion_r", "pelvis_tx"), 3)
    assert naming_findings(storage_columns(header, "a.mot"), "a.mot") == []
