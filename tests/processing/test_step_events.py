"""Events of short trials: what sees them, and how far markers are from the files' own."""

from dataclasses import replace

import numpy as np
import pytest
from changed_trials import with_labels_exchanged, with_stream

from gaitdisc.channel import Channel
from gaitdisc.errors import StrideError
from gaitdisc.ingest.c3d import C3DReader
from gaitdisc.ingest.reading import read_trial
from gaitdisc.processing.step_events import StepEvents, over_ground, step_events, walking_part
from gaitdisc.recording import Recording, Trial

NOTHING = {"r": np.empty(0), "l": np.empty(0)}


@pytest.fixture(scope="module")
def walks(gait_data_of_module):
    files = sorted(gait_data_of_module.glob("young_straight_and_turn/*/[st][tu]r*/*.c3d"))
    with C3DReader() as reader:
        return {file.stem: read_trial(file, reader=reader) for file in files}


@pytest.fixture(scope="module")
def gait_data_of_module(request):
    return request.getfixturevalue("gait_data")


def _apart_ms(kind, walks):
    """Events without the file's own, corrected by the plates, minus the file's own [ms]."""
    apart, label = [], {"contacts": "initial contact", "foot_offs": "foot off"}[kind]
    for walk in walks.values():
        steps = step_events(replace(walk, events=()))
        later = steps.later_s(kind)
        for side, times in steps.corrected(kind, float(np.median(later)) if len(later) else 0.0).items():
            own = np.array([event.time for event in walk.events if (event.label, event.side) == (label, side)])
            apart += [1e3 * min(at - own, key=abs) for at, _ in times if len(own) and np.abs(own - at).min() < 0.2]
    return np.array(apart)


def test_every_walk_of_one_stride_or_more_has_its_events(walks):
    seen = {name: step_events(walk) for name, walk in walks.items()}
    assert len(seen) == 12
    assert {name: one.detector for name, one in seen.items() if one.detector != "events"} == {"HC036A23": "markers"}
    assert all(max(len(times) for times in steps.contacts.values()) >= 2 for steps in seen.values())
    assert all(over_ground(walk) for walk in walks.values())


def test_contacts_and_foot_offs_lie_near_the_files_own_events(walks):
    contacts, offs = _apart_ms("contacts", walks), _apart_ms("foot_offs", walks)
    assert len(contacts) >= 55 and len(offs) >= 60
    assert abs(np.median(contacts)) <= 20 and np.percentile(np.abs(contacts), 95) <= 50
    assert abs(np.median(offs)) <= 10 and np.percentile(np.abs(offs), 95) <= 40


def test_a_foot_off_of_a_plate_that_the_toe_does_not_bear_out_is_not_taken(walks):
    """The left foot of this turn steps off the edge of a plate at 2.14 s, a third of its stride, and stands on."""
    offs = step_events(walks["HC032A18"]).corrected("foot_offs", 0.0)["l"]
    assert not any(abs(at - 2.138) < 0.05 for at, _ in offs)
    assert any(abs(at - 2.43) < 0.04 for at, _ in offs)


def test_markers_are_moved_and_the_ground_s_own_contact_is_kept():
    steps = StepEvents(
        "markers", "", {"r": np.array([1.0, 2.0]), "l": np.array([1.5])}, NOTHING, {"r": ((1.05, "force"),)}, {}
    )
    assert steps.later_s("contacts") == pytest.approx([0.05])
    assert steps.corrected("contacts", 0.05) == {
        "r": ((1.05, "force"), (pytest.approx(2.05), "markers")),
        "l": ((pytest.approx(1.55), "markers"),),
    }


def test_a_plate_s_contact_between_two_steps_of_the_markers_is_false():
    steps = StepEvents("markers", "", {"r": np.array([1.0, 2.0])}, NOTHING, {"r": ((1.5, "force"),)}, {})
    assert [at for at, _ in steps.corrected("contacts", 0.0)["r"]] == [1.0, 2.0]


def test_what_lies_too_far_apart_is_no_bias():
    steps = StepEvents("markers", "", {"r": np.array([1.0])}, NOTHING, {"r": ((1.3, "force"),)}, {})
    assert len(steps.later_s("contacts")) == 0


def test_angles_alone_serve_and_a_trial_without_anything_says_what_it_has(trial):
    angles = step_events(Trial("a", {"kinematics": trial.stream("kinematics")}))
    assert (angles.detector, angles.off_detector) == ("angles", "angles")
    assert len(angles.contacts["r"]) >= 30
    with pytest.raises(StrideError, match=r"two initial contacts.*emg"):
        step_events(Trial("b", {"emg": trial.stream("emg")}))
    with pytest.raises(StrideError, match="from markers"):
        step_events(trial, "markers")


def _moved(walk, late_s):
    return replace(walk, events=tuple(replace(event, time=event.time + late_s) for event in walk.events))


@pytest.mark.parametrize("late_s", [0.1, -0.1, 0.06])
def test_events_that_lie_apart_from_the_plates_are_moved_onto_them_and_said(walks, late_s):
    for name in ("HC002D06", "HC030A05", "HC030A22", "HC031A06"):
        right, wrong = step_events(walks[name]), step_events(_moved(walks[name], late_s))
        assert right.findings == ()
        (finding,) = wrong.findings
        assert (finding.severity, finding.kind, finding.file) == ("warning", "events and plates", walks[name].name)
        assert "the plates are used" in finding.what
        assert float(finding.what.split(" ms ")[0].split()[-1]) == pytest.approx(1e3 * abs(late_s), abs=15)
        apart = wrong.contacts["r"] - right.contacts["r"]
        assert np.abs(apart).max() <= 0.015 and wrong.detector == "events"


def test_plates_whose_clock_is_off_are_not_believed_where_markers_speak_for_the_events(walks):
    walk = walks["HC030A05"]
    forces = walk.stream("forces")
    off = with_stream(walk, "forces", replace(forces, time=forces.time + 0.12))
    steps = step_events(off)
    (finding,) = steps.findings
    assert "the events are used" in finding.what and "check the plates' clock" in finding.spoils
    np.testing.assert_array_equal(steps.contacts["r"], step_events(walk).contacts["r"])


@pytest.mark.parametrize("name", ["HC002D25", "HC030A05", "HC030A22", "HC031A06"])
def test_heels_that_are_exchanged_for_half_a_second_do_not_outvote_the_events(walks, name):
    walk = walks[name]
    first = max(2, int(np.nanargmax(walk.stream("kinematics")["knee_angle_r"])) - 25)
    steps = step_events(with_labels_exchanged(walk, ("RHEE", "LHEE"), slice(first, first + 50)))
    assert steps.detector == "events"
    assert {finding.kind for finding in steps.findings} == {"exchanged heels"}
    assert "lands at" in steps.findings[0].what and step_events(walk).findings == ()


def test_a_long_walk_that_does_not_show_its_path_is_one_on_a_treadmill(trial):
    assert not over_ground(trial)
    assert over_ground(Trial("short", {"kinematics": trial.stream("kinematics").between(0.0, 3.0)}))
    for speed in (0.05, 1.2):  # of the pelvis, for 5 s; no heel is seen
        t = np.arange(500) / 100
        there = Recording(t, np.outer(t, [speed, 0, 0]), tuple(Channel(f"RASI.{a}", "marker", "m") for a in "xyz"))
        assert over_ground(Trial("run", {"markers": there})) == (speed > 1)


def _standing_about(walk, before_s, after_s):
    """Walk with somebody who stands, and sways by some mm, before and after it; events stay where they are."""
    rng, streams = np.random.default_rng(0), {}
    for key, one in walk.streams.items():
        parts = [
            one.values[[row]] + rng.normal(0, 2e-4, (round(seconds * one.rate_hz), len(one.names)))
            for row, seconds in ((0, before_s), (-1, after_s))
        ]
        time = one.time[0] - before_s + np.arange(len(one.time) + sum(map(len, parts))) / one.rate_hz
        streams[key] = Recording(time, np.vstack([parts[0], one.values, parts[1]]), one.channels, source=one.source)
    return replace(walk, streams=streams)


@pytest.mark.parametrize(("before_s", "after_s"), [(15.0, 0.0), (0.0, 40.0), (8.0, 8.0), (1.5, 0.0), (0.0, 1.5)])
@pytest.mark.parametrize("only", [("markers", "forces"), ("kinematics", "forces")])
def test_standing_before_and_after_a_walk_is_cut_out_and_said(walks, before_s, after_s, only):
    for name in ("HC030A22", "HC031A06"):
        walk = walks[name]
        walk = replace(walk, streams={key: walk.streams[key] for key in only}, events=())
        part = walking_part(_standing_about(walk, before_s, after_s))
        (said,) = [finding for finding in part.findings if finding.kind == "standing"]
        assert (said.severity, said.file) == ("note", walk.name) and said.what.startswith("no walking from ")
        for recording in part.streams.values():
            assert recording.time[0] >= -0.6 and recording.time[-1] <= walk.streams[only[0]].time[-1] + 0.6
        assert over_ground(part)
        assert walking_part(walk) is walk


def test_a_walker_whom_the_cameras_do_not_see_yet_neither_stands_nor_is_on_a_treadmill(walks):
    walk = replace(walks["HC030A22"], streams={"markers": walks["HC030A22"].stream("markers")}, events=())
    longer = _standing_about(walk, 4.0, 4.0)
    markers = longer.stream("markers")
    unseen = (markers.time < walk.stream("markers").time[0]) | (markers.time > walk.stream("markers").time[-1])
    values = np.where(unseen[:, None], np.nan, markers.values)
    hidden = Recording(markers.time, values, markers.channels, source=markers.source)
    assert walking_part(longer) is not longer
    longer = replace(longer, streams={"markers": hidden})
    assert walking_part(longer) is longer
    assert over_ground(longer)


def test_nothing_is_cut_where_nobody_steps_or_all_do(walks, trial):
    still = _standing_about(
        replace(walks["HC030A05"], streams={"markers": walks["HC030A05"].stream("markers")}), 0.0, 9.0
    )
    still = replace(still, streams={"markers": still.stream("markers").between(3.0, 10.0)})
    assert walking_part(still) is still
    assert walking_part(trial) is trial
