"""Channels of a short trial, filtered, as cycles are cut of them: what is dead or missing is left out of it alone."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from gaitdisc.channel import vocabulary
from gaitdisc.errors import GaitdiscError
from gaitdisc.ingest.study import Filters
from gaitdisc.processing.ground_forces import weighed_forces
from gaitdisc.processing.pelvis_and_foot import with_pelvis_and_foot
from gaitdisc.processing.process import is_raw
from gaitdisc.recording import Finding, Recording, Trial
from gaitdisc.signals.butterworth import lowpassed
from gaitdisc.signals.channel_quality import plateau_marked
from gaitdisc.signals.emg import emg_findings, enveloped
from gaitdisc.signals.gaps import filled
from gaitdisc.signals.spikes import without_spikes

FORCE_HZ = 20.0
LEGS = ("hip_", "knee_", "ankle_", "subtalar_")


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
    low = f"low-pass {filters.emg_lowpass_hz:g} Hz"
    if not is_raw(emg):
        return lowpassed(emg, filters.emg_lowpass_hz, filters.order, filters.gap_s), f"EMG {low}"
    dead = {finding.channel for finding in emg_findings(emg) if finding.severity == "refused"}
    live = [name for name in emg.names if name not in dead]
    if not live:
        return None, ""
    envelope = enveloped(emg.selected(live), filters.emg_highpass_hz, filters.emg_lowpass_hz, filters.order)
    return envelope, f"EMG high-pass {filters.emg_highpass_hz:g} Hz, rectified, {low}"
