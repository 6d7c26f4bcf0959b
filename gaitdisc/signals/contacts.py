"""Initial contacts of one foot, from the events of a file or from the force; what two detectors make of a walk."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field

import numpy as np
from numpy.typing import NDArray

from gaitdisc.channel import other_side
from gaitdisc.errors import ChannelError, StrideError
from gaitdisc.recording import Finding, Recording, Trial
from gaitdisc.recording.arrays import Span, Values, finite_values, freeze, runs
from gaitdisc.signals.direction import Direction, marker_position, pelvis_position
from gaitdisc.words import counted

DETECTORS = ("force", "markers", "angles", "events", "oscillator")
MATCH_S = 0.25
CONTACT, OFF = "initial contact", "foot off"
RISE_N = 50.0
RISE_OF_BODY_WEIGHT = 0.1  # of whoever weighs less than 51 kg
LEAST_RISE_N = 20.0  # a plate's own noise and drift stay below it
REST_N = 20.0  # below which a foot that was on the ground has left it
CLEAR_OF_PELVIS_M = 0.1  # half a foot: at contact one heel is some 0.3 m in front of the pelvis, the other behind it
SHORTEST_S = 0.1  # neither stance nor swing is shorter; what is, is chatter


@dataclass(frozen=True, eq=False)
class Contacts:
    """Initial contacts of one foot.

    Parameters
    ----------
    time : ndarray (contact,) [s]
        Initial contacts on the trial's clock, increasing.
    side : str
        `r` or `l`.
    detector : str
        `force`, `markers`, `angles`, `events` or `oscillator`.
    foot_off : ndarray (foot off,) [s]
        Times of foot off if the detector finds them, otherwise empty.
    note : str
        Inferred settings, and the meaning of the times.

    Raises
    ------
    StrideError
        If the times do not increase, or the side or detector is unknown.

    Examples
    --------
    >>> len(Contacts(np.array([0.1, 1.2]), "r", "force"))
    2
    """

    time: Values
    side: str
    detector: str
    foot_off: Values = field(default_factory=lambda: np.empty(0))
    note: str = ""

    def __post_init__(self) -> None:
        freeze(self, "time", "foot_off")
        time = self.time
        if self.side not in ("r", "l") or self.detector not in DETECTORS:
            raise StrideError(
                "contacts must have side 'r' or 'l' and a known detector",
                f"the side is {self.side!r}, the detector {self.detector!r}",
                f"Give a side, and one of the detectors {', '.join(DETECTORS)}.",
            )
        if time.ndim != 1 or np.any(np.diff(time) <= 0) or not np.isfinite(time).all():
            raise StrideError(
                "the times of initial contacts must increase",
                f"side {self.side!r}, detector {self.detector}: shape {time.shape}; times are missing or out of order",
                "Sort the events of the file, or choose another detector.",
            )

    def __len__(self) -> int:
        return len(self.time)

    def __repr__(self) -> str:
        span = f", {self.time[0]:.2f} to {self.time[-1]:.2f} s" if len(self) else ""
        return f"Contacts({len(self)} of side {self.side!r} by {self.detector}{span})"

    def compared(self, other: Contacts, within_s: float = MATCH_S) -> Agreement:
        """Match these contacts with the nearest ones of another detector.

        Parameters
        ----------
        other : Contacts
            Contacts of the same foot in the same walk.
        within_s : float
            Largest difference within a pair [s].

        Returns
        -------
        Agreement
            `difference_s` [s]: other minus these, for each pair; `missed` and `extra` [s]: unpaired contacts of these
            and of the other. Contacts more than `within_s` before the first or after the last of the other detector are
            ignored, because a plate records only two steps of a walk.

        Raises
        ------
        StrideError
            If the contacts belong to different feet.

        Examples
        --------
        >>> a = Contacts(np.array([1.0, 2.0, 3.0]), "r", "force")
        >>> b = Contacts(np.array([1.02, 3.02]), "r", "markers")
        >>> a.compared(b).line()
        '2 pairs, second minus first +20 ms (median), 0 ms (interquartile range); 1 missed, 0 extra'
        """
        if self.side != other.side:
            raise StrideError(
                "contacts can be compared for one foot only",
                f"these are {self.detector} of side {self.side!r} and {other.detector} of side {other.side!r}",
                "Compare right with right and left with left.",
            )
        if not len(self) or not len(other):
            return Agreement(np.empty(0), np.empty(0), np.empty(0))
        apart = other.time[None, :] - self.time[:, None]
        nearest = np.abs(apart).argmin(axis=1)
        back = np.abs(apart).argmin(axis=0)
        rows = np.flatnonzero((back[nearest] == np.arange(len(self))) & (np.abs(apart).min(axis=1) <= within_s))
        columns = nearest[rows]
        missed = _select_covered(np.delete(self.time, rows), other, within_s)
        extra = _select_covered(np.delete(other.time, columns), self, within_s)
        return Agreement(apart[rows, columns], missed, extra)


@dataclass(frozen=True, eq=False)
class Agreement:
    """Two detectors on the same walk."""

    difference_s: Values  # (pair,) [s], second minus first, of each matched pair
    missed: Values  # [s], contacts of the first that the second does not see, within the span of both
    extra: Values  # [s], contacts of the second that the first does not see, within the span of both

    @property
    def median_ms(self) -> float:
        """Median difference [ms]; NaN without pairs."""
        return float(1e3 * np.median(self.difference_s)) if len(self.difference_s) else float("nan")

    @property
    def iqr_ms(self) -> float:
        """Interquartile range of the differences [ms]; NaN without pairs."""
        apart = self.difference_s
        return float(1e3 * np.subtract(*np.percentile(apart, [75, 25]))) if len(apart) else float("nan")

    def line(self) -> str:
        """Return the comparison as one line of text."""
        return (
            f"{counted(len(self.difference_s), 'pair')}, second minus first {self.median_ms:+.0f} ms (median), "
            f"{self.iqr_ms:.0f} ms (interquartile range); {len(self.missed)} missed, {len(self.extra)} extra"
        )


def order_findings(right: Contacts, left: Contacts, file: str = "") -> list[Finding]:
    """Find where right and left contacts do not alternate.

    returns: one warning for each side, with the spans between two contacts of one foot that have none of the other
        between them: a missed contact, or a foot that stepped on the other belt

    >>> r = Contacts(np.array([0.0, 1.0, 2.0, 3.0]), "r", "force")
    >>> print(order_findings(r, Contacts(np.array([0.5, 2.5]), "l", "force"))[0].what)
    strides of side r without exactly one contact of side l: 1 of 3 (at 1.00 s)
    """
    findings = []
    for contacts, other in ((right, left), (left, right)):
        wrong = []
        for start, end in zip(contacts.time, contacts.time[1:], strict=False):
            if not len(other) or end < other.time[0] or start > other.time[-1]:
                continue
            if np.sum((other.time > start) & (other.time < end)) != 1:
                wrong.append(Span(float(start), float(end)))
        if wrong:
            at = ", ".join(f"{start:.2f}" for start, _ in wrong[:5]) + (" ..." if len(wrong) > 5 else "")
            what = f"strides of side {contacts.side} without exactly one contact of side {other.side}: "
            what += f"{len(wrong)} of {len(contacts) - 1} (at {at} s)"
            spoils = "these strides: a contact was missed, or a foot stepped on the other plate or belt"
            findings.append(Finding("warning", "crossover", file, what, spoils, spans=tuple(wrong)))
    return findings


def _select_covered(times: Values, other: Contacts, within_s: float) -> Values:
    return times[(times >= other.time[0] - within_s) & (times <= other.time[-1] + within_s)]


def event_contacts(trial: Trial) -> dict[str, Contacts]:
    """Contacts of both feet from the events of a trial.

    >>> from gaitdisc.recording import Event
    >>> event_contacts(Trial("w", {}, (Event("initial contact", "r", 1.0),)))["r"].time
    array([1.])
    """
    contacts = [event for event in trial.events if event.label == CONTACT]
    if not any(event.side in ("r", "l") for event in contacts):
        fault = f"{counted(len(contacts), 'contact')} of no side" if contacts else f"none in {len(trial.events)} events"
        raise StrideError(
            "events must name the foot of each initial contact",
            f"{trial.name} has {fault}",
            "Label the contacts in the motion capture software, or choose another detector in [strides].",
        )
    by_side = {}
    for side in ("r", "l"):
        times = np.unique([event.time for event in contacts if event.side == side])
        offs = np.unique([event.time for event in trial.events if event.label == OFF and event.side == side])
        lost = sum(event.side == "" for event in contacts)
        if len(times):
            note = "events of the file" + (f"; excluded: {counted(lost, 'contact')} without a side" if lost else "")
            by_side[side] = Contacts(times, side, "events", offs, note)
    return by_side


def find_rise(body_weight_n: float | None) -> float:
    """Force above which a foot is on the ground [N]: 50 N, or a tenth of a light body's weight, at least 20 N.

    >>> find_rise(None), find_rise(64 * 9.81), round(find_rise(30 * 9.81), 2), find_rise(15 * 9.81)
    (50.0, 50.0, 29.43, 20.0)
    """
    if body_weight_n is None:
        return RISE_N
    return min(max(RISE_OF_BODY_WEIGHT * body_weight_n, LEAST_RISE_N), RISE_N)


def loaded(force_n: Values, rate_hz: float, rise_n: float = RISE_N) -> NDArray[np.intp]:
    """First and last sample of each loading of a plate or belt.

    A loading begins above `rise_n` and ends below 20 N. What is loaded for less than 0.1 s is chatter and
    counts as unloaded; what is then unloaded for less than 0.1 s counts as loaded.

    force_n (time,) [N]: positive upwards on the foot; NaN counts as unloaded
    returns (loading, 2) [sample]: first sample above `rise_n`, and the one after the last above 20 N

    >>> f = np.r_[np.zeros(30), 40, 0, np.full(60, 700.0), np.zeros(30)]
    >>> loaded(f, 100.0).tolist()
    [[32, 92]]
    """
    on, high = force_n > min(REST_N, rise_n), force_n > rise_n
    spans = [(start + int(np.argmax(high[start:end])), end) for start, end in runs(on) if high[start:end].any()]
    shortest = SHORTEST_S * rate_hz
    last = len(force_n)
    loadings = [(a, b) for a, b in spans if b - a >= shortest or a == 0 or b == last]
    joined: list[tuple[int, int]] = []
    for start, end in loadings:
        if joined and start - joined[-1][1] < shortest:
            joined[-1] = (joined[-1][0], end)
        else:
            joined.append((start, end))
    return np.array(joined, dtype=np.intp).reshape(-1, 2)


def force_contacts(forces: Recording, body_weight_n: float | None = None) -> dict[str, Contacts]:
    """Contacts of both feet from one vertical force a foot: a split belt, or force assigned to a foot.

    Contact is where the force rises above 50 N, or less under a light body (`find_rise`), to a fraction
    of a sample, after the foot has been off (`loaded`). A loading that the recording begins with gives no contact.

    forces: channels of quantity `vertical_force` [N] that name their foot
    returns: for each side with a channel, with foot off
    """
    sides = {c.name: c.side for c in forces.channels if c.quantity == "vertical_force" and c.side}
    if not sides:
        raise ChannelError(
            "for contacts from force, each foot must have a channel of vertical force",
            f"{forces.source.file or 'the recording'} names no foot for {', '.join(forces.names) or 'any channel'}",
            "Name the foot of each plate or belt in [channels], or add markers, which identify the foot.",
        )
    contacts = {}
    for side in sorted(set(sides.values())):
        plates = [_contacts(forces, name, body_weight_n) for name, owner in sides.items() if owner == side]
        on, off, notes = zip(*plates, strict=True)
        times, offs = np.sort(np.concatenate(on)), np.sort(np.concatenate(off))
        contacts[side] = Contacts(times, side, "force", offs, "; ".join(notes))
    return contacts


def plate_contacts(
    forces: Recording,
    markers: Recording,
    heels: Mapping[str, str],
    direction: Direction,
    body_weight_n: float | None = None,
    pelvis: Sequence[str] = (),
) -> dict[str, Contacts]:
    """Contacts from plates that either foot may hit: the foot that lands is the one whose heel is in front.

    forces: channels of quantity `vertical_force` [N], one a plate
    pelvis: markers that one heel alone is clearly in front of, or behind, where the other is missing
    returns: both sides; empty where no plate was hit by that foot
    """
    times: dict[str, list[float]] = {"r": [], "l": []}
    offs: dict[str, list[float]] = {"r": [], "l": []}
    places = {side: marker_position(markers, name) for side, name in heels.items()}
    middle = np.mean(list(places.values()), axis=0)
    middle = np.where(np.isnan(middle), pelvis_position(markers, pelvis), middle) if pelvis else middle
    along = {side: direction.ahead(place - middle) for side, place in places.items()}
    for channel in forces.channels:
        if channel.quantity != "vertical_force":
            continue
        on, off, _ = _contacts(forces, channel.name, body_weight_n)
        for time in on:
            place = {side: float(np.interp(time, markers.time, heel)) for side, heel in along.items()}
            for side, ahead in place.items():
                across = place.get(other_side(side), 0.0)
                if np.isnan(ahead) and abs(across) > CLEAR_OF_PELVIS_M:
                    place[side] = -across
            if not np.isfinite(list(place.values())).all() or len(place) < 2:
                raise StrideError(
                    "both heel markers must be visible at contact to identify the foot on a plate",
                    f"{forces.source.file}, {channel.name}: a heel marker is missing at the contact at {time:.3f} s",
                    "Fill the gap in the marker, or choose another detector in [strides].",
                )
            side = max(place, key=lambda key: place[key])
            times[side].append(float(time))
            offs[side] += [float(t) for t in off[off > time][:1]]
    note = f"foot identified by the leading heel; {direction.how}"
    return {s: Contacts(np.unique(times[s]), s, "force", np.unique(offs[s]), note) for s in ("r", "l")}


def _contacts(forces: Recording, name: str, body_weight_n: float | None) -> tuple[Values, Values, str]:
    force, time = forces[name], forces.time
    known = finite_values(force)
    downwards = len(known) > 0 and -known.min() > known.max()
    upward = -force if downwards else force
    rise = find_rise(body_weight_n)
    spans = loaded(upward, forces.rate_hz, rise)
    on = []
    for start in spans[spans[:, 0] > 0, 0]:
        before = upward[start - 1] if np.isfinite(upward[start - 1]) else 0.0
        share = np.clip((rise - before) / (upward[start] - before), 0.0, 1.0)  # where the force passes `rise`
        on.append(time[start - 1] + share * (time[start] - time[start - 1]))
    off = time[spans[spans[:, 1] < len(time), 1] - 1]
    sign = ", negative when loaded: read as the force on the plate" if downwards else ""
    return np.array(on, float), off, f"{name} above {rise:.0f} N{sign}"
