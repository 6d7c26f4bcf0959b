"""What may be given where a walk is wanted."""

import numpy as np
import pandas as pd
import pytest

import gaitdisc as gd
from gaitdisc.errors import ReadError


@pytest.fixture(scope="module")
def walks():
    return gd.example_walks(12.0)


def test_a_table_of_angles_is_a_walk_like_its_file(walks):
    angles = walks["nominal"].stream("kinematics")
    table = angles.to_pandas()
    of_table, of_recording = gd.contacts(table, "angles"), gd.contacts(angles, "angles")
    expected = gd.contacts(gd.Trial("walk", {"kinematics": angles}), "angles")
    for side in "lr":
        np.testing.assert_allclose(of_table[side].time, expected[side].time, atol=1e-9)
        np.testing.assert_array_equal(of_recording[side].time, expected[side].time)
    assert len(gd.cycles(table.reset_index(), "r")) == len(gd.cycles(angles, "r"))


def test_two_tables_are_compared_as_their_trials(walks):
    first, second = (walks[word].stream("kinematics") for word in ("exo", "nominal"))
    found = gd.compare(first.to_pandas(), second, ["ankle_angle_r"])
    expected = gd.compare(*(gd.Trial("walk", {"kinematics": one}) for one in (first, second)), ["ankle_angle_r"])
    np.testing.assert_allclose(found.to_frame()["gap"], expected.to_frame()["gap"], atol=1e-6)


def test_a_table_and_a_recording_are_checked(walks):
    angles = walks["nominal"].stream("kinematics")
    assert gd.check(angles).strides == gd.check(angles.to_pandas()).strides != {}
    jumped = angles.to_pandas()
    jumped.iloc[300:380, 0] = np.nan
    assert gd.check(jumped).light == "amber"


def test_streams_come_from_the_channels_and_marks_stay(walks):
    both = walks["nominal"].on_one_base(100.0, ("kinematics", "emg"))
    assert gd.check(both).streams.keys() == {"kinematics", "emg"}
    assert "the recording" in gd.check(both).name


def test_what_is_no_walk_is_refused():
    with pytest.raises(ReadError, match=r"read from files.*DataFrames"):
        gd.contacts(np.zeros((10, 2)))
    with pytest.raises(ReadError, match=r"table needs times \[s\]"):
        gd.read(pd.DataFrame({"knee_angle_r": [1.0, 2.0]}))
