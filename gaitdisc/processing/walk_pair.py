"""Two recordings made comparable: the same filters, and percent stride counted by the same kind of contact."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import replace

import numpy as np
import pandas as pd
from numpy.typing import NDArray

from gaitdisc.errors import GaitdiscError, StrideError
from gaitdisc.processing.contact_choice import ENOUGH, PREFERRED, chosen_contacts, seen_contacts
from gaitdisc.processing.one_stride import TIMES, repeated_stride
from gaitdisc.processing.process import is_raw, quality_findings, stride_findings
from gaitdisc.processing.walk import stride_table
from gaitdisc.recording import PERCENT, Finding, Recording, Strides, Trial
from gaitdisc.results import WalkSummary
from gaitdisc.signals.butterworth import KINEMATICS_HZ, lowpassed
from gaitdisc.signals.contact_movement import angle_contacts
from gaitdisc.signals.contacts import Contacts
from gaitdisc.signals.emg import ENVELOPE_HZ, enveloped
from gaitdisc.signals.sides import verify_sides
from gaitdisc.signals.spikes import without_spikes
from gaitdisc.signals.stride_quality import without_outlying
from gaitdisc.signals.strides import MAX_S, cut_strides
from gaitdisc.signals.walking import verify_walking

FORCE_HZ = 20.0
SPOILED_CHANNELS = 2  # of the legs' angles in which a stride must be unlike the others to be left out
COMPARED = {
    "kinematics": ("angle",),
    "moments": ("moment", "power"),
    "forces": ("force", "vertical_force"),
    "emg": ("emg",),
}


def walk_pair(
    first: Trial, second: Trial, cutoff_hz: float = KINEMATICS_HZ, detector: str = "auto"
) -> tuple[WalkSummary, WalkSummary]:
    """Curves of every stride of two walks, filtered alike and cut at the same mark of the stride.

    Contacts come from one detector in both, the best that serves both: those from joint angles lie some percent of the
    stride before those from a plate, and a gap between two recordings would be made of that. Joint angles and moments
    are low-passed at `cutoff_hz`, forces at 20 Hz, EMG becomes its envelope; angles, moments, powers, forces and EMG
    are kept. Strides that are unlike the others in two angles of the legs (a stumble) are left out, with a finding; a
    change that lasts four strides or more stays. A recording of one stride that closes in itself counts as one.

    cutoff_hz: -3 dB frequency of one pass of the low-pass of angles and moments

    >>> from gaitdisc.cohort.cohort import the_twelve, walks_of
    >>> walks = walks_of(the_twelve()[0], 20.0).trials.values()
    >>> [(walk.detector, walk.curves.shape[1:]) for walk in walk_pair(*walks)]
    [('force', (101, 28)), ('force', (101, 28))]
    """
    given = (first, second)
    trials = [_with_strides(trial) for trial in given]
    chosen, contacts = _common_contacts(trials, detector)
    one, other = (
        _summary(trials[k], contacts[k], cutoff_hz, repeated=trials[k] is not given[k]) for k in range(len(given))
    )
    what = f"percent stride counted by {chosen} in both, as it places contacts"
    note = Finding("note", "detector", f"{first.name}, {second.name}", what, "")
    if len(contacts[0]) == 1:
        foot = {"r": "right", "l": "left"}[next(iter(contacts[0]))]
        spoils = "percent stride of the other leg"
        note = replace(note, severity="warning", what=f"{what}; of the {foot} foot, for both legs", spoils=spoils)
    return one, replace(other, findings=(*other.findings, note))


def _with_strides(trial: Trial) -> Trial:
    """Return the trial, or the repeated one where a short recording is a single stride."""
    if "kinematics" not in trial.streams or trial.stream("kinematics").duration_s > MAX_S:
        return trial
    try:
        chosen_contacts(trial)
    except GaitdiscError:
        return repeated_stride(trial)
    return trial


def _common_contacts(trials: list[Trial], detector: str) -> tuple[str, list[Mapping[str, Contacts]]]:
    names = PREFERRED if detector == "auto" else (detector,)
    found, reasons = [], []
    for trial, joints in zip(trials, _with_common_joints(trials), strict=True):
        here: dict[str, Mapping[str, Contacts]] = {}
        why = []
        for name in names:
            try:
                here[name] = _contacts(trial, name, joints)
            except GaitdiscError as error:
                why.append(f"{name}: {error.found}")
        found.append(here)
        reasons.append(f"{trial.name} by {'; by '.join(why)}")
    most = [max(map(_stride_count, here.values()), default=0) for here in found]
    for name in names:
        serves = [
            name in here and _stride_count(here[name]) >= ENOUGH * top for here, top in zip(found, most, strict=True)
        ]
        if all(serves) and min(most) and (sides := found[0][name].keys() & found[1][name].keys()):
            return name, [{side: here[name][side] for side in sides} for here in found]
    raise StrideError(
        "two walks are compared over strides that one detector finds in both: force, events, markers or hip angles",
        ". ".join(reasons),
        "Give recordings of walking that both have hip flexion, or both forces, or both markers.",
    )


def _contacts(trial: Trial, name: str, joints: Recording | None) -> Mapping[str, Contacts]:
    if name != "angles":
        seen, _ = seen_contacts(trial)  # as placed: one recording may lack the plate that corrects the other
        contacts = {side: one for side, one in seen.get(name, {}).items() if len(one) > 1}
        return contacts or chosen_contacts(trial, name).contacts  # which says why there are none
    if joints is None:
        raise StrideError(
            "contacts from angles need hip flexion of one side in both recordings",
            "the two have no hip in common",
            "Map the columns in the study's [channels].",
        )
    sides = tuple(channel.side for channel in joints.channels if channel.name.startswith("hip_flexion"))
    return angle_contacts(joints, sides)


def _with_common_joints(trials: list[Trial]) -> list[Recording | None]:
    """Hips and knees that both have: the knee marks another percent of the stride than the hip."""
    if not all("kinematics" in trial.streams for trial in trials):
        return [None] * len(trials)
    kinematics = [trial.stream("kinematics") for trial in trials]
    both = set(kinematics[0].names) & set(kinematics[1].names)
    sides = [side for side in "rl" if f"hip_flexion_{side}" in both]
    knees = [f"knee_angle_{side}" for side in sides]
    names = [f"hip_flexion_{side}" for side in sides] + (knees if set(knees) <= both else [])
    return [recording.selected(names) if names else None for recording in kinematics]


def _stride_count(contacts: Mapping[str, Contacts]) -> int:
    return sum(len(one) - 1 for one in contacts.values())


def _summary(trial: Trial, contacts: Mapping[str, Contacts], cutoff_hz: float, repeated: bool) -> WalkSummary:
    strides = {side: cut_strides(found) for side, found in sorted(contacts.items())}
    if "kinematics" in trial.streams and not repeated:
        legs = _legs(trial)
        strides = {side: without_outlying(legs, cut, SPOILED_CHANNELS) for side, cut in strides.items()}
    follow = "r" if "r" in strides else next(iter(strides))
    states = [state for key in COMPARED if (state := _state(trial, key, cutoff_hz)) is not None]
    findings = list(trial.findings)
    if not repeated:
        findings += quality_findings(replace(trial, streams={k: v for k, v in trial.streams.items() if k in COMPARED}))
    if "kinematics" in trial.streams:
        findings += _looked_at(trial, strides[follow], repeated)
    curves = _joined([_curves(state, strides, follow) for state in states])
    if repeated:
        curves = curves[len(curves) // 2 :][:1]  # all are the same
    lead = states[0] if states else next(iter(trial.streams.values()))
    return WalkSummary(
        trial.subject,
        trial.condition or trial.name,
        lead.duration_s / (TIMES if repeated else 1),
        lead.rate_hz,
        strides[follow].detector,
        tuple(channel for state in states for channel in state.channels),
        curves,
        pd.concat([stride_table(one) for one in strides.values()], ignore_index=True),
        tuple(findings),
        {r.source.file: r.source.sha256 for r in trial.streams.values() if r.source.sha256},
    )


def _looked_at(trial: Trial, strides: Strides, repeated: bool) -> list[Finding]:
    """Refuse what is no walking; say what the strides show."""
    legs = _legs(trial)
    joints = [f"{joint}_{side}" for joint in ("hip_flexion", "knee_angle") for side in "rl"]
    if set(joints) <= set(legs.names):
        verify_walking(legs.selected(joints), strides, fewest=1, least_coverage=0.0)
    if f"knee_angle_{strides.side}" in legs.names:
        verify_sides(legs, strides)
    return [] if repeated else stride_findings(trial.stream("kinematics"), strides)


def _legs(trial: Trial) -> Recording:
    joints = {f"{joint}_{side}" for joint in ("hip_flexion", "knee_angle", "ankle_angle") for side in "rl"}
    return trial.stream("kinematics").selected_by(lambda channel: channel.name in joints)


def _state(trial: Trial, key: str, cutoff_hz: float) -> Recording | None:
    """Filtered channels of one stream, or None where the trial has none that are compared."""
    if key not in trial.streams:
        return None
    recording = trial.stream(key).selected_by(lambda channel: channel.quantity in COMPARED[key])
    if not recording.channels:
        return None
    if key == "emg":
        return enveloped(recording) if is_raw(recording) else lowpassed(recording, ENVELOPE_HZ)
    return lowpassed(without_spikes(recording), FORCE_HZ if key == "forces" else cutoff_hz)


def _curves(state: Recording, strides: Mapping[str, Strides], follow: str) -> NDArray[np.float64]:
    """Strides of every channel, cut by the contacts of its own foot."""
    own = [channel.side if channel.side in strides else follow for channel in state.channels]
    by_side = {side: strides[side].normalised(state) for side in set(own)}
    curves = np.full((max(map(len, by_side.values())), len(PERCENT), len(own)), np.nan)
    for column, side in enumerate(own):
        curves[: len(by_side[side]), :, column] = by_side[side][:, :, column]
    return curves


def _joined(parts: list[NDArray[np.float64]]) -> NDArray[np.float64]:
    longest = max((len(part) for part in parts), default=0)
    whole = np.full((longest, len(PERCENT), sum(part.shape[2] for part in parts)), np.nan)
    column = 0
    for part in parts:
        whole[: len(part), :, column : column + part.shape[2]] = part
        column += part.shape[2]
    return whole
