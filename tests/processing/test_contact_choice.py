from dataclasses import replace

import numpy as np
import pytest

from gaitdisc.channel import Channel
from gaitdisc.errors import ChannelError, StrideError
from gaitdisc.processing.contact_choice import chosen_contacts, named_markers
from gaitdisc.recording import Event, Recording, Trial


def only(trial, *keys):
    return replace(trial, streams={key: trial.stream(key) for key in keys})


def test_force_goes_before_angles_and_both_are_compared(trial):
    choice = chosen_contacts(trial)
    assert choice.detector == "force"
    compared = [f for f in choice.findings if f.kind == "detectors compared"]
    assert len(compared) == 2
    assert compared[0].what.startswith("angles against force, side l: 36 pairs")


def test_the_detector_asked_for_is_taken(trial):
    assert chosen_contacts(trial, "angles").detector == "angles"
    assert chosen_contacts(only(trial, "kinematics")).detector == "angles"


def test_a_detector_that_cannot_work_says_why(trial):
    with pytest.raises(StrideError, match="P01_nominal has kinematics"):
        chosen_contacts(only(trial, "kinematics"), "markers")


def test_two_events_do_not_outvote_a_whole_walk(trial):
    events = tuple(
        Event("initial contact", side, time) for side, time in (("r", 1.1), ("l", 1.6), ("r", 2.2), ("l", 2.7))
    )
    choice = chosen_contacts(replace(only(trial, "kinematics"), events=events))
    assert choice.detector == "angles"


def test_nothing_to_find_contacts_in(trial):
    with pytest.raises(StrideError, match=r"needs? initial contacts.*P01_nominal has emg.*Add the file"):
        chosen_contacts(only(trial, "emg"))


def markers(*names):
    channels = tuple(Channel(f"{name}.{axis}", "marker", "m") for name in names for axis in "xyz")
    return Recording(np.arange(10) / 100, np.zeros((10, len(channels))), channels)


def test_markers_by_the_names_of_the_laboratories():
    assert named_markers(markers("RHEE", "LHEE", "LASI", "RASI")) == ({"r": "RHEE", "l": "LHEE"}, ["LASI", "RASI"])
    with pytest.raises(ChannelError, match=r"RightHeel = \"RHEE\""):
        named_markers(markers("LHEE", "LASI"))


def test_a_walk_that_stands_still():
    still = Recording(np.arange(500) / 100, np.zeros((500, 1)), (Channel("hip_flexion_r", "angle", "deg", "r"),))
    with pytest.raises(StrideError):
        chosen_contacts(Trial("still", {"kinematics": still}))
