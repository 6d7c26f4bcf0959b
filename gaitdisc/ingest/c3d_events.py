"""Events that a C3D file itself holds, brought onto the clock of its recordings."""

from __future__ import annotations

import re

import numpy as np

from gaitdisc.ingest.c3d_labels import named_people, without_people
from gaitdisc.ingest.c3d_parameters import C3DParameters
from gaitdisc.recording import Finding
from gaitdisc.recording.trial import Event

INITIAL_CONTACT, FOOT_OFF = "initial contact", "foot off"
_CONTACT = {"foot strike", "heel strike", "initial contact", "foot contact", "foot down", "strike", "hs", "ic", "fs"}
_OFF = {"foot off", "toe off", "to", "fo", "off"}


def event_kind(label: str, context: str) -> tuple[str, str]:
    """What an event is and on which side.

    label: `Foot Strike`, `Right Foot Off`, or the short dialect of Qualisys: `LHS`, `RTO`

    >>> event_kind("Foot Strike", "Left"), event_kind("RTO", ""), event_kind("Sync", "General")
    (('initial contact', 'l'), ('foot off', 'r'), ('Sync', ''))
    """
    side = {"l": "l", "r": "r"}.get(context.strip().lower()[:1], "")
    word = re.sub(r"[\s_.-]+", " ", label.strip().lower())
    found = re.fullmatch(r"(left|right|l|r) ?(.+)", word)
    if found and found[2] in _CONTACT | _OFF:
        side, word = side or found[1][0], found[2]
    if word in _CONTACT:
        return INITIAL_CONTACT, side
    if word in _OFF:
        return FOOT_OFF, side
    return label.strip(), side


def file_events(
    parameters: C3DParameters, frames: int, rate_hz: float, first_frame: int, file: str
) -> tuple[tuple[Event, ...], list[Finding]]:
    """Events of a file on the recordings' clock, on which the first frame is at 0 s.

    EVENT:TIMES are minutes and seconds on the clock of the trial before it was cropped, on which frame 1 is at 0 s and
    the first frame kept is TRIAL:ACTUAL_START_FIELD. Some software writes them on the clock of the cropped file
    instead: where all events lie outside of the file on the first clock and inside on the second, that one is taken.

    returns events: in order of time; those outside of the file are left out with a finding
    """
    times = parameters.numbers("EVENT", "TIMES")
    labels = parameters.texts("EVENT", "LABELS")
    count = parameters.count("EVENT", "USED")
    count = min(times.shape[1] if times.ndim == 2 and len(times) == 2 else 0, len(labels), count or 0)
    if not count:
        return (), []
    seconds = 60 * times[0, :count] + times[1, :count]
    lost = (first_frame - 1) / rate_hz
    end = (frames - 1) / rate_hz
    margin = 0.5 / rate_hz
    findings = []
    on_file = seconds - lost
    if not np.any(_within(on_file, end, margin)) and np.all(_within(seconds, end, margin)):
        on_file = seconds
        what = f"event times run on the clock of the cropped file, which begins with frame {first_frame}"
        findings.append(Finding("warning", "event clock", file, what, "the file's events if this is wrong"))
    inside = _within(on_file, end, margin)
    if not np.all(inside):
        what = f"{int(np.sum(~inside))} of {count} events lie outside of the {frames} frames kept and are left out"
        findings.append(Finding("note", "events outside", file, what, ""))
    contexts = (*parameters.texts("EVENT", "CONTEXTS"), *[""] * count)
    people = named_people(parameters)
    events = [
        Event(*event_kind(without_people(labels[place], people), contexts[place]), float(on_file[place]))
        for place in range(count)
        if inside[place]
    ]
    return tuple(sorted(events, key=lambda event: event.time)), findings


def _within(times: np.ndarray, end: float, margin: float) -> np.ndarray:
    return (times >= -margin) & (times <= end + margin)
