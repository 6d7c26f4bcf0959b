"""Two recordings made comparable: the same filters, and percent stride counted by the same kind of contact.

A periodic simulation gives one stride that closes in itself: it is walked on until contacts can be found in it.
"""

from collections.abc import Mapping
from dataclasses import replace

import numpy as np

from gaitdisc.errors import GaitdiscError, StrideError
from gaitdisc.ingest.study import Filters
from gaitdisc.processing.contact_choice import ENOUGH, PREFERRED, choose_contacts, find_contacts
from gaitdisc.processing.pooled_cycles import WalkSummary
from gaitdisc.processing.process import knees_and_hips, make_envelope, quality_findings, stride_findings, walk_summary
from gaitdisc.recording import Finding, Recording, Trial
from gaitdisc.signals.butterworth import KINEMATICS_HZ, low_pass
from gaitdisc.signals.contact_movement import angle_contacts
from gaitdisc.signals.contacts import Contacts
from gaitdisc.signals.gaps import without_spikes
from gaitdisc.signals.sides import verify_sides
from gaitdisc.signals.stride_quality import without_outlying
from gaitdisc.signals.strides import MAX_S, MIN_S, cut_strides, verify_walking

FORCE_HZ = 20.0
TIMES = 8  # a stride that closes in itself is walked
LEGS = ("hip", "knee", "ankle")
CLOSES = 0.08  # of an angle's reach: how far apart both ends may lie
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

    >>> from gaitdisc.cohort.cohort import the_twelve, make_walks
    >>> walks = make_walks(the_twelve()[0], 20.0).trials.values()
    >>> [(walk.detector, walk.curves.shape[1:]) for walk in walk_pair(*walks)]
    [('force', (101, 28)), ('force', (101, 28))]
    """
    given = (first, second)
    trials = [_with_strides(trial) for trial in given]
    chosen, contacts = _common_contacts(trials, detector)
    first_summary, second_summary = (
        _summary(trials[k], contacts[k], cutoff_hz, repeated=trials[k] is not given[k]) for k in range(len(given))
    )
    what = f"percent stride begins at the contacts from {chosen} in both walks"
    note = Finding("note", "detector", f"{first.name}, {second.name}", what, "")
    if len(contacts[0]) == 1:
        foot = {"r": "right", "l": "left"}[next(iter(contacts[0]))]
        spoils = "percent stride of the other leg"
        note = replace(note, severity="warning", what=f"{what}; the {foot} foot is used for both legs", spoils=spoils)
    return first_summary, replace(second_summary, findings=(*second_summary.findings, note))


def _with_strides(trial: Trial) -> Trial:
    """Return the trial, or the repeated one where a short recording is a single stride."""
    if "kinematics" not in trial.streams or trial.stream("kinematics").duration_s > MAX_S:
        return trial
    try:
        choose_contacts(trial)
    except GaitdiscError:
        return repeat_stride(trial)
    return trial


def _common_contacts(trials: list[Trial], detector: str) -> tuple[str, list[Mapping[str, Contacts]]]:
    names = PREFERRED if detector == "auto" else (detector,)
    contacts, reasons = [], []
    for trial, joints in zip(trials, _with_common_joints(trials), strict=True):
        here: dict[str, Mapping[str, Contacts]] = {}
        why = []
        for name in names:
            try:
                here[name] = _contacts(trial, name, joints)
            except GaitdiscError as error:
                why.append(f"{name}: {error.found}")
        contacts.append(here)
        reasons.append(f"{trial.name} {'by ' + '; by '.join(why) if why else 'has contacts by ' + ', '.join(here)}")
    most = [max(map(_stride_count, here.values()), default=0) for here in contacts]
    for name in names:
        serves = [
            name in here and _stride_count(here[name]) >= ENOUGH * top for here, top in zip(contacts, most, strict=True)
        ]
        if all(serves) and min(most) and (sides := contacts[0][name].keys() & contacts[1][name].keys()):
            return name, [{side: here[name][side] for side in sides} for here in contacts]
    raise StrideError(
        "the same detector must find strides in both walks: force, events, markers or hip angles",
        ". ".join(reasons),
        "Use two walks with hip flexion, with forces or with markers.",
    )


def _contacts(trial: Trial, name: str, joints: Recording | None) -> Mapping[str, Contacts]:
    if name != "angles":
        seen, _ = find_contacts(trial)  # as placed: one recording may lack the plate that corrects the other
        contacts = {side: foot_contacts for side, foot_contacts in seen.get(name, {}).items() if len(foot_contacts) > 1}
        return contacts or choose_contacts(trial, name).contacts  # which says why there are none
    if joints is None:
        raise StrideError(
            "both recordings must have hip flexion of the same side if contacts come from angles",
            "the walks have no hip angle in common",
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
    return sum(len(foot_contacts) - 1 for foot_contacts in contacts.values())


def _summary(trial: Trial, contacts: Mapping[str, Contacts], cutoff_hz: float, repeated: bool) -> WalkSummary:
    strides = {side: cut_strides(foot_contacts) for side, foot_contacts in sorted(contacts.items())}
    if "kinematics" in trial.streams and not repeated:
        names = {f"{joint}_{side}" for joint in ("hip_flexion", "knee_angle", "ankle_angle") for side in "rl"}
        legs = trial.stream("kinematics").selected_by(lambda channel: channel.name in names)
        strides = {side: without_outlying(legs, cut, SPOILED_CHANNELS) for side, cut in strides.items()}
    follow = "r" if "r" in strides else next(iter(strides))
    states = [state for key in COMPARED if (state := _state(trial, key, cutoff_hz)) is not None]
    findings = list(trial.findings)
    if not repeated:
        findings += quality_findings(replace(trial, streams={k: v for k, v in trial.streams.items() if k in COMPARED}))
    if "kinematics" in trial.streams:
        legs = knees_and_hips(trial)
        if len(legs.names) == 4:
            verify_walking(legs, strides[follow], fewest=1, least_coverage=0.0)
        if f"knee_angle_{follow}" in legs.names:
            verify_sides(legs, strides[follow])
        findings += [] if repeated else stride_findings(trial.stream("kinematics"), strides[follow])
    walk = walk_summary(trial, states, strides, follow, findings)
    walk = replace(walk, condition=trial.condition or trial.name)
    if not repeated:
        return walk
    # all strides are the same
    return replace(walk, duration_s=walk.duration_s / TIMES, curves=walk.curves[len(walk.curves) // 2 :][:1])


def _state(trial: Trial, key: str, cutoff_hz: float) -> Recording | None:
    """Filtered channels of one stream, or None where the trial has none that are compared."""
    if key not in trial.streams:
        return None
    recording = trial.stream(key).selected_by(lambda channel: channel.quantity in COMPARED[key])
    if not recording.channels:
        return None
    if key == "emg":
        return make_envelope(recording, Filters())
    return low_pass(without_spikes(recording), FORCE_HZ if key == "forces" else cutoff_hz)


def repeat_stride(trial: Trial) -> Trial:
    """Walk that repeats the one stride of a trial, so that contacts are found as in any other walk.

    The stride may begin anywhere. Only streams on the time base of the kinematics are kept. A last sample that repeats
    the first is left out.

    >>> from gaitdisc.channel import Channel
    >>> t = np.linspace(0.0, 1.0, 101)
    >>> hip = Recording(t, 30 * np.cos(2 * np.pi * t)[:, None], (Channel("hip_flexion_r", "angle", "deg", "r"),))
    >>> round(repeat_stride(Trial("sim", {"kinematics": hip})).stream("kinematics").duration_s, 2)
    8.0
    """
    kinematics = trial.stream("kinematics")
    count = _period(kinematics, trial.name)
    streams = {
        key: replace(
            recording,
            time=recording.time[0] + np.arange(TIMES * count) / recording.rate_hz,
            values=np.tile(recording.values[:count], (TIMES, 1)),
            suspect=np.tile(recording.suspect[:count], (TIMES, 1)),
        )
        for key, recording in trial.streams.items()
        if len(recording.time) == len(kinematics.time) and np.allclose(recording.time, kinematics.time, atol=1e-6)
    }
    excluded = sorted(set(trial.streams) - set(streams))
    what = f"one stride of {count / kinematics.rate_hz:.3f} s that ends as it began, repeated {TIMES} times"
    if excluded:
        what += f"; excluded because of a different time base: {', '.join(excluded)}"
    spread = "the spread over strides, which a single stride does not have"
    note = Finding("note", "one stride", kinematics.source.file or trial.name, what, spread)
    return replace(trial, streams=streams, events=(), findings=(*trial.findings, note))


def _period(kinematics: Recording, name: str) -> int:
    """Samples of the stride: all of them, or one less where the last repeats the first."""
    angles = kinematics.selected_by(lambda channel: channel.quantity == "angle" and channel.name.startswith(LEGS))
    needed = f"one stride of a periodic simulation must last {MIN_S:g} to {MAX_S:g} s and end as it began"
    if not MIN_S <= kinematics.duration_s <= MAX_S or len(kinematics.time) < 8:
        defect = f"{name} lasts {kinematics.duration_s:.2f} s in {len(kinematics.time)} samples"
        raise StrideError(needed, defect, "Use one complete stride, or a walk of several strides.")
    x = angles.values
    reach = np.ptp(x, axis=0)
    moving = np.isfinite(reach) & (reach > 1.0)
    if not moving.any():
        raise StrideError(needed, f"{name} has no leg angle that varies", "Provide joint angles in deg or rad.")
    apart = np.abs(x[-1] - x[0])[moving] / reach[moving]
    if np.median(apart) > CLOSES:
        worst = int(np.flatnonzero(moving)[np.argmax(apart)])
        defect = f"in {name}, {angles.names[worst]} ends {abs(x[-1, worst] - x[0, worst]):.1f} deg from where it began"
        raise StrideError(needed, defect, "Use a complete stride (two steps), or a walk of several strides.")
    step = np.abs(np.diff(x, axis=0)).mean(axis=0)[moving] / reach[moving]
    beside = np.abs(x[1] - x[-1])[moving] / reach[moving]
    closing = np.median(apart) < 0.25 * np.median(step) and np.median(beside) > np.median(apart)
    return len(x) - 1 if closing else len(x)
