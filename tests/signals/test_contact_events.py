from __future__ import annotations

import numpy as np
import pytest
from texts import says

from gaitdisc.errors import StrideError
from gaitdisc.recording import Event, Trial
from gaitdisc.signals.contacts import event_contacts, plate_contacts
from gaitdisc.signals.direction import walking_direction


def trial(*events):
    return Trial("HC030A05", {}, tuple(Event(*event) for event in events))


def test_events_become_contacts_with_foot_off():
    found = event_contacts(
        trial(("initial contact", "r", 2.0), ("foot off", "r", 1.6), ("initial contact", "r", 1.0), ("start", "", 0.0))
    )
    assert found["r"].time.tolist() == [1.0, 2.0]
    assert found["r"].foot_off.tolist() == [1.6]
    assert "l" not in found


def test_contacts_without_a_foot_are_counted():
    found = event_contacts(trial(("initial contact", "r", 2.0), ("initial contact", "", 3.0)))
    assert says(found["r"].note, "1 contacts", "left")


@pytest.mark.parametrize(
    ("events", "words"),
    [((), "HC030A05 has none among 0 events"), ((("initial contact", "", 1.0),), "has 1 of them, without a side")],
)
def test_a_file_without_contacts_is_refused(events, words):
    with pytest.raises(StrideError, match=words):
        event_contacts(trial(*events))


def test_real_events_agree_with_plates_within_20_ms(gait_data, real):
    ezc3d = pytest.importorskip("ezc3d")
    apart = []
    for path in sorted((gait_data / "young_straight_and_turn").glob("*/straight/*.c3d")):
        c3d = ezc3d.c3d(str(path))
        event = c3d["parameters"]["EVENT"]
        words = {"Foot Strike": "initial contact", "Foot Off": "foot off"}
        rows = zip(event["CONTEXTS"]["value"], event["LABELS"]["value"], event["TIMES"]["value"].T, strict=True)
        events = [Event(words[label], context[0].lower(), 60 * t[0] + t[1]) for context, label, t in rows]
        heels, pelvis = {"r": "RHEE", "l": "LHEE"}, ("RASI", "LASI", "SACR")
        markers = real.markers(c3d, (*heels.values(), *pelvis))
        direction = walking_direction(markers, heels, [n for n in pelvis if f"{n}.x" in markers.names])
        seen = event_contacts(Trial(path.stem, {}, tuple(sorted(events, key=lambda e: e.time))))
        plates = plate_contacts(real.plates(c3d), markers, heels, direction)
        for side in "rl":
            found = seen[side].compared(plates[side])
            assert len(found.extra) == 0
            apart += found.difference_s.tolist()
    assert len(apart) >= 12
    assert 0 < np.median(apart) < 0.015  # a plate needs some ms to 50 N
    assert np.abs(apart).max() < 0.02
