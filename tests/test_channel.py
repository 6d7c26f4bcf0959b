import csv

import pytest

from gaitdisc.channel import Channel, find_side, nearest_word, schema_folder, vocabulary
from gaitdisc.errors import ChannelError, UnitError


@pytest.mark.parametrize(
    ("label", "name"),
    [
        ("hip_flexion_r", "hip_flexion_r"),
        ("/jointset/ground_pelvis/pelvis_tilt/value", "pelvis_tilt"),
        ("R Tib Ant", "emg_ta_r"),
        ("1_ground_force_vy", "ground_force_l_vy"),
        ("Sol_l", "emg_sol_l"),
        ("RKneeAngles.x", "knee_angle_r"),
    ],
)
def test_labels_of_the_field(label, name):
    channel = vocabulary().named(label)
    assert channel is not None
    assert channel.name == name


def test_a_speed_is_not_taken_for_its_coordinate():
    assert vocabulary().named("/jointset/hip_r/hip_flexion_r/speed") is None


def test_every_channel_says_what_positive_means_and_its_side():
    for channel in vocabulary().channels:
        assert vocabulary().positive[channel.name]
        for side in "rl":
            if channel.name.endswith(f"_{side}"):
                assert channel.side == side


def test_both_sides_are_there():
    names = {c.name for c in vocabulary().channels if c.side == "r"}
    mirrored = {c.name for c in vocabulary().channels if c.side == "l"}
    assert len(names) == len(mirrored)


def test_nearest():
    assert nearest_word("ankle_ang_r", ("knee_angle_r", "ankle_angle_r")) == "ankle_angle_r"
    assert nearest_word("ankle_ange_r", vocabulary().by_name) == "ankle_angle_r"
    assert nearest_word("zzz", ["filters"]) is None


def test_words_outside_the_vocabulary_are_refused():
    with pytest.raises(ChannelError, match=r"'angel'. Use one of: angle,"):
        Channel("knee", "angel", "deg")
    with pytest.raises(ChannelError, match="found 'right'"):
        Channel("knee", "angle", "deg", "right")
    with pytest.raises(UnitError, match="found 'grad'"):
        Channel("knee", "angle", "grad")
    with pytest.raises(ChannelError, match="one name is empty"):
        Channel("", "angle", "deg")


def test_a_rate_is_a_unit():
    assert Channel("knee", "angle", "deg/s2").unit == "deg/s2"


def test_the_file_has_no_doubled_names():
    with (schema_folder() / "channels.csv").open(encoding="utf-8") as file:
        names = [row["name"] for row in csv.DictReader(file)]
    assert len(names) == len(set(names))


def test_sides():
    assert [find_side(n) for n in ("a_r", "A_L", "a_r.x", "a_r/speed", "relative", "floor")] == [*"rlrr", "", ""]
