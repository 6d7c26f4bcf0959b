from __future__ import annotations

import numpy as np
import pytest
from texts import says

from gaitdisc.channel import Channel
from gaitdisc.errors import StrideError
from gaitdisc.ingest.reading import read_trial
from gaitdisc.recording import Recording
from gaitdisc.signals.contact_movement import marker_contacts
from gaitdisc.signals.contacts import event_contacts
from gaitdisc.signals.direction import given_direction, walking_direction

CONTACTS = np.array([0.731, 1.802, 2.93, 4.01, 5.12, 6.2])


def walker(speed=0.0, noise=0.0):
    """One heel that is farthest in front of the pelvis at each contact, whose stance is longer than its swing."""
    t = np.arange(700) / 100
    ends = np.r_[CONTACTS[0] - 1.1, CONTACTS, CONTACTS[-1] + 1.1]
    phase = np.interp(t, ends, np.arange(-1, len(CONTACTS) + 1))
    # slower on the way back: a phase that lingers in stance, zero slope of it at contact
    ahead = 0.3 * np.cos(2 * np.pi * phase - 0.4 * (1 - np.cos(2 * np.pi * phase)))
    rng = np.random.default_rng(0)
    heel = np.stack([speed * t + ahead + noise * rng.normal(size=len(t)), 0 * t, 0 * t + 0.05], axis=1)
    pelvis = np.stack([speed * t, 0 * t, 0 * t + 0.95], axis=1)
    channels = tuple(Channel(f"{n}.{a}", "marker", "m") for n in ("RHEE", "SACR") for a in "xyz")
    return Recording(t, np.hstack([heel, pelvis]), channels)


@pytest.mark.parametrize("speed", [0.0, 1.3])
def test_contacts_are_where_the_heel_is_farthest_in_front(speed):
    found = marker_contacts(walker(speed), {"r": "RHEE"}, ["SACR"], given_direction((1, 0, 0)))["r"]
    assert len(found) == len(CONTACTS)
    assert np.abs(found.time - CONTACTS).max() < 0.006
    assert says(found.note, "RHEE", "SACR")


@pytest.mark.parametrize("turn_deg", [90.0, -180.0])
def test_a_turn_loses_no_contact_and_moves_none(turn_deg):
    """The heel a hand's breadth beside the pelvis, as feet are: a direction that turns must not move its peak."""
    straight = walker()
    t = straight.time
    angle = np.radians(turn_deg) * np.clip((t - 3.0) / 1.5, 0, 1)
    forward, across = np.stack([np.cos(angle), np.sin(angle)]), np.stack([np.sin(angle), -np.cos(angle)])
    path = np.cumsum(1.3 / 100 * forward, axis=1)
    values = straight.values.copy()
    values[:, :2] = (path + straight["RHEE.x"] * forward + 0.1 * across).T
    values[:, 3:5] = path.T
    walk = straight.with_values(values)
    found = marker_contacts(walk, {"r": "RHEE"}, ["SACR"], walking_direction(walk, {"r": "RHEE"}, ["SACR"]))["r"]
    assert len(found) == len(CONTACTS)
    assert np.abs(found.time - CONTACTS).max() < 0.02


def test_real_turns_against_the_events_of_their_files(gait_data):
    """Five turns of 86 to 96 deg: one direction a trial made a stride of 1.5 s where the file has 0.9 and 1.0."""
    apart = []
    for file in sorted((gait_data / "young_straight_and_turn").glob("*/turn/*.c3d")):
        trial = read_trial(file)
        if not trial.events:
            continue
        found = marker_contacts(trial.stream("markers"), {"r": "RHEE", "l": "LHEE"}, ["LASI", "RASI"])
        for side, contacts in event_contacts(trial).items():
            agreement = contacts.compared(found[side])
            inside = (agreement.missed > found[side].time[0]) & (agreement.missed < found[side].time[-1])
            assert not inside.any(), file.name
            assert not len(agreement.extra), file.name
            apart += list(1e3 * agreement.difference_s)
    assert len(apart) >= 30
    assert -35 < np.median(apart) < -20
    assert np.percentile(np.abs(apart), 95) < 50


def test_noise_makes_no_contacts():
    found = marker_contacts(walker(noise=0.003), {"r": "RHEE"}, ["SACR"], given_direction((1, 0, 0)))["r"]
    assert len(found) == len(CONTACTS)
    assert np.abs(found.time - CONTACTS).max() < 0.03


def test_a_gap_at_contact_gives_none():
    walk = walker()
    values = walk.values.copy()
    values[290:305, 0] = np.nan
    found = marker_contacts(walk.with_values(values), {"r": "RHEE"}, ["SACR"], given_direction((1, 0, 0)))["r"]
    assert len(found) == len(CONTACTS) - 1


def test_a_heel_that_does_not_swing_is_refused():
    walk = walker()
    with pytest.raises(StrideError, match=r"RHEE.*0\.1 m.*0\.000 m"):
        marker_contacts(walk, {"r": "RHEE"}, ["SACR"], given_direction((0, 1, 0)))
