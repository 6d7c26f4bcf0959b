"""Channels of a short trial, filtered, as cycles are cut of them: what is dead or missing is left out of it alone.

What Plug-in Gait has under labels of its own is taken under the vocabulary's names, each with the house's sign.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace

import numpy as np
from numpy.typing import NDArray

from gaitdisc.channel import Channel, vocabulary
from gaitdisc.errors import GaitdiscError
from gaitdisc.ingest.study import Filters
from gaitdisc.kinematics.laboratory import PATH_S, STRAIGHT_DEG
from gaitdisc.kinematics.pose import clinical_angles, rotation_of
from gaitdisc.processing.process import envelope_of, is_raw
from gaitdisc.recording import Finding, Recording, Trial
from gaitdisc.recording.runs import runs
from gaitdisc.recording.wrapping import unwrapped
from gaitdisc.signals.butterworth import lowpassed
from gaitdisc.signals.channel_quality import plateau_marked
from gaitdisc.signals.emg import live_channels
from gaitdisc.signals.gaps import filled
from gaitdisc.signals.spikes import without_spikes

FORCE_HZ = 20.0
LEGS = ("hip_", "knee_", "ankle_", "subtalar_")
LOADED_PERCENT = 10.0  # of body weight: the foot is on the plate
# Plug-in Gait: tilt positive forwards, obliquity positive with the named side up, rotation with it forwards.
PLUG_IN_GAIT = {
    "pelvis_tilt": ("RPelvisAngles.x", -1.0),
    "pelvis_list": ("LPelvisAngles.y", 1.0),
    "pelvis_rotation": ("RPelvisAngles.z", 1.0),
    "foot_progression_angle_r": ("RFootProgressAngles.z", 1.0),
    "foot_progression_angle_l": ("LFootProgressAngles.z", 1.0),
}


def cycle_channels(
    trial: Trial, filters: Filters, from_markers: Sequence[str] = ()
) -> tuple[Recording | None, tuple[Recording, ...], tuple[Finding, ...]]:
    """Angles, moments, powers, belt forces and EMG envelopes of a trial, those of the vocabulary.

    Filtered is what was measured, and angles computed here. Moments and powers computed here are of filtered markers
    and forces; angles, moments, powers and weighed forces of the file are as the file has them.

    from_markers: streams that were computed here
    returns legs: angles of the legs, gaps bridged where they may be, not filtered
    returns states: what cycles are cut of, each at its own rate
    returns findings: what could not be used, and which filter the others had
    """
    legs, states, findings, words = None, [], [], []
    for key, quantities in (
        ("kinematics", ("angle", "translation")),
        ("moments", ("moment", "power")),
        ("forces", ("force", "vertical_force")),
        ("emg", ("emg",)),
    ):
        recording = _known(trial, key, quantities)
        if recording is None:
            continue
        try:
            state, how = _filtered(key, recording, filters, key in from_markers)
        except GaitdiscError as error:
            findings.append(Finding("warning", "left out", trial.name, f"{key}: {error}", f"curves of the {key}"))
            continue
        if key == "kinematics":
            own = [channel.name for channel in recording.channels if channel.name.startswith(LEGS)]
            legs = filled(without_spikes(recording.selected(own)), None, filters.gap_s) if own else None
        if state is not None:
            states.append(state)
            words.append(how)
    weighed = weighed_forces(trial)
    if weighed is not None and not any(set(weighed.names) & set(one.names) for one in states):
        states.append(weighed)
        words.append("weighed forces as in the file")
    said = [Finding("note", "filter", trial.name, "; ".join(words), "")] if words else []
    return legs, tuple(states), (*findings, *said)


def _known(trial: Trial, key: str, quantities: tuple[str, ...]) -> Recording | None:
    """Channels of the vocabulary that have a value; forces only where they belong to a foot."""
    if key not in trial.streams:
        return None
    words = {channel.name for channel in vocabulary().channels}
    recording = trial.stream(key)
    if key == "kinematics":
        recording = with_pelvis_and_foot(recording)
    names = [
        channel.name
        for channel, column in zip(recording.channels, recording.values.T, strict=True)
        if channel.name in words
        and channel.quantity in quantities
        and (key != "forces" or channel.side)
        and np.isfinite(column).any()
    ]
    return recording.selected(names) if names else None


def _filtered(key: str, recording: Recording, filters: Filters, computed: bool) -> tuple[Recording | None, str]:
    """Recording as it is shown, and which filter it had; what a file computed has none here."""
    low = f"low-pass {filters.kinematics_hz:g} Hz"
    if key == "emg":
        return _envelopes(recording, filters)
    if key == "forces":
        return lowpassed(recording, FORCE_HZ, filters.order, filters.gap_s), f"forces low-pass {FORCE_HZ:g} Hz"
    if key == "moments" and computed:
        return recording, f"moments and powers from markers ({low}) and forces ({FORCE_HZ:g} Hz)"
    if key == "moments":
        return filled(recording, None, filters.gap_s), "moments and powers as in the file"
    whole = filled(without_spikes(plateau_marked(recording)), None, filters.gap_s)
    if not computed:
        return whole, "angles as in the file"
    return lowpassed(whole, filters.kinematics_hz, filters.order, filters.gap_s), f"angles from markers, {low}"


def _envelopes(emg: Recording, filters: Filters) -> tuple[Recording | None, str]:
    raw, low = is_raw(emg), f"low-pass {filters.emg_lowpass_hz:g} Hz"
    how = f"EMG high-pass {filters.emg_highpass_hz:g} Hz, rectified, {low}" if raw else f"EMG {low}"
    live = live_channels(emg) if raw else emg.names
    return (envelope_of(emg.selected(live), filters, raw), how) if live else (None, "")


def weighed_forces(trial: Trial) -> Recording | None:
    """Forces of the ground on each foot [% of body weight], zero off the plate; None where the file has none.

    Plug-in Gait's `NormalisedGRF` is fore-aft and vertical in percent of body weight, empty off the plate. Forwards is
    positive here: the first half of a step brakes, and a file in which it does not is turned.
    """
    if "moments" not in trial.streams:
        return None
    moments = trial.stream("moments")
    found: dict[Channel, NDArray[np.float64]] = {}
    for side, letter in (("l", "L"), ("r", "R")):
        labels = [f"{letter}NormalisedGRF.{axis}" for axis in "xz"]
        if any(label not in moments.names or moments.channels[moments.index(label)].unit != "%" for label in labels):
            continue
        along, upwards = (np.nan_to_num(moments[label]) for label in labels)
        loaded = upwards > LOADED_PERCENT
        if loaded.any():
            braking = sum(float(along[a : (a + b) // 2].sum()) for a, b in runs(loaded))
            found[Channel(f"ground_force_{side}_vx", "force", "%", side)] = -along if braking > 0 else along
            found[Channel(f"ground_force_{side}_vy", "vertical_force", "%", side)] = upwards
    if not found:
        return None
    return Recording(moments.time, np.column_stack(list(found.values())), tuple(found), trial.subject, trial.condition)


def with_pelvis_and_foot(angles: Recording) -> Recording:
    """Same angles, and those of the pelvis and of foot progression that stand under Plug-in Gait's labels alone."""
    taken: dict[int, tuple[Channel, float]] = {}
    for name, (label, sign) in PLUG_IN_GAIT.items():
        channel = vocabulary().named(name)
        if channel is None or name in angles.names or label not in angles.names:
            continue
        column = angles.names.index(label)
        if (angles.channels[column].quantity, angles.channels[column].unit) == (channel.quantity, channel.unit):
            taken[column] = (channel, sign)
    if not taken:
        return angles
    columns, signs = list(taken), np.array([sign for _, sign in taken.values()])
    marks = angles.suspect
    own = [channel for channel, _ in taken.values()]
    new = replace(angles, values=angles.values[:, columns] * signs, channels=tuple(own), suspect=None)
    return replace(
        angles,
        values=np.column_stack([angles.values, _from_own_heading(new).values]),
        channels=(*angles.channels, *own),
        suspect=None if marks is None else np.column_stack([marks, marks[:, columns]]),
    )


def _from_own_heading(angles: Recording) -> Recording:
    """Same angles; of a pelvis that turns in the laboratory tilt and list about its own heading, its mean of a second.

    About an axis of the laboratory, tilt is obliquity once a person has turned by 90 deg. Angles about the line of
    walking are missing then.
    """
    if not {"pelvis_tilt", "pelvis_list", "pelvis_rotation"} <= set(angles.names):
        return angles
    turned = unwrapped(angles)["pelvis_rotation"]
    known, time = np.isfinite(turned), np.arange(len(turned))
    half = max(round(PATH_S * angles.rate_hz / 2), 1)
    padded = np.pad(np.interp(time, time[known], turned[known]) if known.any() else turned, half, mode="edge")
    heading = np.convolve(padded, np.full(2 * half + 1, 1 / (2 * half + 1)), "valid")
    if not np.ptp(heading) >= STRAIGHT_DEG:
        return angles
    level = rotation_of(np.stack([0 * heading, 0 * heading, heading], axis=1))
    lab = rotation_of(np.stack([angles["pelvis_tilt"], angles["pelvis_list"], turned], axis=1))
    values = np.full(angles.values.shape, np.nan)
    values[:, [angles.index("pelvis_tilt"), angles.index("pelvis_list")]] = clinical_angles(level, lab)[:, :2]
    return angles.with_values(values)
