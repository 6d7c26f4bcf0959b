"""Labels, events and analog channels of a C3D file."""

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from texts import says

from gaitdisc.errors import ChannelError, UnitError
from gaitdisc.ingest.c3d_analog import AnalogLabel, analog_streams, emg_names
from gaitdisc.ingest.c3d_labels import (
    LabelMap,
    event_kind,
    file_events,
    list_people_names,
    make_unique,
    without_people,
    without_prefix,
)
from gaitdisc.ingest.c3d_parameters import C3DParameters


@given(st.lists(st.sampled_from(["", "a", "b", "a_1", "a_2", "point_1"]), max_size=12))
def test_no_two_names_are_equal(labels):
    names = make_unique(labels, "point")
    assert len(set(names)) == len(labels)
    assert all(names)


def test_names_of_people_are_removed():
    people = list_people_names(
        C3DParameters({("SUBJECTS", "NAMES"): ("Anna",), ("POINT", "LABELS"): ("Bert:LASI", "C7")})
    )
    assert set(people) == {"Anna", "Bert"}
    assert without_people("anna: EMG 1", people) == "EMG 1"
    assert without_people("Annabel", people) == "Annabel"
    assert without_people("Sensor: R TA", people) == "Sensor: R TA"
    assert without_prefix("Bert:LASI") == "LASI"


def test_the_map_takes_labels_numbers_and_descriptions():
    study = LabelMap({"Sensor 1.EMG": "emg_sol_r", "#5": "emg_ta_l", "Tibialis ant": "emg_ta_r"})
    assert study.name("#1", "sensor 1 emg", "") == "emg_sol_r"
    assert study.name("#5", "x", "") == "emg_ta_l"
    assert study.name("#15", "CH15", "TIBIALIS-ANT") == "emg_ta_r"
    assert study.name("#7", "", "") is None
    assert not study.unused([], "a.c3d")


def test_a_key_for_two_channels_is_refused():
    study = LabelMap({"Voltage": "emg_sol_r"})
    study.name("#1", "Voltage")
    with pytest.raises(ChannelError, match=r"'Voltage'.*2 channels.*'#<number>'"):
        study.name("#2", "voltage.")


def test_a_key_for_no_channel_is_reported_with_the_nearest():
    (finding,) = LabelMap({"L Rekt": "emg_rf_l"}).unused(["L Rect", "R Rect"], "a.c3d")
    assert says(finding.what, "'L Rekt'", "'emg_rf_l'", "'L Rect'")


def _events(times, labels, contexts=(), first_frame=1, used=None):
    values = {
        ("EVENT", "TIMES"): np.array(times, float).T.reshape(2, -1),
        ("EVENT", "LABELS"): tuple(labels),
        ("EVENT", "USED"): np.array([len(labels) if used is None else used]),
    }
    if contexts:
        values["EVENT", "CONTEXTS"] = tuple(contexts)
    return file_events(C3DParameters(values, "a.c3d"), 200, 100.0, first_frame)


@pytest.mark.parametrize(
    ("label", "context", "kind"),
    [
        ("Foot Strike", "Right", ("initial contact", "r")),
        ("Foot Off", "Left", ("foot off", "l")),
        ("LHS", "", ("initial contact", "l")),
        ("RTO", "", ("foot off", "r")),
        ("Right Foot Strike", "", ("initial contact", "r")),
        ("Event", "General", ("Event", "")),
    ],
)
def test_kinds(label, context, kind):
    assert event_kind(label, context) == kind


def test_times_are_minutes_and_seconds_before_cropping():
    events, findings = _events([(1, 1.5), (1, 0.2)], ["Foot Strike", "Foot Off"], ["Left", "Right"], first_frame=6001)
    assert [(event.label, event.side) for event in events] == [("foot off", "r"), ("initial contact", "l")]
    assert [event.time for event in events] == pytest.approx([0.2, 1.5])
    assert not findings


def test_the_dialect_without_contexts():
    events, _ = _events([(0, 0.1), (0, 0.3)], ["LHS", "RTO"])
    assert [(event.label, event.side) for event in events] == [("initial contact", "l"), ("foot off", "r")]


def test_events_outside_of_the_file_are_left_out_and_reported():
    events, findings = _events([(0, 1.0), (0, 9.0)], ["LHS", "LHS"])
    assert len(events) == 1
    assert says(findings[0].what, "events outside the 200 frames", "1 of 2")


def test_the_clock_of_the_cropped_file_is_recognised_and_reported():
    events, findings = _events([(0, 0.5), (0, 1.5)], ["LHS", "LTO"], first_frame=301)
    assert [event.time for event in events] == pytest.approx([0.5, 1.5])
    assert "which begins with frame 301" in findings[0].what


def test_a_group_without_events():
    assert _events(np.empty((0, 2)), []) == ((), [])
    assert file_events(C3DParameters({}), 200, 100.0, 1) == ((), [])
    assert _events([(0, 1.0)], ["LHS"], used=0) == ((), [])


def test_contacts_of_a_real_trial_are_where_the_plates_are_loaded(gait_data, reader):
    trial = reader.read(gait_data / "young_straight_and_turn/HC002D/straight/HC002D06.c3d")
    assert len(trial.events) == 12
    forces = trial.stream("forces")
    contacts = np.array([event.time for event in trial.events if event.label == "initial contact"])
    for plate in (1, 2):
        first = forces.time[np.argmax(forces[f"plate_{plate}_fz"] > 20)]
        assert np.min(np.abs(contacts - first)) < 0.02


def _streams(labels, units, channels=None, descriptions=(), plates=frozenset()):
    values = {("ANALOG", "LABELS"): tuple(labels), ("ANALOG", "UNITS"): tuple(units)}
    if descriptions:
        values["ANALOG", "DESCRIPTIONS"] = tuple(descriptions)
    rows = np.tile(np.arange(1.0, len(labels) + 1), (3, 1))
    return analog_streams(rows, C3DParameters(values, "a.c3d"), set(plates), LabelMap(channels))


def test_muscles_are_known_behind_the_words_of_the_device():
    streams, findings = _streams(["Voltage.L Rect", "Voltage.R Tib Ant", "Voltage.L Spare"], ["V", "mV", "V"])
    values, channels = streams["emg"]
    assert [(c.name, c.unit, c.side) for c in channels] == [("emg_rf_l", "V", "l"), ("emg_ta_r", "V", "r")]
    np.testing.assert_allclose(values[0], [1, 0.002])
    assert [c.name for c in streams["signals"][1]] == ["Voltage.L Spare"]
    assert says(findings[0].what, "1 voltage", "EMG", "signals (#3 Voltage.L")


def test_labels_that_are_all_alike_are_made_unique_by_description_then_by_place():
    cut = ["Voltage.Voltage."] * 3
    streams, _ = _streams(cut, ["V"] * 3, descriptions=[f"Analog EMG::Voltage [5,{n}]" for n in (1, 2, 3)])
    assert [c.name for c in streams["emg"][1]] == ["emg_5_1", "emg_5_2", "emg_5_3"]
    streams, _ = _streams(["EMG", "EMG"], ["V", "V"])
    assert [c.name for c in streams["emg"][1]] == ["emg_1", "emg_2"]


def test_two_channels_of_one_muscle_are_numbered_and_reported():
    assert emg_names([AnalogLabel(n, "R TA", "", "V") for n in (1, 2)]) == ["emg_ta_r_1", "emg_ta_r_2"]
    _, findings = _streams(["R TA", "R Tib Ant"], ["V", "V"])
    assert "several EMG channels have the same name (emg_ta_r" in findings[0].what


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
