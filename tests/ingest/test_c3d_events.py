from __future__ import annotations

import numpy as np
import pytest
from texts import says

from gaitdisc.ingest.c3d_labels import event_kind, file_events
from gaitdisc.ingest.c3d_parameters import C3DParameters


def _events(times, labels, contexts=(), first_frame=1, used=None):
    values = {
        ("EVENT", "TIMES"): np.array(times, float).T.reshape(2, -1),
        ("EVENT", "LABELS"): tuple(labels),
        ("EVENT", "USED"): np.array([len(labels) if used is None else used]),
    }
    if contexts:
        values["EVENT", "CONTEXTS"] = tuple(contexts)
    return file_events(C3DParameters(values), 200, 100.0, first_frame, "a.c3d")


@pytest.mark.parametrize(
    ("label", "context", "kind"),
    [
        ("Foot Strike", "Right", ("initial contact", "r")),
        ("Foot Off", "Left", ("foot off", "l")),
        ("LHS", "", ("initial contact", "l")),
        ("RTO", "", ("foot off", "r")),
        ("Right Foot Strike", "", ("initial contact", "r")),
        ("Event", "General", ("Event", "")),
    ],
)
def test_kinds(label, context, kind):
    assert event_kind(label, context) == kind


def test_times_are_minutes_and_seconds_before_cropping():
    events, findings = _events([(1, 1.5), (1, 0.2)], ["Foot Strike", "Foot Off"], ["Left", "Right"], first_frame=6001)
    assert [(event.label, event.side) for event in events] == [("foot off", "r"), ("initial contact", "l")]
    assert [event.time for event in events] == pytest.approx([0.2, 1.5])
    assert not findings


def test_the_dialect_without_contexts():
    events, _ = _events([(0, 0.1), (0, 0.3)], ["LHS", "RTO"])
    assert [(event.label, event.side) for event in events] == [("initial contact", "l"), ("foot off", "r")]


def test_events_outside_of_the_file_are_left_out_and_reported():
    events, findings = _events([(0, 1.0), (0, 9.0)], ["LHS", "LHS"])
    assert len(events) == 1
    assert says(findings[0].what, "1 of 2 events", "200 frames")


def test_the_clock_of_the_cropped_file_is_recognised_and_reported():
    events, findings = _events([(0, 0.5), (0, 1.5)], ["LHS", "LTO"], first_frame=301)
    assert [event.time for event in events] == pytest.approx([0.5, 1.5])
    assert "which begins with frame 301" in findings[0].what


def test_a_group_without_events():
    assert _events(np.empty((0, 2)), []) == ((), [])
    assert file_events(C3DParameters({}), 200, 100.0, 1, "a.c3d") == ((), [])
    assert _events([(0, 1.0)], ["LHS"], used=0) == ((), [])


def test_contacts_of_a_real_trial_are_where_the_plates_are_loaded(gait_data, reader):
    trial = reader.read(gait_data / "young_straight_and_turn/HC002D/straight/HC002D06.c3d")
    assert len(trial.events) == 12
    forces = trial.stream("forces")
    contacts = np.array([event.time for event in trial.events if event.label == "initial contact"])
    for plate in (1, 2):
        first = forces.time[np.argmax(forces[f"plate_{plate}_fz"] > 20)]
        assert np.min(np.abs(contacts - first)) < 0.02
