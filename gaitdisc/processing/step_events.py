"""Contacts and foot offs of one trial: those that the ground or the file saw, and those of markers or angles."""

from collections.abc import Mapping
from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray
from scipy.ndimage import maximum_filter1d

from gaitdisc.errors import ChannelError, StrideError
from gaitdisc.processing.contact_choice import (
    MOST_OFFSET_S,
    PELVIS,
    SEEN_LATE,
    best_detector,
    events_on_plates,
    find_contacts,
    find_exchanged_contacts,
    find_marker_names,
    nothing_found,
    walking_markers,
)
from gaitdisc.recording import Finding, Recording, Trial
from gaitdisc.recording.arrays import Values, finite_rows
from gaitdisc.signals.contact_movement import angle_foot_off, marker_foot_off, stance_windows
from gaitdisc.signals.direction import LEAST_SPEED, PATH_S, Direction, pelvis_position

TOES = {
    "r": ("RTOE", "R.Toe", "R.Toe.Tip", "R_Toe", "RMT2", "RMTH2", "RFM2", "RD2M", "RSMH"),
    "l": ("LTOE", "L.Toe", "L.Toe.Tip", "L_Toe", "LMT2", "LMTH2", "LFM2", "LD2M", "LSMH"),
}
Timed = Mapping[str, tuple[tuple[float, str], ...]]  # side -> time [s] and what placed it
GROUND = ("events", "force")  # what saw the ground, the person who marked the file first
ORDER = (*GROUND, *SEEN_LATE)
ONE_EVENT_S = MOST_OFFSET_S  # nearer than this two detectors speak of one event of a foot
USUAL_STRIDE_S = 1.1
LEAST_PATH_M_PER_S = 0.3  # of the pelvis from end to end
PELVIS_PATH = ("pelvis_tx", "pelvis_tz", *(f"{name}.{axis}" for name in PELVIS for axis in "xyz"))
BELT_M = 2.0  # who comes farther walks over ground
HEEL_M, LEG_DEG = 0.25, 10.0  # least reach of a heel, a hip or a knee within a second of who steps
LEAST_CUT_S = 1.0
NO_WALKWAY_S = 10.0  # a walk that lasts longer and does not show its path is one on a treadmill


@dataclass(frozen=True, eq=False)
class StepEvents:
    """What was seen of the steps of one trial, nothing corrected yet."""

    detector: str  # what sees most strides: `events`, `force`, `markers` or `angles`
    off_detector: str  # `markers` or `angles`, whichever shows foot off; empty where neither does
    contacts: Mapping[str, Values]  # side -> times, as these detectors place them [s]
    foot_offs: Mapping[str, Values]  # side -> times, alike [s]
    # side -> time [s] and `events` or `force`; no contacts where the detector sees the ground itself
    ground_contacts: Timed
    ground_offs: Timed
    findings: tuple[Finding, ...] = ()  # events that contradict the plates, heels that contradict the events

    def later_s(self, kind: str) -> Values:
        """How much later the ground places the events that both see [s]; only steps that both see count."""
        detected, ground = self._of(kind)
        apart = []
        for side, times in detected.items():
            for at, _ in ground.get(side, ()):
                nearest = times[np.argmin(np.abs(times - at))] if len(times) else np.inf
                apart.append(at - nearest)
        delays = np.asarray(apart, float)
        return delays[np.abs(delays) <= MOST_OFFSET_S]

    def corrected(self, kind: str, offset_s: float) -> dict[str, tuple[tuple[float, str], ...]]:
        """Events moved later by `offset_s` [s] or replaced by the ground's own: side -> (time, what placed it)."""
        detected, ground = self._of(kind)
        by = self.detector if kind == "contacts" else self.off_detector
        events = {}
        for side in sorted(set(detected) | set(ground)):
            placed = list(ground.get(side, ()))
            moved = detected.get(side, np.empty(0)) + offset_s
            if kind == "contacts" and len(moved):  # what the ground alone saw between the markers' contacts is false
                near = {at: np.abs(moved - at).min() <= ONE_EVENT_S for at, _ in placed}
                placed = [(at, word) for at, word in placed if near[at] or at < moved[0] or at > moved[-1]]
            alone = [at for at in moved if all(abs(at - there) > ONE_EVENT_S for there, _ in placed)]
            events[side] = tuple(sorted([*placed, *((float(at), by) for at in alone)]))
        return events

    def _of(self, kind: str) -> tuple[Mapping[str, Values], Timed]:
        return (self.contacts, self.ground_contacts) if kind == "contacts" else (self.foot_offs, self.ground_offs)


def step_events(
    trial: Trial, detector: str = "auto", direction: str = "", body_weight_n: float | None = None
) -> StepEvents:
    """Contacts and foot offs of a trial of any length; one stride of one foot is enough.

    The file's events go before force before markers before angles, but none that sees fewer than 80 % of the strides
    that another sees, unless the other contradicts the events; angles only where nothing else sees a stride. What the
    ground or the file saw stands beside. Direction and weight are as in `choose_contacts`.
    """
    seen, refused = find_contacts(trial, direction, body_weight_n)
    seen, findings = events_on_plates(seen, trial.name)
    strides = {
        name: count
        for name, contacts in seen.items()
        if (count := sum(max(0, len(marks) - 1) for marks in contacts.values()))
    }
    if not strides if detector == "auto" else detector not in strides:
        reasons = []
        for name in dict.fromkeys([*seen, *refused]):
            error = refused.get(name)
            counts = ", ".join(f"{len(marks)} of side {side}" for side, marks in sorted(seen.get(name, {}).items()))
            reasons.append(f"{name}: {error.found if error else f'contacts: {counts or 0}'}")
        by = "events, force, markers or joint angles" if detector == "auto" else detector
        needed = f"a cycle must have two initial contacts of the same foot, from {by}"
        raise nothing_found(trial, needed, reasons, refused.get("markers"))
    sure = {name: count for name, count in strides.items() if name != "angles"} or strides
    chosen = best_detector(ORDER, sure, seen) if detector == "auto" else detector
    if chosen == "events":
        for side, at in find_exchanged_contacts(seen["events"], seen.get("markers", {})).items():
            what = f"the heel of side {side} lands at {', '.join(f'{time:.2f}' for time in at[:5])} s, when the "
            what += "file's events mark the other foot: the heels seem to be exchanged; the events are used"
            spoils = "step lengths and widths, which are excluded for this trial; correct the labels of the heels"
            findings.append(Finding("warning", "exchanged heels", trial.name, what, spoils))
    contacts = {side: marks.time for side, marks in seen[chosen].items()}
    off_detector, offs = _find_offs(trial, contacts, direction)
    ground = {name: seen[name] for name in GROUND if name in seen}
    ground_offs = {name: {s: marks.foot_off for s, marks in sides.items()} for name, sides in ground.items()}
    for side, times in ground_offs.get("force", {}).items():  # a foot that leaves a plate may still be on the floor
        detected = offs.get(side, np.empty(0))
        shown = [not len(detected) or np.abs(detected - at).min() <= MOST_OFFSET_S for at in times]
        ground_offs["force"][side] = times[np.array(shown, bool)]
    late = ground if chosen in SEEN_LATE else {}
    return StepEvents(
        detector=chosen,
        off_detector=off_detector,
        contacts=contacts,
        foot_offs=offs,
        ground_contacts=_merge({name: {s: marks.time for s, marks in sides.items()} for name, sides in late.items()}),
        ground_offs=_merge(ground_offs),
        findings=tuple(findings),
    )


def walking_part(trial: Trial) -> Trial:
    """Trial without standing, and turning on the spot, before and after the walk; what was cut is a finding."""
    shown = _stepping(trial)
    if shown is None or not shown[1].any():
        return trial
    time, walks = shown
    # half of the second that first shows walking lies behind it: the first step from standing stays, as the last one
    start, end = (float(time[at]) for at in np.flatnonzero(walks)[[0, -1]])
    start = start if start - time[0] > LEAST_CUT_S else -np.inf
    end = end if time[-1] - end > LEAST_CUT_S else np.inf
    cut = [f"{time[0]:.1f} to {start:.1f} s"] if np.isfinite(start) else []
    cut += [f"{end:.1f} to {time[-1]:.1f} s"] if np.isfinite(end) else []
    if not cut:
        return trial
    what = f"no walking from {' and from '.join(cut)} (standing, or turning on the spot); this part was cut out"
    finding = Finding("note", "standing", trial.name, what, "")
    streams = {key: part for key, stream in trial.streams.items() if len((part := stream.between(start, end)).time) > 1}
    events = tuple(event for event in trial.events if start <= event.time < end)
    return replace(trial, streams=streams, events=events, findings=(*trial.findings, finding))


def _stepping(trial: Trial) -> tuple[Values, NDArray[np.bool_]] | None:
    """Values, and at which of them somebody walks: the pelvis travels, or on the spot heels or joints move."""
    markers, legs = trial.streams.get("markers"), trial.streams.get("kinematics")
    try:
        heels, pelvis = find_marker_names(markers) if markers is not None else ({}, [])
    except ChannelError:
        heels, pelvis = {}, []
    if markers is not None and heels:
        centre, half = pelvis_position(markers, pelvis), round(PATH_S / 2 * markers.rate_hz)
        metres = np.linalg.norm(centre[2 * half :] - centre[: -2 * half], axis=1)
        known = np.flatnonzero(np.isfinite(metres))
        if len(known) and np.linalg.norm(np.ptp(finite_rows(centre), axis=0)) >= BELT_M:
            # a pelvis that the cameras do not see yet, or no more, moves as it does where they first or last see it
            path = np.interp(np.arange(len(centre)), known + half, metres[known])
            return markers.time, path >= LEAST_SPEED * PATH_S
        return markers.time, _reaches(markers, [f"{heel}.{axis}" for heel in heels.values() for axis in "xyz"], HEEL_M)
    joints = [] if legs is None else [name for name in legs.names if name[:-1] in ("hip_flexion_", "knee_angle_")]
    return (legs.time, _reaches(legs, joints, LEG_DEG)) if legs is not None and joints else None


def _reaches(recording: Recording, names: list[str], least: float) -> NDArray[np.bool_]:
    """Whether one of some channels ranges over so much within a second about each sample."""
    x, size = recording.selected(names).values, round(PATH_S * recording.rate_hz) | 1
    most, lowest = (maximum_filter1d(np.where(np.isfinite(x), sign * x, -np.inf), size, axis=0) for sign in (1, -1))
    return np.asarray((most + lowest >= least).any(axis=1))


def over_ground(trial: Trial) -> bool:
    """Whether somebody walks through the room: by the pelvis' path, else by a length of the trial of up to 10 s."""
    known = trial_markers(trial)
    if known is not None:
        return known[2].headings is not None
    for stream in map(trial.streams.get, ("kinematics", "markers")):  # markers whose heels do not show the direction
        path = stream and [name for name in PELVIS_PATH if name in stream.names]
        if stream and path and len(places := finite_rows(stream.selected(path).values)):
            return float(np.linalg.norm(np.ptp(places, axis=0))) / stream.duration_s >= LEAST_PATH_M_PER_S
    return max((recording.duration_s for recording in trial.streams.values()), default=0.0) <= NO_WALKWAY_S


def trial_markers(trial: Trial, direction: str = "") -> tuple[dict[str, str], list[str], Direction] | None:
    """Heels, pelvis and direction (`+x` to `-z`, inferred where empty); None where markers do not give them."""
    if "markers" not in trial.streams:
        return None
    try:
        return walking_markers(trial.stream("markers"), direction)
    except (ChannelError, StrideError):
        return None


def _merge(seen: Mapping[str, Mapping[str, Values]]) -> dict[str, tuple[tuple[float, str], ...]]:
    events: dict[str, list[tuple[float, str]]] = {}
    for name in GROUND:
        for side, times in seen.get(name, {}).items():
            there = events.setdefault(side, [])
            there += [(float(at), name) for at in times if all(abs(at - other) > ONE_EVENT_S for other, _ in there)]
    return {side: tuple(sorted(times)) for side, times in events.items()}


def _find_offs(trial: Trial, contacts: Mapping[str, Values], direction: str) -> tuple[str, dict[str, Values]]:
    """Foot offs of each side that has contacts, from markers or else from the ankle, and which of the two."""
    lengths = np.concatenate([np.diff(times) for times in contacts.values()])
    stride_s = float(np.median(lengths)) if len(lengths) else USUAL_STRIDE_S
    windows = {side: stance_windows(times, stride_s) for side, times in contacts.items()}
    known = trial_markers(trial, direction)
    markers = trial.streams.get("markers")
    there = {name.rsplit(".", 1)[0] for name in markers.names} if markers is not None else set()
    toes = {side: next((name for name in names if name in there), "") for side, names in TOES.items()}
    if markers is not None and known is not None and all(toes[side] for side in contacts):
        _, pelvis, way = known
        return "markers", {s: marker_foot_off(markers, toes[s], pelvis, way, windows[s]) for s in contacts}
    kinematics = trial.streams.get("kinematics")
    if kinematics is None or any(f"ankle_angle_{side}" not in kinematics.names for side in contacts):
        return "", {}
    return "angles", {s: angle_foot_off(kinematics, f"ankle_angle_{s}", windows[s]) for s in contacts}
