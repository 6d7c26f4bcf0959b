"""What labels of columns mean: maps, units, OpenSim's names."""

import numpy as np
import pytest
from texts import says

from gaitdisc.errors import ChannelError, UnitError
from gaitdisc.ingest.columns import (
    check_written_names,
    column_in_unit,
    find_stream,
    map_label,
    name_channel,
    split_unit,
)
from gaitdisc.ingest.storage import StorageHeader, naming_findings, storage_columns


def test_units_stand_in_brackets_at_the_end():
    assert split_unit(" foo [bar] [mV] ") == ("foo [bar]", "mV")
    assert split_unit("foo []") == ("foo", "")
    assert split_unit("[x] foo") == ("[x] foo", None)


def test_labels_are_mapped_exactly_first_and_then_by_likeness_unless_two_are_alike():
    assert map_label("EMG 1", {"EMG 1": "a", "emg1": "b"}) == "a"
    assert map_label("emg-1", {"EMG 1": "a"}) == "a"
    assert map_label("emg-1", {"EMG 1": "a", "emg1": "b"}) is None
    assert map_label("x", None) is None
    assert map_label("--", {"..": "a"}) is None


@pytest.mark.parametrize(
    ("name", "quantity", "unit", "side"),
    [
        ("ankle_angle_r", "angle", "deg", "r"),
        ("emg_sol_l", "emg", "V", "l"),
        ("emg_gracilis_r", "emg", "V", "r"),
        ("RHEE.z", "marker", "m", ""),
        ("wrist_flex_l_moment", "moment", "N m", "l"),
        ("pelvis_tx_force", "force", "N", ""),
        ("knee_angle_r_beta_force", "moment", "N m", "r"),
        ("sync", "signal", "1", ""),
    ],
)
def test_names_tell_quantities(name, quantity, unit, side):
    channel = name_channel(name)
    assert (channel.quantity, channel.unit, channel.side) == (quantity, unit, side)


@pytest.mark.parametrize(
    ("name", "unit", "inside", "one"),
    [
        ("knee_angle_r", "rad", "deg", np.degrees(1.0)),
        ("pelvis_tx", "mm", "m", 1e-3),
        ("ground_force_r_vy", "kN", "N", 1e3),
        ("ankle_angle_r_moment", "Nmm", "N m", 1e-3),
        ("ankle_angle_r_moment", "N m/kg", "N m/kg", 1.0),
        ("emg_sol_r", "uV", "V", 1e-6),
        ("emg_sol_r", "%", "%", 1.0),
        ("trigger", "mV", "V", 1e-3),
        ("gyro", "rad/s", "deg/s", np.degrees(1.0)),
        ("skin", "degC", "degC", 1.0),
        ("pulse", "1/min", "1/min", 1.0),
        ("ratio", "1", "1", 1.0),
    ],
)
def test_stated_units_are_converted_to_those_inside(name, unit, inside, one):
    column = column_in_unit(name, name_channel(name), unit, "a.csv")
    assert column.channel.unit == inside
    assert column.convert(np.array([1.0]))[0] == pytest.approx(one, rel=1e-12)


def test_the_rate_of_an_angle_is_not_the_angle():
    column = column_in_unit("x", name_channel("knee_angle_r"), "deg/s", "a.csv")
    assert (column.channel.name, column.channel.quantity) == ("knee_angle_r/speed", "signal")


def test_an_unknown_unit_and_one_of_another_quantity_are_refused():
    with pytest.raises(UnitError, match=r"a\.csv.*'F'.*'Nn'.*'N'"):
        column_in_unit("F", name_channel("ground_force_r_vy"), "Nn", "a.csv")
    with pytest.raises(UnitError, match=r"'k'.*knee_angle_r.*'mm'"):
        column_in_unit("k", name_channel("knee_angle_r"), "mm", "a.csv")
    with pytest.raises(UnitError, match=r"'skin'.*found 'K'; temperatures must be in degC.*have an offset"):
        column_in_unit("skin", name_channel("skin"), "K", "a.csv")


def test_names_that_a_text_table_cannot_hold_are_refused():
    check_written_names(["R Tib Ant", "µ"], "a.csv")
    for name in ("a\tb", "a\nb", " a"):
        with pytest.raises(ChannelError, match=r"a\.csv.*names in a text table"):
            check_written_names([name], "a.csv")


def _column(label, title="", channels=None, file="a.sto"):
    return storage_columns(StorageHeader(title, ("time", label), 3), file, channels)[0]


KIND = {"v": ("force", "N"), "p": ("pressure_centre", "m"), "m": ("moment", "N m")}


@pytest.mark.parametrize(
    "label", ["{}", "1_{}", "2_{}", "{}_r", "{}_l", "{}_1", "{}_2", "R_{}", "L_{}", "right_{}", "left_{}"]
)
@pytest.mark.parametrize("stem", ["ground_force", "grf", "FP1_force", "FP2"])
def test_the_last_letters_say_force_place_or_moment(stem, label):
    for kind, (quantity, unit) in KIND.items():
        for axis in "xyz":
            channel = _column(f"{label.format(stem)}_{kind}{axis}", "ground reactions").channel
            wanted = "vertical_force" if kind + axis == "vy" else quantity
            assert (channel.quantity, channel.unit) == (wanted, unit), channel


@pytest.mark.parametrize(
    "stem", ["ground_torque", "1_ground_torque", "ground_torque_2", "ground_moment_1", "FP1_moment"]
)
def test_a_torque_is_a_moment_whatever_its_axis(stem):
    for axis in "xyz":
        channel = _column(f"{stem}_{axis}", "ground reactions").channel
        assert (channel.quantity, channel.unit) == ("moment", "N m")
        assert find_stream(channel) == "forces"


@pytest.mark.parametrize(
    ("label", "name"),
    [
        ("ground_force_l_my", "ground_torque_l_y"),
        ("1_ground_force_my", "ground_torque_l_y"),
        ("ground_force_r_mz", "ground_torque_r_z"),
        ("R_ground_torque_x", "ground_torque_r_x"),
    ],
)
def test_moments_named_after_the_force_are_free_moments(label, name):
    assert _column(label, "ground reactions").channel.name == name


def test_a_place_in_the_name_of_a_point_is_no_ground_reaction():
    assert _column("FP1_x").channel.quantity == "signal"


@pytest.mark.parametrize(
    ("label", "title", "name", "quantity", "unit"),
    [
        ("/jointset/hip_r/hip_flexion_r/value", "Coordinates", "hip_flexion_r", "angle", "deg"),
        ("/jointset/hip_r/hip_flexion_r/speed", "states", "hip_flexion_r/speed", "signal", "deg/s"),
        ("/jointset/ground_pelvis/pelvis_tx/speed", "states", "pelvis_tx/speed", "signal", "m/s"),
        ("/forceset/soleus_r/activation", "states", "/forceset/soleus_r/activation", "signal", "1"),
        ("knee_angle_r", "Speeds", "knee_angle_r/speed", "signal", "deg/s"),
        ("knee_angle_r", "Accelerations", "knee_angle_r/accel", "signal", "deg/s2"),
        ("knee_angle_r", "Kinematics_u", "knee_angle_r/speed", "signal", "deg/s"),
        ("pelvis_tx", "Kinematics_dudt", "pelvis_tx/accel", "signal", "m/s2"),
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
    assert says(_column("ch 7", channels={"ch 7": "load"}).guessed, "[channels]")


def test_guesses_are_reported_together():
    header = StorageHeader("x", ("time", *(f"c{i}" for i in range(9))), 3)
    (finding,) = naming_findings(storage_columns(header, "a.sto"), "a.sto")
    assert says(finding.what, "c0, c1, c2, c3, c4,", "c5", "3 more")


def test_sides_of_unmarked_ground_forces_are_reported():
    header = StorageHeader("grf", ("time", "ground_force_vy", "1_ground_force_vy"), 3)
    (finding,) = naming_findings(storage_columns(header, "a.mot"), "a.mot")
    assert says(finding.what, "ground_force_", "right")


def test_names_known_to_the_vocabulary_are_no_guess():
    header = StorageHeader("Coordinates", ("time", "hip_flexion_r", "pelvis_tx"), 3)
    assert naming_findings(storage_columns(header, "a.mot"), "a.mot") == []


@pytest.mark.parametrize(
    ("title", "unit"), [("Actuation_force", "N"), ("ForceReporter", "N"), ("Actuation_power", "W")]
)
def test_forces_and_powers_of_muscles_are_no_emg(title, unit):
    column = _column("soleus_r", title)
    assert (column.channel.name, column.channel.quantity, column.channel.unit) == ("soleus_r", "signal", unit)
    assert column.guessed == f"{title} of a muscle, not EMG"
    assert _column("soleus_r").channel.name == "emg_sol_r"
