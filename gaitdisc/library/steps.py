"""Initial contacts and cycles of a trial."""

from __future__ import annotations

from typing import TYPE_CHECKING

from gaitdisc.errors import StrideError
from gaitdisc.library.walks import Walk, trial_of
from gaitdisc.processing.contact_choice import chosen_contacts, seen_contacts
from gaitdisc.recording import Recording, Strides
from gaitdisc.signals.strides import cut_strides

if TYPE_CHECKING:
    from gaitdisc.signals.contacts import Contacts


def contacts(trial: Walk, detector: str = "auto") -> dict[str, Contacts]:
    """Initial contacts of both feet.

    `auto` takes ground force before the file's own events before heel markers before joint angles, but none that sees
    fewer than 80 % of the strides that another sees.

    Parameters
    ----------
    trial : Trial, path, DataFrame or Recording
        A walk: what `read` gave or takes, or a recording.
    detector : str
        `auto`, `force`, `events`, `markers` or `angles`.

    Returns
    -------
    dict of str to Contacts
        By side, `r` and `l`; `time` holds the contacts [s], on the trial's clock.

    Raises
    ------
    StrideError
        If the detector, or every detector, finds no stride; each one's reason is named.

    Examples
    --------
    >>> import gaitdisc as gd
    >>> walk = gd.example_walks(10.0)["nominal"]
    >>> {side: one.detector for side, one in sorted(gd.contacts(walk).items())}
    {'l': 'force', 'r': 'force'}
    """
    return dict(chosen_contacts(trial_of(trial), detector).contacts)


def contacts_by_detector(trial: Walk) -> dict[str, dict[str, Contacts]]:
    """Initial contacts as each detector itself places them, to set one beside the other.

    Parameters
    ----------
    trial : Trial, path, DataFrame or Recording
        A walk: what `read` gave or takes, or a recording.

    Returns
    -------
    dict of str to dict of str to Contacts
        Detector (`force`, `events`, `markers`, `angles`), then side; without those that the walk does not serve. Unlike
        those of `contacts`, times by markers and angles are not moved to those of a plate.

    Examples
    --------
    >>> import gaitdisc as gd
    >>> found = gd.contacts_by_detector(gd.example_walks(10.0)["nominal"])
    >>> found["force"]["r"].compared(found["angles"]["r"]).median_ms < 0  # angles see a contact early
    True
    """
    return seen_contacts(trial_of(trial))[0]


def cycles(
    trial: Walk,
    side: str = "r",
    detector: str = "auto",
    recording: Recording | None = None,
    min_s: float = 0.4,
    max_s: float = 2.5,
) -> Strides:
    """Gait cycles of one foot, from each initial contact to the next.

    Parameters
    ----------
    trial : Trial, path, DataFrame or Recording
        A walk: what `read` gave or takes, or a recording.
    side : str
        The foot whose contacts begin the cycles, `r` or `l`.
    detector : str
        `auto`, `force`, `events`, `markers` or `angles`.
    recording : Recording, optional
        What will be cut: cycles in which it has a gap that cannot be filled are dropped.
    min_s, max_s : float
        Shortest and longest cycle [s].

    Returns
    -------
    Strides
        `normalised(recording)` gives every cycle on 0 to 100 % in 101 points; `dropped` says which cycles are not used
        and why.

    Raises
    ------
    StrideError
        If no contact of that side is found, or no cycle is left.

    Examples
    --------
    >>> import gaitdisc as gd
    >>> walk = gd.example_walks(10.0)["nominal"]
    >>> strides = gd.cycles(walk, "r")
    >>> strides.normalised(walk.stream("kinematics")).shape[1]
    101
    """
    found = contacts(trial, detector)
    if side not in found:
        raise StrideError(
            f"cycles of side {side!r} begin at its initial contacts",
            f"contacts were found of side {', '.join(sorted(found)) or 'none'}",
            "Take the other side ('r' or 'l'), or another detector.",
        )
    return cut_strides(found[side], recording, min_s, max_s)
