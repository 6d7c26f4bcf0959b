"""Which detector's initial contacts are used, and what the others say of the same walk."""

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, replace
from functools import partial

import numpy as np

from gaitdisc.errors import ChannelError, GaitdiscError, StrideError
from gaitdisc.recording import Finding, Recording, Trial
from gaitdisc.signals.contact_movement import angle_contacts, marker_contacts
from gaitdisc.signals.contacts import MATCH_S, Contacts, event_contacts, force_contacts, plate_contacts
from gaitdisc.signals.direction import Direction, state_direction, walking_direction

HEELS = {
    "r": ("RHEE", "R.Heel", "RHEEL", "R_Heel", "RCAL", "RCALC", "r_calc"),
    "l": ("LHEE", "L.Heel", "LHEEL", "L_Heel", "LCAL", "LCALC", "L_calc"),
}
PELVIS = ("LASI", "RASI", "LPSI", "RPSI", "SACR", "L.ASIS", "R.ASIS", "r.ASIS", "L.PSIS", "R.PSIS", "r.PSIS")
PELVIS += ("LASIS", "RASIS")
PREFERRED = ("force", "events", "markers", "angles")
ENOUGH = 0.8  # of the strides that the most prolific detector sees
DISAGREEMENT_MS = 50.0  # a twentieth of a stride
EVENTS_MS = 30.0  # three frames of 100 Hz; events of 27 walks, ten laboratories, lie within 22 ms of plates (median)
OTHER_FOOT_S = 0.1  # markers are early by 21 to 74 ms, and steps are 0.4 s apart or more
SAME_STEP_S = 0.4  # less than half a stride: events that were marked this late still belong to the plate's step
SEEN_LATE = ("markers", "angles")  # detectors that see no ground, so that their contacts need a plate to be right
MOST_OFFSET_S = 0.15  # twice the largest bias seen: what lies farther off is no bias of a detector but another event
EARLY_MS = {"markers": 50.0, "angles": 38.0}  # median against plates in 20 and 14 trials of walking, studies/results
EARLY_RANGE = {"markers": "21 to 74 ms in 20 trials", "angles": "23 to 61 ms in 14 trials"}
AXES = {"x": (1.0, 0.0, 0.0), "y": (0.0, 1.0, 0.0), "z": (0.0, 0.0, 1.0)}


@dataclass(frozen=True)
class ContactChoice:
    """Initial contacts of both feet, and what was seen on the way."""

    contacts: Mapping[str, Contacts]  # those from markers and angles moved by what a plate or an event shows
    # which detector was taken and why, how far others differ [ms], and those that could not be used
    findings: tuple[Finding, ...]

    @property
    def detector(self) -> str:
        """Name of the detector that was taken."""
        return next(iter(self.contacts.values())).detector


def choose_contacts(
    trial: Trial, detector: str = "auto", direction: str = "", body_weight_n: float | None = None
) -> ContactChoice:
    """Initial contacts by the detector requested, or by the best one that the trial allows.

    `auto` takes force before the file's events before markers before joint angles, but none that sees fewer than 80 %
    of the strides that another sees: a plate in the floor catches one step of many. That one step corrects the others:
    contacts from markers and from angles are moved by the median of what the plate, or else the file's events, say.
    The file's events stand where a detector that sees more contradicts them; plates move them by more than 30 ms.

    direction: direction of walking in the laboratory's axes, `+x` to `-z`; inferred from the markers where it is empty
    body_weight_n: mass x 9.81, by which a plate counts as loaded; 50 N without it
    """
    if not isinstance(detector, str) or detector not in ("auto", *PREFERRED):
        raise StrideError(
            f"the detector of contacts must be one of auto, {', '.join(PREFERRED)}",
            f"the detector is {str(detector)[:60]!r}",
            "Use one of these detectors. To use known contacts, call cycles(..., contacts=times).",
        )
    needed = "initial contacts must come from force, events, markers or joint angles"
    if any(len(recording.time) < 2 for recording in trial.streams.values()):
        raise nothing_found(trial, needed, ["a single frame"])
    seen, refused = find_contacts(trial, direction, body_weight_n)
    seen, late = events_on_plates(seen, trial.name)
    strides = {name: count for name, contacts in seen.items() if (count := _stride_count(contacts))}
    why = refused if detector == "auto" else {detector: refused.get(detector)}
    if not strides or (detector != "auto" and detector not in strides):
        reasons = [f"{name}: {error.found if error else 'no stride of both feet'}" for name, error in why.items()]
        raise why.get(detector) or nothing_found(trial, needed, reasons, refused.get("markers"))
    chosen = detector if detector != "auto" else best_detector(PREFERRED, strides, seen)
    reference, offset_s = _offset(chosen, seen)
    taken = seen[chosen] if offset_s is None else _move(seen[chosen], offset_s)
    findings = [*late, *_findings(trial, chosen, seen, refused, reference)]
    if chosen in SEEN_LATE:
        by = f"the median difference at steps {'recorded by a plate' if reference == 'force' else 'marked by an event'}"
        spoils = "phase, by 3 to 5 % of the stride compared with a plate; durations are unaffected"
        findings.append(offset_finding(trial.name, chosen, offset_s, by, spoils))
    return ContactChoice(taken, tuple(findings))


def best_detector(order: Sequence[str], strides: Mapping[str, int], seen: Mapping[str, Mapping[str, Contacts]]) -> str:
    """First detector in an order that sees 80 % of the most strides; the events where all that see more deny them."""
    most = max(strides.values())
    richer = [name for name in strides if ENOUGH * strides[name] > strides.get("events", most)]
    stand = bool(richer)
    for name in richer:  # which miss a contact that the file marks, or see one between them
        events, other = seen["events"], seen[name]
        pairs = [events[side].compared(other[side], MOST_OFFSET_S) for side in events if side in other]
        differ = any(len(pair.missed) + len(pair.extra) for pair in pairs) or find_exchanged_contacts(events, other)
        stand = stand and bool(differ)
    return next(
        name for name in order if name in strides and (strides[name] >= ENOUGH * most or (name == "events" and stand))
    )


def find_exchanged_contacts(events: Mapping[str, Contacts], other: Mapping[str, Contacts]) -> dict[str, list[float]]:
    """Contacts of a foot [s] that lie where the file marks the other foot, and none of this one; sides with any."""
    exchanged = {}
    for side, marks in other.items():
        same, across = (events[foot].time if foot in events else np.empty(0) for foot in (side, "rl".replace(side, "")))
        near = {
            time: [np.abs(times - time).min(initial=np.inf) for times in (across, same)] for time in marks.time.tolist()
        }
        exchanged[side] = [time for time, (foot, this) in near.items() if foot <= OTHER_FOOT_S and this > MATCH_S]
    return {side: times for side, times in exchanged.items() if times}


def events_on_plates(
    seen: Mapping[str, Mapping[str, Contacts]], file: str
) -> tuple[dict[str, Mapping[str, Contacts]], list[Finding]]:
    """Contacts in which events of the file that lie more than 30 ms from the plates are moved onto them, and said.

    The plates are believed, unless the markers say that it is the plates' clock that is off.
    """
    late = _lag_ms(seen, "force", "events", SAME_STEP_S)
    if late is None or abs(late) <= EVENTS_MS:
        return dict(seen), []
    lags = [_lag_ms(seen, "markers", name, SAME_STEP_S) for name in ("force", "events")]
    plates, marked = (np.inf if lag is None else abs(lag - EARLY_MS["markers"]) for lag in lags)
    what = f"the file's events are {abs(late):.0f} ms {'after' if late > 0 else 'before'} the steps on a plate, "
    what += f"which exceeds the limit of {EVENTS_MS:g} ms"
    if marked < plates and plates > DISAGREEMENT_MS:
        what += f"; the events are used, because they are {lags[1]:.0f} ms from the markers' contacts"
        return dict(seen), [Finding("warning", "events and plates", file, what, "moments; check the plates' clock")]
    moved = {
        side: replace(c, foot_off=c.foot_off - late / 1e3) for side, c in _move(seen["events"], -late / 1e3).items()
    }
    what += "; the plates are used, and all events were shifted to agree with them"
    return {**seen, "events": moved}, [Finding("warning", "events and plates", file, what, "phase; check the events")]


def _lag_ms(seen: Mapping[str, Mapping[str, Contacts]], detector: str, other: str, within_s: float) -> float | None:
    """Median of how much later another detector places the contacts that both see [ms]; None without any."""
    first, second = seen.get(detector, {}), seen.get(other, {})
    apart = [first[side].compared(second[side], within_s).difference_s for side in first if side in second]
    both = np.concatenate([np.empty(0), *apart])
    return float(1e3 * np.median(both)) if len(both) else None


def find_contacts(
    trial: Trial, direction: str = "", body_weight_n: float | None = None
) -> tuple[dict[str, dict[str, Contacts]], dict[str, GaitdiscError | None]]:
    """Contacts as each detector places them, and why a detector finds no stride of both feet.

    returns refused: detector -> its error; None where it sees contacts, but no stride of both feet
    """
    attempts: dict[str, Callable[[], dict[str, Contacts]]] = {}
    if "forces" in trial.streams:
        attempts["force"] = partial(_force, trial, direction, body_weight_n)
    if any(event.label == "initial contact" for event in trial.events):
        attempts["events"] = partial(event_contacts, trial)
    if "markers" in trial.streams:
        markers = trial.stream("markers")
        attempts["markers"] = lambda: marker_contacts(markers, *walking_markers(markers, direction))
    if "kinematics" in trial.streams:
        attempts["angles"] = partial(angle_contacts, trial.stream("kinematics"))
    contacts: dict[str, dict[str, Contacts]] = {}
    refused: dict[str, GaitdiscError | None] = {}
    for name, attempt in attempts.items():
        try:
            contacts[name] = attempt()
            refused |= {} if _stride_count(contacts[name]) else {name: None}
        except (StrideError, ChannelError) as error:
            refused[name] = error
    return contacts, refused


def _offset(chosen: str, seen: Mapping[str, Mapping[str, Contacts]]) -> tuple[str, float | None]:
    """Detector that saw the ground in a step that the chosen one saw too, and by how much it is later [s]."""
    if chosen not in SEEN_LATE:
        return "", None
    for name in ("force", "events"):
        later = _lag_ms(seen, chosen, name, MATCH_S)
        if later is not None and abs(later) <= 1e3 * MOST_OFFSET_S:
            return name, later / 1e3
    return "", None


def _move(contacts: Mapping[str, Contacts], offset_s: float) -> dict[str, Contacts]:
    return {side: replace(landings, time=landings.time + offset_s) for side, landings in contacts.items()}


def offset_finding(file: str, detector: str, offset_s: float | None, by: str, spoils: str) -> Finding:
    """By how much contacts were moved and by what steps, in words; or that nothing shows it, and what is early then."""
    if offset_s is None:
        what = f"contacts come from {detector}, and no plate recorded a step to correct them; they are about "
        what += f"{EARLY_MS[detector]:g} ms early in walking ({EARLY_RANGE[detector]}, compared with a plate)"
        return Finding("note", "contact offset", file, what, spoils)
    way = "later" if offset_s >= 0 else "earlier"
    what = f"contacts from {detector} were shifted {1000.0 * abs(offset_s):.0f} ms {way} ({by})"
    return Finding("note", "contact offset", file, what, "")


def _force(trial: Trial, direction: str, body_weight_n: float | None) -> dict[str, Contacts]:
    forces = trial.stream("forces")
    of_feet = any(c.quantity == "vertical_force" and c.side for c in forces.channels)
    if of_feet or "markers" not in trial.streams:  # without either it refuses, and says what is needed
        return force_contacts(forces, body_weight_n)
    markers = trial.stream("markers")
    heels, pelvis, way = walking_markers(markers, direction)
    return plate_contacts(forces, markers, heels, way, body_weight_n, pelvis)


def find_marker_names(markers: Recording) -> tuple[dict[str, str], list[str]]:
    """Heel markers by side, and the pelvis markers, by the names that laboratories use."""
    there = {name.rsplit(".", 1)[0] for name in markers.names}
    heels = {side: next((name for name in names if name in there), "") for side, names in HEELS.items()}
    pelvis = [name for name in PELVIS if name in there]
    if not all(heels.values()) or not pelvis:
        raise ChannelError(
            f"markers must include heels ({HEELS['r'][0]}, {HEELS['l'][0]}) and pelvis ({', '.join(PELVIS[:4])})",
            f"{markers.source.file} has {', '.join(filter(None, (*heels.values(), *pelvis))) or 'none of these'}",
            'Map your labels to these names in [channels], for example RightHeel = "RHEE".',
        )
    return heels, pelvis


def walking_markers(markers: Recording, direction: str = "") -> tuple[dict[str, str], list[str], Direction]:
    """Heels, pelvis and direction of walking: `+x` to `-z` in the laboratory's axes, found from them where empty."""
    heels, pelvis = find_marker_names(markers)
    way = walking_direction(markers, heels, pelvis)
    if direction:
        sign = -1.0 if direction[0] == "-" else 1.0
        # laboratories let z point up, OpenSim y; walking along one of them leaves the other
        way = state_direction([sign * part for part in AXES[direction[-1]]], way.up.tolist())
    return heels, pelvis, way


def _stride_count(contacts: Mapping[str, Contacts]) -> int:
    """Strides that both feet have; the other foot may lack one at an end."""
    counts = [max(0, len(landings) - 1) for landings in contacts.values()]
    return max(counts, default=0) if len(counts) == 2 and min(counts) > 0 else 0


def _findings(
    trial: Trial,
    chosen: str,
    seen: Mapping[str, Mapping[str, Contacts]],
    refused: Mapping[str, GaitdiscError | None],
    reference: str,
) -> list[Finding]:
    taken = seen[chosen]
    counts = ", ".join(f"{len(c) - 1} {side}" for side, c in sorted(taken.items()))
    note = next(iter(taken.values())).note
    findings = [Finding("note", "detector", trial.name, f"contacts from {chosen}; strides: {counts}; {note}", "")]
    for name, contacts in seen.items():
        if name == chosen:
            continue
        for side in sorted(set(taken) & set(contacts)):
            agreement = taken[side].compared(contacts[side])
            if name in refused and not len(agreement.difference_s):
                continue
            what = f"{name} against {chosen}, side {side}: {agreement.line()}"
            apart = np.abs(1e3 * agreement.difference_s - agreement.median_ms) > DISAGREEMENT_MS
            spoils = []
            beyond = agreement.median_ms + EARLY_MS.get(name, 0.0) - EARLY_MS.get(chosen, 0.0)
            if abs(beyond) > DISAGREEMENT_MS and name != reference:  # which the contacts were moved by
                spoils.append(f"phase: these detectors disagree by over {DISAGREEMENT_MS:g} ms more than usual")
            if apart.any():
                those = "1 contact" if apart.sum() == 1 else f"{apart.sum()} contacts"
                spoils.append(f"the strides of {those} (over {DISAGREEMENT_MS:g} ms from the median difference)")
            if name not in refused and len(agreement.missed) + len(agreement.extra):
                at = ", ".join(f"{time:.2f}" for time in sorted([*agreement.missed, *agreement.extra])[:5])
                spoils.append(f"the strides at about {at} s: one detector finds a contact there, the other does not")
            severity = "warning" if spoils else "note"
            findings.append(Finding(severity, "detectors compared", trial.name, what, "; ".join(spoils)))
    for name, error in refused.items():
        reason = str(error) if error else "no strides of both feet were found"
        findings.append(Finding("note", "detector", trial.name, f"{name} is not used: {reason}", ""))
    return findings


def nothing_found(
    trial: Trial, needed: str, reasons: Sequence[str], markers: GaitdiscError | None = None
) -> StrideError:
    """That no detector serves, and why each does not; markers of unknown names are the first thing to correct."""
    remedy = "Add the file that contains forces, markers or angles to the trial, or remove the trial."
    return StrideError(
        needed,
        f"{trial.name} has {', '.join(trial.streams) or 'no stream'}; {'; '.join(reasons) or 'none shows contacts'}",
        markers.remedy if isinstance(markers, ChannelError) else remedy,
    )
