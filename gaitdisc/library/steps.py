"""Initial contacts and cycles of a trial."""

from __future__ import annotations

from collections.abc import Mapping
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import ArrayLike

from gaitdisc.errors import StrideError
from gaitdisc.library.walks import Walk, make_recording, make_trial
from gaitdisc.processing.contact_choice import choose_contacts, find_contacts
from gaitdisc.recording import Recording, Strides, Trial
from gaitdisc.signals.contacts import Contacts
from gaitdisc.signals.strides import cut_strides

if TYPE_CHECKING:
    import pandas as pd


def contacts(trial: Walk, detector: str = "auto") -> dict[str, Contacts]:
    """Find the initial contacts of both feet.

    `auto` uses ground force, the file's events, heel markers or joint angles, in this order, but skips a detector that
    finds fewer than 80 % of the strides that another one finds.

    Parameters
    ----------
    trial : Trial, path, DataFrame or Recording
        A walk: a trial from `read`, its files, or a recording.
    detector : str
        Detector of initial contact: `auto`, `force`, `events`, `markers` or `angles`.

    Returns
    -------
    dict of str to Contacts
        Contacts of each side, `r` and `l`; `time` contains their times [s] on the trial's clock.

    Raises
    ------
    StrideError
        If no detector finds a stride; the message gives each reason.

    Examples
    --------
    >>> import gaitdisc as gd
    >>> walk = gd.example_walks(10.0)["nominal"]
    >>> {side: one.detector for side, one in sorted(gd.contacts(walk).items())}
    {'l': 'force', 'r': 'force'}
    """
    return dict(choose_contacts(make_trial(trial), detector).contacts)


def contacts_by_detector(trial: Walk) -> dict[str, dict[str, Contacts]]:
    """Find the initial contacts by each detector, for comparison.

    Parameters
    ----------
    trial : Trial, path, DataFrame or Recording
        A walk: a trial from `read`, its files, or a recording.

    Returns
    -------
    dict of str to dict of str to Contacts
        Contacts by detector (`force`, `events`, `markers`, `angles`), then by side, without detectors that lack data.
        Unlike in `contacts`, times from markers and angles are not shifted to those of a plate.

    Examples
    --------
    >>> import gaitdisc as gd
    >>> found = gd.contacts_by_detector(gd.example_walks(10.0)["nominal"])
    >>> found["force"]["r"].compared(found["angles"]["r"]).median_ms < 0  # angles see a contact early
    True
    """
    return find_contacts(make_trial(trial))[0]


def cycles(
    trial: Walk,
    side: str = "r",
    detector: str = "auto",
    recording: Recording | pd.DataFrame | None = None,
    min_s: float = 0.4,
    max_s: float = 2.5,
    contacts: ArrayLike | Contacts | Mapping[str, Contacts] | None = None,
) -> Strides:
    """Cut the gait cycles of one foot, from each initial contact to the next.

    Parameters
    ----------
    trial : Trial, path, DataFrame or Recording
        A walk: a trial from `read`, its files, or a recording.
    side : str
        The foot whose contacts begin the cycles, `r` or `l`.
    detector : str
        Detector of initial contact: `auto`, `force`, `events`, `markers` or `angles`.
    recording : Recording or DataFrame, optional
        Recording that will be cut; cycles with a gap that cannot be filled are excluded.
    min_s, max_s : float
        Shortest and longest cycle [s].
    contacts : array_like (contact,), Contacts, or the dict of `gaitdisc.contacts`, optional
        Known initial contacts of that foot [s], on the walk's clock; they replace the detector.

    Returns
    -------
    Strides
        `normalised(recording)` returns every cycle on 0 to 100 % in 101 points; `dropped` lists the excluded cycles
        with reasons.

    Raises
    ------
    StrideError
        If no contact of that side is found, or no cycle remains.

    Examples
    --------
    >>> import gaitdisc as gd
    >>> walk = gd.example_walks(10.0)["nominal"]
    >>> strides = gd.cycles(walk, "r")
    >>> strides.normalised(walk.stream("kinematics")).shape[1]
    101
    """
    by_side = (
        choose_contacts(make_trial(trial), detector).contacts
        if contacts is None
        else _pick_given(contacts, side, trial)
    )
    if side not in by_side:
        raise StrideError(
            f"for cycles of side {side!r}, there must be initial contacts of this side",
            f"contacts were found for side {', '.join(sorted(by_side)) or 'none'}",
            "Use the other side ('r' or 'l'), or another detector.",
        )
    return cut_strides(by_side[side], None if recording is None else make_recording(recording), min_s, max_s)


def _pick_given(contacts: Any, side: str, trial: Walk) -> dict[str, Contacts]:
    """Contacts by side, as they were given."""
    if isinstance(contacts, Mapping):
        return dict(contacts)
    if isinstance(contacts, Contacts):
        return {contacts.side: contacts}
    time = np.asarray(contacts, float)
    plain = hasattr(trial, "columns")  # a table in which nothing has to be found may have any names
    walk = Trial("the table", {"signals": make_recording(trial)}) if plain else make_trial(trial)  # type: ignore[arg-type]
    latest = max((recording.time[-1] for recording in walk.streams.values()), default=np.inf)
    if time.size and np.nanmax(time) > latest:
        raise StrideError(
            "initial contacts must be times on the walk's clock [s]",
            f"one contact is at {np.nanmax(time):g} s, but {walk.name} ends at {latest:g} s",
            "Divide frame numbers by the rate, or milliseconds by 1000.",
        )
    return {side: Contacts(time, side, "events")}
