"""Marker sets: those that come along, a laboratory's own and bad ones; what they say of the labels of a recording."""

import re
from pathlib import Path

import pytest
from manufactured_body import MEASURES, PLUG_IN_GAIT, known_angles, markers_of, renamed, static_of

from gaitdisc.errors import ChannelError, ReadError, SchemaError
from gaitdisc.kinematics.marker_set import marker_set, read_marker_set, read_marker_sets, recognise_marker_set
from gaitdisc.kinematics.markers import marker_labels
from gaitdisc.kinematics.motion import move_body

OWN = """
title = "Our laboratory"

[landmarks]
asis = "{side} spine"
sacrum = "sacrum"
thigh_wand = "{side} thigh"
knee_lateral = "{side} knee"
shank_wand = "{side} shank"
ankle_lateral = "{side} ankle"
heel = "{side} heel"
toe = "{side} toe"

[joint_centres]
hip = "harrington"
knee = "chord"
ankle = "chord"

[tracked]
pelvis = ["{side} spine", "sacrum"]
thigh = ["hip", "{side} thigh", "{side} knee"]
shank = ["knee", "{side} shank", "{side} ankle"]
foot = ["ankle", "{side} heel", "{side} toe"]
"""


def written(tmp_path, text: str):
    path = tmp_path / "ours.toml"
    path.write_text(text, encoding="utf-8")
    return path


def test_the_sets_that_come_along():
    assert list(read_marker_sets()) == ["gait2354", "helen_hayes", "oxford_foot", "plug_in_gait", "rajagopal"]
    for one in read_marker_sets().values():
        assert one.title
        assert one.citation


def test_a_laboratory_writes_its_own_in_twenty_lines(tmp_path):
    assert len([line for line in OWN.splitlines() if line and not line.startswith("[")]) <= 20
    own = {"SACR": "sacrum"}
    for side, word in (("L", "left"), ("R", "right")):
        ends = ("ASI", "THI", "KNE", "TIB", "ANK", "HEE", "TOE")
        names = ("spine", "thigh", "knee", "shank", "ankle", "heel", "toe")
        own |= {f"{side}{end}": f"{word} {name}" for end, name in zip(ends, names, strict=True)}
    known = known_angles(60)
    path = written(tmp_path, OWN)
    markers, static = renamed(markers_of(known, PLUG_IN_GAIT), own), renamed(static_of(PLUG_IN_GAIT), own)
    angles = move_body(markers, static, path, MEASURES, (1, 0, 0)).angles
    for name, values in known.items():
        assert abs(angles[name] - values).max() < 1e-9, name


def test_the_set_on_the_page_can_be_read(tmp_path):
    page = (Path(__file__).parents[2] / "docs" / "kinematics.md").read_text(encoding="utf-8")
    [text] = re.findall(r"```toml\n(.*?)```", page, re.DOTALL)
    assert read_marker_set(written(tmp_path, text)).followers("pelvis") == ("LASI", "RASI", "SACR")


def test_the_nearest_name_is_given():
    with pytest.raises(SchemaError, match="'plugin_gait', the nearest is 'plug_in_gait'"):
        marker_set("plugin_gait")


def test_a_file_that_is_not_there(tmp_path):
    with pytest.raises(ReadError, match=r"absent\.toml: No such file"):
        read_marker_set(tmp_path / "absent.toml")


@pytest.mark.parametrize(
    ("change", "words"),
    [
        (('hip = "harrington"', 'hip = "bell"'), "hip must be one of harrington, davis; ours.toml: found 'bell'"),
        (('hip = "harrington"', ""), r"hip, knee, ankle; ours\.toml has no hip"),
        (("[tracked]", "[trackd]"), "ours.toml: found 'trackd', the nearest is 'tracked'"),
        (('heel = "{side} heel"', ""), "asis,.* ours.toml has no heel"),
        (('heel = "{side} heel"', 'heal = "{side} heel"'), "found 'heal', the nearest is 'heel'"),
        (('heel = "{side} heel"', 'heel = "heel"'), r"both sides with \{S\}, .* found 'heel'. Write .* heel ="),
        (
            ('heel = "{side} heel"', 'heel = "{side} heel +"'),
            r"landmarks\.heel must name markers .* found '\{side\} heel \+'",
        ),
        (('heel = "{side} heel"', "heel = 3"), r"landmarks\.heel of a marker set"),
        (('knee = "chord"', 'knee = "midpoint"'), "'midpoint' must have landmarks.knee_medial; ours.toml has no such"),
        (('"{side} heel", ', ""), r"ours\.toml has 2: ankle,"),
        (('foot = ["ankle"', 'foot = ["knee"'), r"joint centre above it \(ankle\); ours\.toml names 'knee'"),
        (('foot = ["ankle",', 'foot = ["ankle" '), r"a marker set must be a TOML file; ours\.toml: "),
        (
            ("[joint_centres]", '[axes]\nfoot = "tilted"\n[joint_centres]'),
            "foot must be one of flat, as placed; .* found 'tilted'",
        ),
        (('shank = ["knee", "{side} shank", "{side} ankle"]', "shank = 5"), r"a list of names; ours\.toml: found 5"),
        (("[landmarks]", "aliases = 3\n[landmarks]"), r"a table; ours\.toml: found 3"),
    ],
)
def test_a_bad_set_gets_one_clear_error(tmp_path, change, words):
    assert change[0] in OWN
    with pytest.raises(SchemaError, match=words):
        read_marker_set(written(tmp_path, OWN.replace(*change)))


def test_recognition_prefers_the_set_with_more_of_the_markers():
    plain = marker_labels(static_of(PLUG_IN_GAIT))
    assert recognise_marker_set(plain, plain).name == "plug_in_gait"
    foot = [f"{side}{name}" for side in "LR" for name in ("HFB", "TUB", "SHN", "MMA", "P1M", "P5M", "LCA", "STL")]
    assert recognise_marker_set([*plain, *foot], [*plain, *foot]).name == "oxford_foot"


def test_labels_of_no_set_name_the_nearest_one():
    plain = [label for label in marker_labels(static_of(PLUG_IN_GAIT)) if label != "RTHI"]
    with pytest.raises(ChannelError, match=r"a\.c3d.*RASI.*plug_in_gait.*RTHI"):
        recognise_marker_set(plain, plain, "a.c3d")


def test_the_first_choice_that_is_there_is_the_landmark():
    chosen = marker_set("plug_in_gait")
    assert chosen.landmark("sacrum", "l", ["SACR", "LPSI", "RPSI"]) == ("SACR",)
    assert chosen.landmark("sacrum", "l", ["LPSI", "RPSI"]) == ("LPSI", "RPSI")
    assert chosen.landmark("sacrum", "l", ["LPSI"]) == ()


def test_a_medial_marker_on_one_side_only_is_not_enough_for_a_midpoint():
    chosen = marker_set("helen_hayes")
    assert "thigh_wand" in chosen.list_needed_landmarks(["RKNM"])
    assert "knee_medial" in chosen.list_needed_landmarks(["RKNM", "LKNM"])


def test_no_alias_means_two_markers_of_a_set():
    for one in read_marker_sets().values():
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
