"""Initial contact as the file itself says."""

from __future__ import annotations

import numpy as np

from gaitdisc.errors import StrideError
from gaitdisc.recording import Trial
from gaitdisc.signals.contacts import Contacts

CONTACT, OFF = "initial contact", "foot off"


def event_contacts(trial: Trial) -> dict[str, Contacts]:
    """Contacts of both feet from the events of a trial.

    >>> from gaitdisc.recording import Event
    >>> event_contacts(Trial("w", {}, (Event("initial contact", "r", 1.0),)))["r"].time
    array([1.])
    """
    contacts = [event for event in trial.events if event.label == CONTACT]
    if not any(event.side in ("r", "l") for event in contacts):
        seen = f"{len(contacts)} of them, without a side" if contacts else f"none among {len(trial.events)} events"
        raise StrideError(
            "strides from events need initial contacts with their foot",
            f"{trial.name} has {seen}",
            "Label them in the motion capture software, or choose another detector in [strides].",
        )
    found = {}
    for side in ("r", "l"):
        times = np.unique([event.time for event in contacts if event.side == side])
        offs = np.unique([event.time for event in trial.events if event.label == OFF and event.side == side])
        lost = sum(event.side == "" for event in contacts)
        if len(times):
            note = "events of the file" + (f"; {lost} contacts without a side left out" if lost else "")
            found[side] = Contacts(times, side, "events", offs, note)
    return found
