from __future__ import annotations

import pytest
from hypothesis import given
from hypothesis import strategies as st
from texts import says

from gaitdisc.errors import ChannelError
from gaitdisc.ingest.c3d_labels import LabelMap, made_unique, named_people, without_people, without_prefix
from gaitdisc.ingest.c3d_parameters import C3DParameters


@given(st.lists(st.sampled_from(["", "a", "b", "a_1", "a_2", "point_1"]), max_size=12))
def test_no_two_names_are_equal(labels):
    names = made_unique(labels, "point")
    assert len(set(names)) == len(labels)
    assert all(names)


def test_names_of_people_are_removed():
    people = named_people(C3DParameters({("SUBJECTS", "NAMES"): ("Anna",), ("POINT", "LABELS"): ("Bert:LASI", "C7")}))
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
