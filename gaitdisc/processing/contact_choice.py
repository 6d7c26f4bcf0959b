"""Which detector's initial contacts are used, and what the others say of the same walk."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass
from functools import partial

from gaitdisc.errors import ChannelError, GaitdiscError, StrideError
from gaitdisc.recording import Finding, Recording, Trial
from gaitdisc.signals.contact_angles import angle_contacts
from gaitdisc.signals.contact_events import event_contacts
from gaitdisc.signals.contact_force import force_contacts, plate_contacts
from gaitdisc.signals.contact_markers import marker_contacts
from gaitdisc.signals.contacts import Contacts, compared
from gaitdisc.signals.direction import Direction, given_direction, walking_direction

HEELS = {
    "r": ("RHEE", "R.Heel", "RHEEL", "R_Heel", "RCAL", "RCALC"),
    "l": ("LHEE", "L.Heel", "LHEEL", "L_Heel", "LCAL"),
}
PELVIS = ("LASI", "RASI", "LPSI", "RPSI", "SACR", "L.ASIS", "R.ASIS", "L.PSIS", "R.PSIS", "LASIS", "RASIS")
PREFERRED = ("force", "events", "markers", "angles")
ENOUGH = 0.8  # of the strides that the most prolific detector sees
DISAGREEMENT_MS = 30.0
AXES = {"x": (1.0, 0.0, 0.0), "y": (0.0, 1.0, 0.0), "z": (0.0, 0.0, 1.0)}


@dataclass(frozen=True)
class ContactChoice:
    """Initial contacts of both feet, and what was seen on the way.

    Parameters
    ----------
    contacts : mapping of str to Contacts
        Side to contacts, of one detector.
    findings : tuple of Finding
        Which detector was taken and why, how far others differ [ms], and those that could not be used.
    """

    contacts: Mapping[str, Contacts]
    findings: tuple[Finding, ...]

    @property
    def detector(self) -> str:
        """Name of the detector that was taken."""
        return next(iter(self.contacts.values())).detector


def chosen_contacts(trial: Trial, detector: str = "auto", direction: str = "") -> ContactChoice:
    """Initial contacts by the detector asked for, or by the best one that the trial allows.

    `auto` takes force before the file's events before markers before joint angles, but none that sees fewer than 80 %
    of the strides that another sees: a plate in the floor catches one step of many.

    Parameters
    ----------
    trial : Trial
        With any streams; each detector needs its own.
    detector : str
        `auto`, `force`, `events`, `markers` or `angles`.
    direction : str
        Direction of walking in the laboratory's axes, `+x` to `-z`; inferred from the markers where it is empty.

    Returns
    -------
    ContactChoice

    Raises
    ------
    StrideError
        If the detector asked for, or every detector, finds no stride; each one's reason is named.
    """
    found, refused = _every_detector(trial, direction)
    if detector != "auto":
        if detector not in found:
            raise refused.get(detector) or _nothing_found(trial, {detector: None})
        chosen = detector
    else:
        most = max((_stride_count(contacts) for contacts in found.values()), default=0)
        enough = [name for name in PREFERRED if name in found and _stride_count(found[name]) >= ENOUGH * most]
        if most == 0:
            raise _nothing_found(trial, refused)
        chosen = enough[0]
    return ContactChoice(found[chosen], tuple(_findings(trial, chosen, found, refused)))


def _every_detector(
    trial: Trial, direction: str
) -> tuple[dict[str, dict[str, Contacts]], dict[str, GaitdiscError | None]]:
    attempts: dict[str, Callable[[], dict[str, Contacts]]] = {}
    if "forces" in trial.streams:
        attempts["force"] = partial(_force, trial, direction)
    if any(event.label == "initial contact" for event in trial.events):
        attempts["events"] = partial(event_contacts, trial)
    if "markers" in trial.streams:
        attempts["markers"] = partial(_markers, trial.stream("markers"), direction)
    if "kinematics" in trial.streams:
        attempts["angles"] = partial(angle_contacts, trial.stream("kinematics"))
    found: dict[str, dict[str, Contacts]] = {}
    refused: dict[str, GaitdiscError | None] = {}
    for name, attempt in attempts.items():
        try:
            contacts = attempt()
        except (StrideError, ChannelError) as error:
            refused[name] = error
            continue
        if _stride_count(contacts):
            found[name] = contacts
        else:
            refused[name] = None
    return found, refused


def _force(trial: Trial, direction: str) -> dict[str, Contacts]:
    forces = trial.stream("forces")
    if any(c.quantity == "vertical_force" and c.side for c in forces.channels):
        return force_contacts(forces)
    if "markers" not in trial.streams:
        return force_contacts(forces)  # refuses, and says what is needed
    markers = trial.stream("markers")
    heels, pelvis = named_markers(markers)
    return plate_contacts(forces, markers, heels, _direction(markers, heels, pelvis, direction))


def _markers(markers: Recording, direction: str) -> dict[str, Contacts]:
    heels, pelvis = named_markers(markers)
    return marker_contacts(markers, heels, pelvis, _direction(markers, heels, pelvis, direction))


def named_markers(markers: Recording) -> tuple[dict[str, str], list[str]]:
    """Heel markers by side, and the pelvis markers, by the names that laboratories use.

    Parameters
    ----------
    markers : Recording
        Channels `<marker>.x`, `<marker>.y`, `<marker>.z`.

    Returns
    -------
    heels : dict of str to str
        Side to marker.
    pelvis : list of str
        Markers.

    Raises
    ------
    ChannelError
        If a heel or the pelvis has no marker of a known name.
    """
    there = {name.rsplit(".", 1)[0] for name in markers.names}
    heels = {side: next((name for name in names if name in there), "") for side, names in HEELS.items()}
    pelvis = [name for name in PELVIS if name in there]
    if not all(heels.values()) or not pelvis:
        raise ChannelError(
            f"contacts from markers need heels ({HEELS['r'][0]}, {HEELS['l'][0]}) and pelvis ({', '.join(PELVIS[:4])})",
            f"{markers.source.file} has heels {[h for h in heels.values() if h]} and pelvis {pelvis}",
            'Map your names to these in [channels], for example RightHeel = "RHEE".',
        )
    return heels, pelvis


def _direction(markers: Recording, heels: Mapping[str, str], pelvis: list[str], direction: str) -> Direction:
    if not direction:
        return walking_direction(markers, heels, pelvis)
    sign = -1.0 if direction[0] == "-" else 1.0
    forward = [sign * part for part in AXES[direction[-1]]]
    # laboratories let z point up, OpenSim y; walking along one of them leaves the other
    up = walking_direction(markers, heels, pelvis).up
    return given_direction(forward, up.tolist())


def _stride_count(contacts: Mapping[str, Contacts]) -> int:
    """Strides that both feet have; the other foot may lack one at an end."""
    counts = [max(0, len(one) - 1) for one in contacts.values()]
    return max(counts, default=0) if len(counts) == 2 and min(counts) > 0 else 0


def _findings(
    trial: Trial,
    chosen: str,
    found: Mapping[str, Mapping[str, Contacts]],
    refused: Mapping[str, GaitdiscError | None],
) -> list[Finding]:
    taken = found[chosen]
    counts = ", ".join(f"{len(c) - 1} {side}" for side, c in sorted(taken.items()))
    note = next(iter(taken.values())).note
    findings = [Finding("note", "detector", trial.name, f"contacts by {chosen}: strides {counts}; {note}", "")]
    for name, contacts in found.items():
        if name == chosen:
            continue
        for side in sorted(set(taken) & set(contacts)):
            agreement = compared(taken[side], contacts[side])
            far = len(agreement.difference_s) > 0 and abs(agreement.median_ms) > DISAGREEMENT_MS
            spoils = "phase: two detectors disagree by more than three frames at 100 Hz" if far else ""
            severity = "warning" if far and name != "angles" and chosen != "angles" else "note"
            what = f"{name} against {chosen}, side {side}: {agreement.line()}"
            findings.append(Finding(severity, "detectors compared", trial.name, what, spoils))
    for name, error in refused.items():
        reason = str(error) if error else "it finds no stride of both feet"
        findings.append(Finding("note", "detector", trial.name, f"{name} is not used: {reason}", ""))
    return findings


def _nothing_found(trial: Trial, refused: Mapping[str, GaitdiscError | None]) -> StrideError:
    reasons = [f"{name}: {error.found if error else 'no stride of both feet'}" for name, error in refused.items()]
    return StrideError(
        "strides need initial contacts from force, events, markers or joint angles",
        f"{trial.name} has {', '.join(trial.streams) or 'no stream'}; {'; '.join(reasons) or 'none of them serves'}",
        "Add the file that holds forces, markers or angles to the trial, or leave the trial out.",
    )
