from __future__ import annotations

import numpy as np
import pytest
from texts import says

from gaitdisc.errors import UnitError
from gaitdisc.ingest.c3d_analog import AnalogLabel, analog_streams, emg_names
from gaitdisc.ingest.c3d_labels import LabelMap
from gaitdisc.ingest.c3d_parameters import C3DParameters


def _streams(labels, units, channels=None, descriptions=(), plates=frozenset()):
    values = {("ANALOG", "LABELS"): tuple(labels), ("ANALOG", "UNITS"): tuple(units)}
    if descriptions:
        values["ANALOG", "DESCRIPTIONS"] = tuple(descriptions)
    rows = np.tile(np.arange(1.0, len(labels) + 1), (3, 1))
    return analog_streams(rows, C3DParameters(values), set(plates), LabelMap(channels), "a.c3d")


def test_muscles_are_known_behind_the_words_of_the_device():
    streams, findings = _streams(["Voltage.L Rect", "Voltage.R Tib Ant", "Voltage.L Spare"], ["V", "mV", "V"])
    values, channels = streams["emg"]
    assert [(c.name, c.unit, c.side) for c in channels] == [("emg_rf_l", "V", "l"), ("emg_ta_r", "V", "r")]
    np.testing.assert_allclose(values[0], [1, 0.002])
    assert [c.name for c in streams["signals"][1]] == ["Voltage.L Spare"]
    assert says(findings[0].what, "1 voltages", "EMG", "signals (#3 Voltage.L")


def test_labels_that_are_all_alike_are_made_unique_by_description_then_by_place():
    cut = ["Voltage.Voltage."] * 3
    streams, _ = _streams(cut, ["V"] * 3, descriptions=[f"Analog EMG::Voltage [5,{n}]" for n in (1, 2, 3)])
    assert [c.name for c in streams["emg"][1]] == ["emg_5_1", "emg_5_2", "emg_5_3"]
    streams, _ = _streams(["EMG", "EMG"], ["V", "V"])
    assert [c.name for c in streams["emg"][1]] == ["emg_1", "emg_2"]


def test_two_channels_of_one_muscle_are_numbered_and_reported():
    assert emg_names([AnalogLabel(n, "R TA", "", "V") for n in (1, 2)]) == ["emg_ta_r_1", "emg_ta_r_2"]
    _, findings = _streams(["R TA", "R Tib Ant"], ["V", "V"])
    assert "several channels mean emg_ta_r" in findings[0].what


def test_a_force_is_no_emg_whatever_it_is_called():
    streams, _ = _streams(["R TA", "EMG trigger"], ["N", "Nmm"])
    assert [c.unit for c in streams["signals"][1]] == ["N", "N m"]
    assert "emg" not in streams


def test_unknown_units_are_reported_and_nothing_is_scaled():
    streams, findings = _streams(["CH7", "EMG1"], ["d.u.", "ADC"])
    assert streams["signals"][1][0].unit == streams["emg"][1][0].unit == "1"
    assert says(findings[0].what, "2 analog channels", "(#2 EMG1, #1 CH7)")


def test_channels_of_plates_do_not_pass_twice():
    streams, _ = _streams(["Fx", "Fz", "EMG1"], ["N", "N", "V"], plates={0, 1})
    assert list(streams) == ["emg"]


def test_the_study_names_channels():
    channels = {"CH1": "emg_sol_r [mV]", "#2": "ground_force_r_vy", "Goniometer": "knee_l [deg]"}
    streams, _ = _streams(["CH1", "x", "gonio-meter"], ["d.u.", "kN", "V"], channels)
    assert (streams["emg"][1][0].name, streams["emg"][0][0, 0]) == ("emg_sol_r", 0.001)
    assert (streams["forces"][1][0].quantity, streams["forces"][0][0, 0]) == ("vertical_force", 2000)
    assert (streams["signals"][1][0].name, streams["signals"][1][0].unit) == ("knee_l", "deg")


def test_a_mapped_channel_needs_the_right_unit():
    with pytest.raises(UnitError, match=r"'emg_sol_r'.*a.c3d.*'d.u.'.*'emg_sol_r \[V\]'"):
        _streams(["CH1"], ["d.u."], {"CH1": "emg_sol_r"})
    with pytest.raises(UnitError, match=r"'emg_sol_r'.*a.c3d"):
        _streams(["CH1"], ["N"], {"CH1": "emg_sol_r"})


def test_names_that_laboratories_use(gait_data, reader):
    trial = reader.read(gait_data / "c3d_reader_samples/gait/1123x01EMG.c3d")
    muscles = ("rf", "hamlat", "ta", "gaslat")
    assert trial.stream("emg").names == tuple(f"emg_{muscle}_{side}" for side in "rl" for muscle in muscles)
    assert np.abs(trial.stream("emg").values).max() < 0.02  # the file is in mV
    assert AnalogLabel(1, "R.Med.Hams", "", "mV").muscle.name == "emg_hammed_r"
