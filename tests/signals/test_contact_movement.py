"""Contacts and foot off from paths that are known, from real files against their own events, and late changes."""

import numpy as np
import pytest
from changed_trials import markers_at, with_column
from texts import says

from gaitdisc.channel import Channel
from gaitdisc.errors import StrideError
from gaitdisc.ingest.reading import read_trial
from gaitdisc.recording import Recording
from gaitdisc.signals.contact_movement import (
    angle_contacts,
    angle_foot_off,
    marker_contacts,
    marker_foot_off,
    stance_windows,
)
from gaitdisc.signals.contacts import event_contacts
from gaitdisc.signals.direction import state_direction, walking_direction
from gaitdisc.signals.stride_quality import late_change, late_change_findings
from gaitdisc.signals.strides import cut_strides

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
    return markers_at(t, {"RHEE": heel, "SACR": pelvis})


@pytest.mark.parametrize(("speed", "noise", "within_s"), [(0.0, 0.0, 0.006), (1.3, 0.0, 0.006), (0.0, 0.003, 0.03)])
def test_contacts_are_where_the_heel_is_farthest_in_front_and_noise_makes_none(speed, noise, within_s):
    found = marker_contacts(walker(speed, noise), {"r": "RHEE"}, ["SACR"], state_direction((1, 0, 0)))["r"]
    assert len(found) == len(CONTACTS)
    assert np.abs(found.time - CONTACTS).max() < within_s
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


def test_a_gap_at_contact_gives_none():
    walk = with_column(walker(), "RHEE.x", np.nan, slice(290, 305))
    found = marker_contacts(walk, {"r": "RHEE"}, ["SACR"], state_direction((1, 0, 0)))["r"]
    assert len(found) == len(CONTACTS) - 1


def test_a_heel_that_does_not_swing_is_refused():
    walk = walker()
    with pytest.raises(StrideError, match=r"RHEE.*0\.1 m.*0\.000 m"):
        marker_contacts(walk, {"r": "RHEE"}, ["SACR"], state_direction((0, 1, 0)))


OFFS = np.array([0.62, 1.637, 2.65])
TIME = np.arange(330) / 100


def _dips(at, depth=0.4):
    """Deepest at each time, smooth between."""
    return -depth * np.exp(-(((TIME[:, None] - at) / 0.12) ** 2)).sum(axis=1)


def _toe(speed=1.2):
    toe = np.column_stack([speed * TIME + _dips(OFFS), 0 * TIME, 0 * TIME])
    pelvis = np.column_stack([speed * TIME, 0 * TIME, 0 * TIME + 0.9])
    return markers_at(TIME, {"RTOE": toe, "SACR": pelvis})


def test_a_window_lies_in_the_stance_after_each_contact_and_before_the_first():
    assert np.array(stance_windows(np.array([0.0, 2.0]), 2.0)) == pytest.approx(
        np.array([(-1.5, -0.3), (0.5, 1.7), (2.5, 3.7)])
    )
    assert stance_windows(np.empty(0), 1.0) == []


def test_the_toe_leaves_where_it_is_farthest_behind():
    windows = stance_windows(np.array([1.0, 2.0]), 1.0)
    found = marker_foot_off(_toe(), "RTOE", ["SACR"], state_direction((1, 0, 0)), windows)
    assert np.abs(found - OFFS).max() < 0.002  # between the samples, which are 0.01 s apart


def test_walking_the_other_way_has_no_such_time():
    windows = stance_windows(np.array([1.0, 2.0]), 1.0)
    found = marker_foot_off(_toe(), "RTOE", ["SACR"], state_direction((-1, 0, 0)), windows)
    assert not any(np.abs(found - at).min() < 0.05 for at in OFFS) if len(found) else True


def test_a_gap_in_the_window_gives_none():
    toe = with_column(with_column(_toe(), "RTOE", np.nan, slice(140, 200)), "SACR", np.nan, slice(140, 200))
    windows = stance_windows(np.array([1.0, 2.0]), 1.0)
    found = marker_foot_off(toe, "RTOE", ["SACR"], state_direction((1, 0, 0)), windows)
    assert found == pytest.approx(OFFS[[0, 2]], abs=0.002)


def test_the_ankle_is_most_plantarflexed_about_then():
    ankle = Recording(TIME, _dips(OFFS, 20.0)[:, None], (Channel("ankle_angle_r", "angle", "deg", "r"),))
    found = angle_foot_off(ankle, "ankle_angle_r", stance_windows(np.array([1.0, 2.0]), 1.0))
    assert found == pytest.approx(OFFS, abs=0.005)


@pytest.mark.parametrize("dependence", [0.0, 0.3, 0.6])
def test_a_shift_in_the_last_fifth_is_found_in_four_minutes(made, dependence):
    for seed in range(4):
        recording, strides = made.wandering(224, dependence, seed, shift_sd=1.75)
        found = late_change(recording, strides, seed)
        assert found.p <= 0.01
        assert found.time == pytest.approx(0.8 * 224, abs=6)
        assert found.size_sd > 2
        assert found.shifts["hip_flexion_r"] == pytest.approx(1.75, abs=0.9)


@pytest.mark.slow
def test_stationary_strides_raise_an_alarm_in_at_most_1_in_20(made):
    cases = [(dependence, 5000 + seed) for seed, dependence in enumerate((0.0, 0.3, 0.6) * 33)]
    p = np.array([late_change(*made.wandering(100, dependence, seed), seed).p for dependence, seed in cases])
    assert np.mean(p <= 0.05) <= 0.05
    assert np.mean(p <= 0.01) <= 0.02


def test_an_angle_that_no_stride_has_at_some_phase_is_left_out_in_silence(made, recwarn):
    recording, strides = made.wandering(40, 0.3, 1)
    name, phi = recording.names[0], strides.phi(recording.time)
    found = late_change(with_column(recording, name, np.nan, (phi > 40) & (phi < 60)), strides, 1)
    assert name not in found.shifts and len(found.shifts) > 0
    assert [str(one.message) for one in recwarn] == []


@pytest.mark.slow
def test_false_alarms_stay_below_5_percent(made):
    for count in (40, 80, 224):
        for dependence in (0.0, 0.3, 0.6):
            p = [late_change(*made.wandering(count, dependence, 1000 + seed), seed).p for seed in range(150)]
            assert np.mean(np.array(p) <= 0.05) <= 0.05 + 1.6 * np.sqrt(0.05 * 0.95 / 150)


def test_the_finding_says_when_how_much_and_where(made):
    (finding,) = late_change_findings(*made.wandering(224, 0.3, 1, shift_sd=2.0))
    assert finding.kind == "late change"
    assert finding.what.startswith("gait changes at 1")
    assert "stride-to-stride SD (p = 0.003)" in finding.what
    assert finding.spans[0][0] == pytest.approx(179, abs=6)
    assert says(finding.spoils, "the trial")


def test_one_odd_stride_late_is_no_change(made):
    recording, strides = made.wandering(100, 0.0, 3)
    values = recording.values.copy()
    values[(recording.time >= 90) & (recording.time < 91)] += 40
    assert late_change(recording.with_values(values), strides).p > 0.05


def test_too_few_strides_are_refused_and_noted(made):
    recording, strides = made.wandering(20, 0.0, 0)
    with pytest.raises(StrideError, match=r"24 complete strides.*walk\.mot.*19.*'r'"):
        late_change(recording, strides)
    (finding,) = late_change_findings(recording, strides)
    assert finding.severity == "note" and says(finding.what, "not tested", "walk.mot", "19 of side 'r'")


def test_same_seed_same_p(made):
    recording, strides = made.wandering(60, 0.3, 0)
    assert late_change(recording, strides, 7) == late_change(recording, strides, 7)


def test_a_constant_channel_does_not_count(made):
    recording, strides = made.wandering(60, 0.3, 0)
    assert "ankle_angle_r" not in late_change(with_column(recording, "ankle_angle_r", 1.0), strides).shifts


@pytest.mark.parametrize("file", ["natural2", "exotendon3"])
def test_real_running_does_not_change_late(gait_data, real, file):
    run = real.mot(gait_data / "exotendon_run" / f"c3d_Trimmed_running_{file}_manual_scaling_ik.mot")
    strides = cut_strides(angle_contacts(run)["r"], run)
    assert late_change_findings(run.selected(real.legs), strides) == []
