"""One joint of a walk as an inverse-dynamics problem: its angle, its net moment, and the EMG of the leg's muscles."""

from collections.abc import Sequence
from dataclasses import dataclass, replace
from typing import Any

import numpy as np
from numpy.typing import NDArray

from gaitdisc.errors import ChannelError, SamplingError, UnitError
from gaitdisc.ingest.study import Study
from gaitdisc.kinematics.marker_set import read_marker_sets
from gaitdisc.kinematics.markers import marker_labels, marker_places, up_axis
from gaitdisc.kinematics.pose import hip_of_spines
from gaitdisc.kinetics.newton_euler import GRAVITY, moment_per_foot_kg
from gaitdisc.processing.contact_choice import choose_contacts
from gaitdisc.processing.process import is_raw, make_envelope
from gaitdisc.recording import Finding, Trial
from gaitdisc.recording.arrays import Values
from gaitdisc.recording.strides import interpolate
from gaitdisc.signals.butterworth import low_pass
from gaitdisc.signals.derivatives import derivative
from gaitdisc.signals.emg import emg_findings
from gaitdisc.signals.strides import cut_strides

# landmark of a joint; the hip after Harrington where the pelvis shows
JOINT_AT = {"ankle_angle": "ankle_lateral", "knee_angle": "knee_lateral", "hip_flexion": "asis"}
LEAST_DEG, PERCENTILES = 2.0, (5, 95)
MOMENT_HZ = 20.0  # the moment keeps what the forces' own filter left of it
ANGLE_HZ = 12.0  # a muscle's force needs the speed of push-off, which the usual low-pass of angles blunts


@dataclass(frozen=True, eq=False)
class JointRecord:
    """One joint of one walk, sample by sample on the time base of the angles."""

    joint: str
    side: str
    subject: str
    condition: str
    time: Values
    seen: Values  # (sample,), angle as recorded [rad]
    angle: Values  # (sample,), low-passed angle [rad]
    rate: Values  # (sample,), its derivative [rad/s]
    speedup: Values  # (sample,), its second derivative [rad/s2]
    # (sample,), internal net moment towards the positive angle [N m]; NaN where the load of the foot is unknown
    moment: Values
    envelopes: Values  # (sample, muscle), EMG of the joint's side [the file's unit]
    muscles: tuple[str, ...]
    phase: Values  # (sample,), share of the stride; NaN outside of strides
    stride: NDArray[np.intp]  # (sample,), number of the stride, -1 outside
    # (sample,), what each kg more at the foot adds to the net moment [N m/kg]; empty where no marker shows it
    per_kg: Values
    findings: tuple[Finding, ...] = ()


def joint_record(trial: Trial, study: Study, joint: str, mass_kg: float | None) -> JointRecord:
    """Return one joint (`ankle_angle`): low-passed angles, EMG envelopes, moments in N m by the mass, on one side."""
    side, filters = study.strides.side, study.filters
    name = f"{joint}_{side}"
    raw = trial.stream("kinematics").selected([name])
    moved = float(np.ptp(np.nanpercentile(raw.values[:, 0], PERCENTILES)))
    if moved < LEAST_DEG:
        raise UnitError(
            f"a joint angle of a walk must vary by more than {LEAST_DEG:g} deg",
            f"{trial.name}: {name} varies by {moved:.2g} deg, as if it were in radians and labelled as degrees",
            "State the file's unit (inDegrees=no), or choose a joint that is not locked.",
        )
    smooth = low_pass(raw, max(ANGLE_HZ, filters.kinematics_hz), filters.order, filters.gap_s)
    rate, speedup = (np.radians(derivative(smooth.values, smooth.rate_hz, order)[:, 0]) for order in (1, 2))
    moment = _moment(trial, name, mass_kg, raw.time)
    envelopes, muscles, dead = _envelopes(trial, study, side, raw.time)
    weight = None if mass_kg is None else mass_kg * GRAVITY
    choice = choose_contacts(trial, study.strides.detector, study.walking_direction, weight)
    strides = cut_strides(choice.contacts[side], raw, study.strides.min_s, study.strides.max_s)
    return JointRecord(
        joint,
        side,
        trial.subject,
        condition=trial.condition,
        time=raw.time,
        seen=np.radians(raw.values[:, 0]),
        angle=np.radians(smooth.values[:, 0]),
        rate=rate,
        speedup=speedup,
        moment=moment,
        envelopes=envelopes,
        muscles=muscles,
        phase=strides.phi(raw.time) / 100.0,
        stride=strides.number(raw.time),
        per_kg=_per_kg(trial, study, joint, raw.time),
        findings=(*trial.findings, *choice.findings, *dead),
    )


def join_trials(records: Sequence[JointRecord]) -> JointRecord:
    """Return short trials of a joint as one record: strides are numbered on, a sample outside of strides lies between.

    Muscles are those of every trial; the clock goes on from trial to trial.
    """
    first, *others = records
    if not others:
        return first
    rates = [1 / float(np.median(np.diff(record.time))) for record in records]
    if not np.allclose(rates, rates[0], rtol=1e-3):
        raise SamplingError(
            f"trials of {first.condition} that are taken together must have one rate of the angles",
            f"{first.subject} has {' and '.join(f'{rate:.4g} Hz' for rate in (min(rates), max(rates)))}",
            "Export all trials at one rate.",
        )
    muscles = tuple(name for name in first.muscles if all(name in record.muscles for record in others))
    alike = [
        replace(record, envelopes=record.envelopes[:, [record.muscles.index(name) for name in muscles]])
        for record in records
    ]

    def joined(name: str, between: float = np.nan) -> NDArray[Any]:
        parts = [getattr(record, name) for record in alike]
        return np.concatenate([np.concatenate([part, np.full_like(part[:1], between)]) for part in parts])[:-1]

    stride = joined("stride", -1)
    begins = np.flatnonzero(np.diff(stride, prepend=-1) * (stride >= 0))
    signals = ("seen", "angle", "rate", "speedup", "moment", "envelopes", "phase")
    return replace(
        first,
        time=np.arange(len(stride)) / rates[0],
        **{name: joined(name) for name in signals},
        stride=np.where(stride < 0, -1, np.searchsorted(begins, np.arange(len(stride)), "right") - 1),
        muscles=muscles,
        per_kg=joined("per_kg") if all(record.per_kg.size for record in records) else np.empty(0),
        findings=tuple(dict.fromkeys(finding for record in records for finding in record.findings)),
    )


def _moment(trial: Trial, name: str, mass_kg: float | None, time: Values) -> Values:
    """Moment of a joint in N m on a time base."""
    recording = trial.stream("moments").selected([f"{name}_moment"])
    unit = recording.channels[0].unit
    if unit == "N m/kg" and mass_kg is None:
        raise UnitError(
            "to convert moments to N m, the person's body mass [kg] must be stated",
            f"{trial.name} has {name}_moment in N m/kg, but no mass is stated",
            "Write mass_kg of the participant in the study file.",
        )
    factor = mass_kg if unit == "N m/kg" and mass_kg is not None else 1.0
    smooth = low_pass(recording, MOMENT_HZ) if recording.rate_hz > 3 * MOMENT_HZ else recording
    values = interpolate(recording.time, smooth.values, time)
    return values[:, 0] * factor


def _per_kg(trial: Trial, study: Study, joint: str, time: Values) -> Values:
    """What each kg more at the foot adds to the joint's moment; empty where no marker shows it."""
    if "markers" not in trial.streams:
        return np.empty(0)
    markers, side, labels = trial.stream("markers"), study.strides.side, marker_labels(trial.stream("markers"))
    known = max(read_marker_sets().values(), key=lambda marker_set: len(marker_set.names(labels)))
    label_of, smooth = known.names(labels), low_pass(markers, ANGLE_HZ, study.filters.order, study.filters.gap_s)
    points = {
        (key, on): marker_places(smooth, [label_of[name] for name in names]).mean(axis=1)
        for on in "lr"
        for key in ("heel", "toe", "ankle_lateral", "knee_lateral", "asis", "sacrum")
        if (names := known.landmark(key, on, label_of))
    }
    left, right, sacrum = (points.get(landmark) for landmark in (("asis", "l"), ("asis", "r"), ("sacrum", side)))
    if joint == "hip_flexion" and left is not None and right is not None and sacrum is not None:
        points[JOINT_AT[joint], side] = hip_of_spines(left, right, sacrum, side)
    if not all((key, side) in points for key in (JOINT_AT[joint], "heel", "toe")):
        return np.empty(0)
    centre, heel, toe = (points[key, side] for key in (JOINT_AT[joint], "heel", "toe"))
    feet = np.mean([points[key, on] for key in ("heel", "toe") for on in "lr" if (key, on) in points], axis=0)
    tops = (points[key, side] for key in ("asis", "sacrum", "knee_lateral") if (key, side) in points)
    up = up_axis(next(tops, np.nanmean(marker_places(markers, labels), axis=1)), feet)
    moment = moment_per_foot_kg(centre, heel, toe, up, markers.rate_hz)
    return interpolate(markers.time, (-moment if joint == "knee_angle" else moment)[:, None], time)[:, 0]


def _envelopes(trial: Trial, study: Study, side: str, time: Values) -> tuple[Values, tuple[str, ...], list[Finding]]:
    """Envelopes of the side's living muscles on a time base."""
    emg = trial.stream("emg").selected_by(lambda channel: channel.quantity == "emg" and channel.side == side)
    dead = [finding for finding in emg_findings(emg) if finding.severity == "refused"] if is_raw(emg) else []
    lost = {finding.channel for finding in dead}
    emg = emg.selected([name for name in emg.names if name not in lost])
    if not emg.names:
        raise ChannelError(
            f"for a moment model driven by EMG, EMG of side {side!r} must be usable",
            f"{trial.name} has {'only dead channels: ' + ', '.join(sorted(lost)) if lost else 'no EMG of this side'}",
            "Name the muscles in [channels], or set side in [strides] to the leg with electrodes.",
        )
    smooth = [make_envelope(emg.selected([name]), study.filters) for name in emg.names]
    values = np.hstack([interpolate(envelope.time, envelope.values, time) for envelope in smooth])
    left_out = [replace(finding, severity="warning", spoils="this muscle, which is excluded") for finding in dead]
    return np.maximum(values, 0.0), emg.names, left_out
