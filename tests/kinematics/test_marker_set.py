"""What a marker set says of the labels of a recording: names, landmarks, followers, and what is lacking."""

import pytest

from gaitdisc.errors import SchemaError
from gaitdisc.kinematics.marker_set import choices, marker_set, shipped_marker_sets, sided


@pytest.mark.parametrize(("name", "right"), [("{S}ASI", "RASI"), ("knee_{s}", "knee_r"), ("{side} knee", "right knee")])
def test_a_side_is_written_in_three_ways(name, right):
    assert sided(name, "r") == right


def test_choices_and_midpoints():
    assert choices("SACR | LPSI + RPSI") == [("SACR",), ("LPSI", "RPSI")]
    assert choices("") == []


def test_the_first_choice_that_is_there_is_the_landmark():
    chosen = marker_set("plug_in_gait")
    assert chosen.landmark("sacrum", "l", ["SACR", "LPSI", "RPSI"]) == ("SACR",)
    assert chosen.landmark("sacrum", "l", ["LPSI", "RPSI"]) == ("LPSI", "RPSI")
    assert chosen.landmark("sacrum", "l", ["LPSI"]) == ()


def test_a_medial_marker_on_one_side_only_is_not_enough_for_a_midpoint():
    chosen = marker_set("helen_hayes")
    assert "thigh_wand" in chosen.needed_landmarks(["RKNM"])
    assert "knee_medial" in chosen.needed_landmarks(["RKNM", "LKNM"])


def test_no_alias_means_two_markers_of_a_set():
    for one in shipped_marker_sets().values():
        for marker in one.markers():
            assert one.names([marker]) == {marker: marker}


def test_aliases_are_found_whatever_their_case_and_dots():
    found = marker_set("helen_hayes").names(["r.asis", "L ASIS", "R_Knee_Medial", "V.Sacral", "C7"])
    assert found == {"RASI": "r.asis", "LASI": "L ASIS", "SACR": "V.Sacral", "RKNM": "R_Knee_Medial"}


def test_the_set_s_own_name_comes_before_an_alias():
    assert marker_set("helen_hayes").names(["RKNEE", "RKNE"])["RKNE"] == "RKNE"


def test_a_word_for_the_joints_that_is_none():
    with pytest.raises(SchemaError, match=r"free, held, planar.*'hold'.*'held'"):
        marker_set("rajagopal").with_joints("hold")
