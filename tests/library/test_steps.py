"""Contacts and cycles of a trial."""

import numpy as np
import pandas as pd
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
    with pytest.raises(StrideError, match=r"'right'.*contacts were found"):
        gd.cycles(walk, "right")


def test_contacts_that_are_known_are_used_as_they_are_given(walk):
    table = pd.DataFrame({"time": np.arange(0.0, 10.0, 0.01), "knee": 0.0})
    at = np.arange(0.5, 9.0)
    strides = gd.cycles(table, contacts=at)  # nothing has to be found in it, so that its names are its own
    np.testing.assert_array_equal(strides.start, at[:-1])
    assert (strides.side, strides.detector) == ("r", "events")
    found = gd.contacts(walk)
    for given in (found, found["l"]):
        np.testing.assert_array_equal(gd.cycles(walk, "l", contacts=given).start, gd.cycles(walk, "l").start)


def test_contacts_in_frames_and_unknown_detectors_are_refused(walk):
    with pytest.raises(StrideError, match=r"1000 s.*W01_nominal"):
        gd.cycles(walk, contacts=[100, 1000])
    for detector in ("heel", np.array([0.5, 1.5])):
        with pytest.raises(StrideError, match=r"auto, force, events, markers, angles.*contacts=times"):
            gd.contacts(walk, detector)
