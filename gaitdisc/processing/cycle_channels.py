"""Channels of a short trial, filtered, as cycles are cut of them: what is dead or missing is left out of it alone."""

from __future__ import annotations

import numpy as np

from gaitdisc.channel import vocabulary
from gaitdisc.errors import GaitdiscError
from gaitdisc.ingest.study import Filters
from gaitdisc.processing.ground_forces import weighed_forces
from gaitdisc.processing.pelvis_and_foot import with_pelvis_and_foot
from gaitdisc.processing.process import is_raw
from gaitdisc.recording import Finding, Recording, Trial
from gaitdisc.signals.butterworth import lowpassed
from gaitdisc.signals.emg_quality import emg_findings
from gaitdisc.signals.envelope import enveloped
from gaitdisc.signals.gaps import filled
from gaitdisc.signals.plateaus import plateau_marked
from gaitdisc.signals.spikes import without_spikes

FORCE_HZ = 20.0
LEGS = ("hip_", "knee_", "ankle_", "subtalar_")


def cycle_channels(
    trial: Trial, filters: Filters, smooth_moments: bool = False
) -> tuple[Recording | None, tuple[Recording, ...], tuple[Finding, ...]]:
    """Filtered angles, moments, powers, belt forces and EMG envelopes of a trial, those of the vocabulary.

    smooth_moments: whether moments and powers were computed of filtered markers and forces, so that they stay as they
        are
    returns legs: angles of the legs, gaps bridged where they may be, not filtered
    returns states: what cycles are cut of, each at its own rate
    """
    legs, states, findings = None, [], []
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
            smooth = smooth_moments and key == "moments"
            state = recording if smooth else _filtered(key, recording, filters)
        except GaitdiscError as error:
            findings.append(Finding("warning", "left out", trial.name, f"{key}: {error}", f"curves of the {key}"))
            continue
        if key == "kinematics":
            own = [channel.name for channel in recording.channels if channel.name.startswith(LEGS)]
            legs = filled(without_spikes(recording.selected(own)), None, filters.gap_s) if own else None
        states += [state] if state is not None else []
    weighed = weighed_forces(trial)
    if weighed is not None and not any(set(weighed.names) & set(one.names) for one in states):
        states.append(lowpassed(weighed, FORCE_HZ, filters.order, filters.gap_s))
    return legs, tuple(states), tuple(findings)


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


def _filtered(key: str, recording: Recording, filters: Filters) -> Recording | None:
    if key == "emg":
        return _envelopes(recording, filters)
    if key == "forces":
        return lowpassed(recording, FORCE_HZ, filters.order, filters.gap_s)
    clean = without_spikes(plateau_marked(recording)) if key == "kinematics" else recording
    return lowpassed(filled(clean, None, filters.gap_s), filters.kinematics_hz, filters.order, filters.gap_s)


def _envelopes(emg: Recording, filters: Filters) -> Recording | None:
    if not is_raw(emg):
        return lowpassed(emg, filters.emg_lowpass_hz, filters.order, filters.gap_s)
    dead = {finding.channel for finding in emg_findings(emg) if finding.severity == "refused"}
    live = [name for name in emg.names if name not in dead]
    if not live:
        return None
    return enveloped(emg.selected(live), filters.emg_highpass_hz, filters.emg_lowpass_hz, filters.order)
