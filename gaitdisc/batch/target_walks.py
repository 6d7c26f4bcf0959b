"""Walks from whose sensors other quantities are reconstructed than movement: muscles, ground forces, joint moments."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace

import numpy as np

from gaitdisc.errors import ChannelError, SamplingError, SchemaError
from gaitdisc.ingest.study import Study
from gaitdisc.processing.contact_choice import chosen_contacts
from gaitdisc.processing.process import is_raw
from gaitdisc.processing.walk_pair import FORCE_HZ
from gaitdisc.recording import Finding, Recording, Strides, Trial
from gaitdisc.recording.strides import interpolated
from gaitdisc.signals.butterworth import lowpassed
from gaitdisc.signals.emg import emg_findings, enveloped
from gaitdisc.signals.strides import cut_strides

STATES = "states"
TARGETS = {
    "emg": ("emg", ("emg",)),
    "forces": ("forces", ("force", "vertical_force")),
    "moments": ("moments", ("moment",)),
}  # word -> stream of a trial, and its quantities
SENSED = ("kinematics", "markers")  # streams that hold sensors


def target_walk(
    trial: Trial, study: Study, sensors: Sequence[str], targets: str
) -> tuple[Recording, Strides, list[Finding]]:
    """Sensors of one trial and what is to be reconstructed from them, on the time base of the sensors.

    Sensors are low-passed as kinematics; EMG becomes its envelope; forces are low-passed at 20 Hz, moments as
    kinematics. The centre of pressure and the free moment are no targets: they mean nothing while the foot is in the
    air.

    trial: with kinematics or markers, and the stream of the targets
    returns strides: of the study's side, or of the one whose contacts are found
    """
    refuse_unknown_targets(targets)
    filters = study.filters
    read = _sensors_of(trial, sensors)
    read = lowpassed(read, filters.kinematics_hz, filters.order, filters.gap_s)
    wanted, findings = _targets_of(trial, study, targets)
    choice = chosen_contacts(trial, study.strides.detector, study.treadmill.direction if study.treadmill else "")
    side = study.strides.side if study.strides.side in choice.contacts else next(iter(choice.contacts))
    strides = cut_strides(choice.contacts[side], None, study.strides.min_s, study.strides.max_s)
    values = interpolated(wanted.time, wanted.values, read.time)
    if not np.isfinite(values).any():
        raise SamplingError(
            f"trial {trial.name}: {targets} and sensors must overlap in time",
            f"sensors last from {read.time[0]:.2f} to {read.time[-1]:.2f} s, "
            f"{targets} from {wanted.time[0]:.2f} to {wanted.time[-1]:.2f} s",
            "Check that the files belong to the same trial and clock.",
        )
    both = replace(
        read,
        values=np.hstack([read.values, values]),
        channels=(*read.channels, *wanted.channels),
        suspect=None,
        subject=trial.subject,
        condition=trial.condition,
    )
    return both, strides, findings


def refuse_unknown_targets(targets: str) -> None:
    """Refuse what cannot be reconstructed."""
    if targets not in (STATES, *TARGETS):
        known = ", ".join((STATES, *TARGETS))
        raise SchemaError("the kind of quantity is unknown", f"{targets!r} does not exist", f"Use: {known}.")


def _sensors_of(trial: Trial, sensors: Sequence[str]) -> Recording:
    for key in SENSED:
        if key in trial.streams and set(sensors) <= set(trial.stream(key).names):
            return trial.stream(key).selected(sensors)
    kinematics = trial.stream(next((key for key in SENSED if key in trial.streams), SENSED[0]))
    return kinematics.selected(sensors)  # refuses, and names the nearest


def _targets_of(trial: Trial, study: Study, targets: str) -> tuple[Recording, list[Finding]]:
    key, quantities = TARGETS[targets]
    found = trial.stream(key).selected_by(lambda channel: channel.quantity in quantities)
    filters = study.filters
    dead: dict[str, Finding] = {}
    if key == "emg" and is_raw(found):
        dead = {finding.channel: finding for finding in emg_findings(found) if finding.severity == "refused"}
        found = found.selected([name for name in found.names if name not in dead])
    if not found.names:
        raise ChannelError(
            f"trial {trial.name} must have {targets}",
            f"none is usable: {', '.join(dead)}" if dead else f"it has no {' or '.join(quantities)}",
            "Exclude the trial, or reconstruct another quantity.",
        )
    findings = [
        Finding("warning", "left out", finding.file, f"{name}: {finding.what}", "this muscle, which is excluded", name)
        for name, finding in dead.items()
    ]
    if key == "emg":
        raw = is_raw(found)
        smooth = enveloped(found, filters.emg_highpass_hz, filters.emg_lowpass_hz, filters.order) if raw else found
        return (smooth if raw else lowpassed(found, filters.emg_lowpass_hz, filters.order, filters.gap_s)), findings
    cutoff_hz = FORCE_HZ if key == "forces" else filters.kinematics_hz
    return lowpassed(found, cutoff_hz, filters.order, filters.gap_s), findings
