"""Contacts and cycles of a trial."""

import numpy as np
import pytest

import gaitdisc as gd
from gaitdisc.errors import StrideError


@pytest.fixture(scope="module")
def walk():
    return gd.example_walks(10.0)["nominal"]


def test_contacts_and_cycles_of_a_walk_and_of_its_file(walk, tmp_path):
    found = gd.contacts(walk)
    assert {one.detector for one in found.values()} == {"force"}
    strides = gd.cycles(walk, "l")
    np.testing.assert_allclose(strides.start, found["l"].time[:-1])
    files = gd.example_files(tmp_path, 10.0)["nominal"]
    again = gd.cycles(files[0], "l", detector="angles")
    assert again.detector == "angles" and abs(len(again) - len(strides)) <= 1


def test_every_detector_places_its_own_contacts(walk):
    found = gd.contacts_by_detector(walk)
    assert set(found) == {"force", "angles"}
    apart = found["force"]["l"].compared(found["angles"]["l"])
    assert len(apart.difference_s) >= 7 and apart.median_ms < -10  # by angles they lie early, and stay where they are
    np.testing.assert_array_equal(gd.contacts(walk)["l"].time, found["force"]["l"].time)


def test_a_cycle_with_a_gap_in_what_is_cut_is_dropped(walk):
    kinematics, strides = walk.stream("kinematics"), gd.cycles(walk)
    values = np.array(kinematics.values)
    inside = (kinematics.time > strides.start[1]) & (kinematics.time < strides.start[1] + 0.5)
    values[inside] = np.nan
    cut = gd.cycles(walk, recording=kinematics.with_values(values))
    assert len(cut) == len(strides) - 1 and cut.dropped[0].start == strides.start[1]


def test_a_side_without_contacts_is_refused(walk):
    with pytest.raises(StrideError, match=r"cycles of side 'right'.*contacts were found of side l, r"):
        gd.cycles(walk, "right")
