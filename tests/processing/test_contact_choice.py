from dataclasses import replace

import numpy as np
import pytest
from changed_trials import markers_at
from texts import says

from gaitdisc.channel import Channel
from gaitdisc.errors import ChannelError, StrideError
from gaitdisc.processing.contact_choice import choose_contacts, find_marker_names
from gaitdisc.recording import Event, Recording, Trial
from gaitdisc.signals.contact_movement import angle_contacts


def only(trial, *keys):
    return replace(trial, streams={key: trial.stream(key) for key in keys})


def test_force_goes_before_angles_and_both_are_compared(trial):
    choice = choose_contacts(trial)
    assert choice.detector == "force"
    compared = [f for f in choice.findings if f.kind == "detectors compared"]
    assert len(compared) == 2
    assert says(compared[0].what, "force", "36 pairs")


def test_the_detector_asked_for_is_taken(trial):
    assert choose_contacts(trial, "angles").detector == "angles"
    assert choose_contacts(only(trial, "kinematics")).detector == "angles"


def test_a_detector_that_cannot_work_and_nothing_to_find_contacts_in_are_refused(trial):
    with pytest.raises(StrideError, match="P01_nominal has kinematics"):
        choose_contacts(only(trial, "kinematics"), "markers")
    with pytest.raises(StrideError, match=r"P01_nominal.*emg"):
        choose_contacts(only(trial, "emg"))


def test_two_events_do_not_outvote_a_whole_walk(trial):
    events = tuple(
        Event("initial contact", side, time) for side, time in (("r", 1.1), ("l", 1.6), ("r", 2.2), ("l", 2.7))
    )
    choice = choose_contacts(replace(only(trial, "kinematics"), events=events))
    assert choice.detector == "angles"


def with_one_step(trial, late_s=0.06):
    """Angles, and a plate that sees one step of the right foot, later than the knee marks it by a known time."""
    by_angles = angle_contacts(trial.stream("kinematics"))["r"].time
    forces = trial.stream("forces")
    on = by_angles[9] + late_s
    pressed = (forces.time > on) & (forces.time < on + 0.6)
    plate = np.where(pressed, 700.0, 0.0)[:, None]
    plate = np.hstack([plate, 0 * plate])
    names = [channel for channel in forces.channels if channel.quantity == "vertical_force"]
    return replace(
        trial, streams={"kinematics": trial.stream("kinematics"), "forces": Recording(forces.time, plate, tuple(names))}
    ), by_angles


def test_one_step_on_a_plate_moves_all_contacts_by_the_offset_it_shows(trial):
    seen, by_angles = with_one_step(only(trial, "kinematics", "forces"))
    choice = choose_contacts(seen)
    assert choice.detector == "angles"
    later_s = choice.contacts["r"].time - by_angles
    assert later_s == pytest.approx(0.06, abs=0.002) and np.ptp(later_s) < 1e-9
    [said] = [f for f in choice.findings if f.kind == "contact offset"]
    assert says(said.what, "angles", "60 ms later")


def test_without_a_plate_the_known_bias_is_said_once(trial):
    choice = choose_contacts(only(trial, "kinematics"))
    by_angles = angle_contacts(trial.stream("kinematics"))["r"].time
    np.testing.assert_array_equal(choice.contacts["r"].time, by_angles)
    [said] = [f for f in choice.findings if f.kind == "contact offset"]
    assert says(said.what, "no", "38 ms", "(23", "61 ms", "14 trials")
    assert not [f for f in choose_contacts(trial).findings if f.kind == "contact offset"]  # force sees the ground


def test_contacts_that_lie_apart_or_are_missed_are_a_warning(trial):
    def against(times):
        events = tuple(Event("initial contact", side, float(time)) for side, time in times)
        findings = choose_contacts(replace(only(trial, "kinematics"), events=events)).findings
        return next(f for f in findings if f.kind == "detectors compared" and "side r" in f.what)

    found = angle_contacts(trial.stream("kinematics"))
    left, right = [("l", time) for time in found["l"].time], found["r"].time
    alike = against([*left, *(("r", time) for time in right)])
    assert (alike.severity, alike.spoils) == ("note", "")
    moved = right.copy()
    moved[12] += 0.08
    assert says(against([*left, *(("r", time) for time in moved)]).spoils, "1 contact (over 50 ms", "median")
    missed = against([*left, *(("r", time) for time in np.delete(right, 12))])
    assert missed.severity == "warning"
    assert says(missed.spoils, f"{right[12]:.2f} s", "detector finds a", "not")
    late = against([*(("l", time) for _, time in left), *(("r", time + 0.15) for time in right)])
    assert says(late.spoils, "50 ms more")


def markers(*names):
    return markers_at(np.arange(10) / 100, {name: np.zeros((10, 3)) for name in names})


def test_markers_by_the_names_of_the_laboratories():
    assert find_marker_names(markers("RHEE", "LHEE", "LASI", "RASI")) == ({"r": "RHEE", "l": "LHEE"}, ["LASI", "RASI"])
    with pytest.raises(ChannelError, match=r"RightHeel = \"RHEE\""):
        find_marker_names(markers("LHEE", "LASI"))


def test_a_walk_that_stands_still():
    still = Recording(np.arange(500) / 100, np.zeros((500, 1)), (Channel("hip_flexion_r", "angle", "deg", "r"),))
    with pytest.raises(StrideError):
        choose_contacts(Trial("still", {"kinematics": still}))
