"""Process a trial to a walk: check, filter, cut into strides, differentiate; the walks of a participant."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field, replace
from operator import itemgetter

import numpy as np
import pandas as pd

from gaitdisc.channel import Channel, nearest_word
from gaitdisc.errors import ChannelError, SamplingError, StrideError
from gaitdisc.ingest.study import Filters, Participant, PlannedTrial, Study
from gaitdisc.processing.contact_choice import choose_contacts
from gaitdisc.processing.pooled_cycles import STRIDE_COLUMNS, WalkSummary
from gaitdisc.processing.side_checks import side_findings
from gaitdisc.processing.standing import Read, Standing, find_standing
from gaitdisc.processing.two_sources import KIND as CONTRADICTED
from gaitdisc.recording import PERCENT, Finding, Recording, Strides, Trajectory, Trial
from gaitdisc.recording.arrays import Span, Values
from gaitdisc.recording.recording import join_recordings
from gaitdisc.recording.strides import interpolate
from gaitdisc.recording.trial import resample
from gaitdisc.signals.butterworth import low_pass, short_run_findings
from gaitdisc.signals.channel_quality import channel_findings, drift_findings, plateau_findings, plateau_marked
from gaitdisc.signals.contacts import order_findings
from gaitdisc.signals.derivatives import derivative, trajectory
from gaitdisc.signals.emg import emg_findings, envelopes
from gaitdisc.signals.gaps import fill_gaps, spike_findings, without_spikes
from gaitdisc.signals.sides import verify_sides
from gaitdisc.signals.stride_quality import late_change_findings
from gaitdisc.signals.stride_quality import stride_findings as outlier_findings
from gaitdisc.signals.strides import cut_strides, verify_walking
from gaitdisc.statistics.r2 import simulate_null


@dataclass(frozen=True, eq=False)
class Walk:
    """One processed trial."""

    trial: Trial
    # filtered joint angles, and EMG envelopes where the study requests them, on the time base of the kinematics
    state: Recording
    strides: Mapping[str, Strides]
    trajectory: Trajectory  # state, derivatives and percent stride of the study's side
    findings: tuple[Finding, ...]  # of the reader, of the quality checks, and of the stride detectors
    side: str  # side whose strides the percent stride of the trajectory follows

    def summary(self) -> WalkSummary:
        """What is kept of the walk: curves of every stride of the study's side, strides, findings, file hashes."""
        return walk_summary(self.trial, [self.state], self.strides, self.side, self.findings)


def walk_summary(
    trial: Trial, states: Sequence[Recording], strides: Mapping[str, Strides], follow: str, findings: Sequence[Finding]
) -> WalkSummary:
    """What is kept of a walk; channels of the other side are cut by the strides of their own foot, as the first are."""
    lead = [*states, *trial.streams.values()][0]
    rows = []
    for side, cut in sorted(strides.items()):
        kept = [(side, start, end, True, "") for start, end in zip(cut.start, cut.end, strict=True)]
        dropped = [(side, stride.start, stride.end, False, stride.reason) for stride in cut.dropped]
        rows += sorted([*kept, *dropped], key=itemgetter(1))
    return WalkSummary(
        trial.subject,
        trial.condition,
        lead.duration_s,
        rate_hz=lead.rate_hz,
        detector=strides[follow].detector,
        channels=tuple(channel for state in states for channel in state.channels),
        curves=stride_curves(states, strides, follow),
        strides=pd.DataFrame(rows, columns=pd.Index(STRIDE_COLUMNS)),
        findings=tuple(findings),
        files={r.source.file: r.source.sha256 for r in trial.streams.values() if r.source.sha256},
    )


def stride_curves(states: Sequence[Recording], strides: Mapping[str, Strides], follow: str) -> Values:
    """Strides (stride, phase, channel) by the own foot's contacts, else the followed foot's; NaN behind the fewer."""
    columns: list[Values] = []
    for state in states:
        feet = [channel.side if channel.side in strides else follow for channel in state.channels]
        by_side = {side: strides[side].normalised(state) for side in set(feet)}
        columns += [by_side[side][:, :, column] for column, side in enumerate(feet)]
    curves = np.full((max(map(len, columns), default=0), len(PERCENT), len(columns)), np.nan)
    for column, values in enumerate(columns):
        curves[: len(values), :, column] = values
    return curves


TEMPLATE_TIMES = 2.0  # the mean stride bridges gaps twice as long as the spline does (docs/derivatives.md)
SHARE_OF_RATE = 0.4  # cut-off of the low-pass before resampling; half the rate is the limit
NOISE_S, NOISE_WALKS = 30.0, 20  # of noise without any gait


def processed(trial: Trial, study: Study, body_weight_n: float | None = None) -> Walk:
    """Process one trial of a study.

    Gaps up to the study's `gap_s` are bridged by a cubic spline, up to twice that by the person's mean stride, beyond
    that left open and their strides dropped; plateaus, bridged gaps and filter edges are marked suspect.
    """
    raw = without_spikes(plateau_marked(_require(trial, "kinematics", study.models.angles)))
    choice = choose_contacts(trial, study.strides.detector, study.walking_direction, body_weight_n)
    limits = (study.strides.min_s, study.strides.max_s)
    side = study.strides.side
    if side not in choice.contacts:
        raise StrideError(
            f"for percent stride of side {side!r}, contacts of this side must be found",
            f"{trial.name}: {choice.detector} finds contacts of side {', '.join(choice.contacts)} only",
            "Change side in [strides].",
        )
    gap_s = study.filters.gap_s
    raw = fill_gaps(raw, cut_strides(choice.contacts[side], None, *limits), gap_s, TEMPLATE_TIMES * gap_s)
    strides = {side: cut_strides(contacts, raw, *limits) for side, contacts in sorted(choice.contacts.items())}
    findings = [*trial.findings, *quality_findings(trial, study.models.angles, study.models.emg), *choice.findings]
    if set(choice.contacts) == {"r", "l"}:
        findings += order_findings(choice.contacts["r"], choice.contacts["l"], trial.name)
    verify_walking(knees_and_hips(trial), strides[side], study.quality.min_strides)
    verify_sides(knees_and_hips(trial), strides[side])
    state = _state(trial, raw, study)
    findings += short_run_findings(raw, study.filters.kinematics_hz, study.filters.order, study.filters.gap_s)
    findings += stride_findings(state, strides[side]) + side_findings(trial, strides)
    late = next((f for f in findings if f.kind == "late change" and f.severity == "warning"), None)
    if late is not None and study.quality.late_change == "refuse":
        raise StrideError(
            f"trial {trial.name}: the gait must not change towards the end, which is held out to test the models",
            late.what,
            'Crop the trial, or set late_change = "report" in [quality] to use it nevertheless.',
        )
    return Walk(trial, state, strides, trajectory(state, strides[side]), tuple(findings), side)


def quality_findings(trial: Trial, angles: Sequence[str] = (), emg: Sequence[str] = ()) -> list[Finding]:
    """What the quality checks see in the raw streams of a trial."""
    findings: list[Finding] = []
    if "kinematics" in trial.streams:
        kinematics = trial.stream("kinematics")
        looked_at = kinematics.selected([name for name in kinematics.names if not angles or name in angles])
        findings += channel_findings(looked_at) + plateau_findings(looked_at) + spike_findings(looked_at)
    if "emg" in trial.streams:
        recorded = trial.stream("emg")
        looked_at = recorded.selected([name for name in recorded.names if not emg or name in emg])
        findings += channel_findings(looked_at)
        findings += emg_findings(looked_at) if is_raw(recorded) else []
    if "forces" in trial.streams:
        forces = trial.stream("forces").selected_by(lambda channel: channel.quantity == "vertical_force")
        findings += channel_findings(forces) + drift_findings(forces)
    if "markers" in trial.streams and not angles:
        findings += channel_findings(trial.stream("markers")) + spike_findings(trial.stream("markers"))
    return findings


def stride_findings(state: Recording, strides: Strides) -> list[Finding]:
    """What the strides say: outliers against the person's own mean, a change late in the trial, and those dropped."""
    angles = state.selected_by(lambda channel: channel.quantity == "angle")
    findings = outlier_findings(angles, strides) + late_change_findings(angles, strides)
    for dropped in strides.dropped:
        what = f"stride of side {strides.side}: {dropped.reason}"
        spans = (Span(dropped.start, dropped.end),)
        findings.append(Finding("note", "stride dropped", state.source.file, what, "this stride", spans=spans))
    return findings


def _require(trial: Trial, key: str, names: Sequence[str]) -> Recording:
    recording = trial.stream(key)
    missing = [name for name in names if name not in recording.names]
    if missing:
        nearest = nearest_word(missing[0], recording.names)
        excluded = "".join(f"; excluded: {finding.what}" for finding in trial.findings if finding.kind == CONTRADICTED)
        raise ChannelError(
            "the channels named in [models] must be in the trial",
            f"{recording.source.file or trial.name} has {len(recording.names)} channels, but not {', '.join(missing)}"
            + (excluded or (f"; the nearest is {nearest!r}" if nearest else "")),
            ("Correct the file" if excluded else "Map the file's own label in [channels]")
            + ", or remove the name from [models].",
        )
    return recording.selected(names)


def knees_and_hips(trial: Trial) -> Recording:
    """Sagittal angles of both knees and hips, those that there are."""
    wanted = {f"{joint}_{side}" for joint in ("hip_flexion", "knee_angle") for side in "rl"}
    return trial.stream("kinematics").selected_by(lambda channel: channel.name in wanted)


def _state(trial: Trial, raw: Recording, study: Study) -> Recording:
    """Filtered angles and envelopes on the time base of the kinematics."""
    filters = study.filters
    angles = low_pass(raw, filters.kinematics_hz, filters.order, filters.gap_s)
    if not study.models.emg:
        return replace(angles, subject=trial.subject, condition=trial.condition)
    emg = _require(trial, "emg", study.models.emg)
    dead = [finding for finding in emg_findings(emg) if finding.severity == "refused"] if is_raw(emg) else []
    if dead:
        raise ChannelError(
            f"EMG of {', '.join(f.channel for f in dead)} must be usable for the models",
            f"{emg.source.file or trial.name}: " + "; ".join(f"{f.channel} is {f.kind}: {f.what}" for f in dead),
            "Remove the muscle from [models], or remove the trial.",
        )
    envelope = resample(make_envelope(emg, filters), angles.time)
    known = np.isfinite(envelope.values)
    if not known.any():
        raise SamplingError(
            f"trial {trial.name}: EMG and kinematics must overlap in time",
            f"kinematics last from {angles.time[0]:.2f} to {angles.time[-1]:.2f} s, "
            f"EMG from {emg.time[0]:.2f} to {emg.time[-1]:.2f} s",
            "Check that the files belong to the same trial and clock.",
        )
    state = join_recordings(angles, envelope.with_values(envelope.values, ~known))
    return replace(state, subject=trial.subject, condition=trial.condition)


def make_envelope(emg: Recording, filters: Filters, raw: bool | None = None) -> Recording:
    """Envelope of raw EMG; what is one is low-passed alone. Whether it is raw is seen where `raw` is not given."""
    if is_raw(emg) if raw is None else raw:
        return envelopes(emg, filters.emg_highpass_hz, filters.emg_lowpass_hz, filters.order)
    return low_pass(emg, filters.emg_lowpass_hz, filters.order, filters.gap_s)


def is_raw(emg: Recording) -> bool:
    """Distinguish raw EMG, which swings about zero, from an envelope, which does not fall below it."""
    known = emg.values[np.isfinite(emg.values)]
    return len(known) > 0 and bool(np.min(known) < 0)


def filter_null(
    channels: Sequence[Channel], filters: Filters, kinematics_hz: float, emg_hz: float | None = None
) -> dict[str, float]:
    """R2 of x'' regressed on x and x' in noise that passed through the same filters as each channel.

    kinematics_hz: rate at which angles were measured and everything is differentiated
    emg_hz: rate of the raw EMG; None where the recording holds envelopes, which are low-passed only
    returns: channel name to R2, about 0.5 for every low-pass
    Source: A flat band has m2^2 / (m0 m4) = 5/9; see `gaitdisc.statistics.r2`.

    >>> knee = Channel("knee_angle_r", "angle", "deg", "r")
    >>> round(filter_null([knee], Filters(), 100.0)["knee_angle_r"], 1)
    0.5
    """
    rate_hz = emg_hz or kinematics_hz

    def angles(noise: Values) -> tuple[Values, Values, Values]:
        smooth = low_pass(_recording(noise, kinematics_hz, "deg"), filters.kinematics_hz, filters.order)
        return _differentiate(smooth.values, kinematics_hz)

    def emg(noise: Values) -> tuple[Values, Values, Values]:
        smooth = make_envelope(_recording(noise, rate_hz, "V"), filters, emg_hz is not None)
        time = np.arange(round(len(noise) / rate_hz * kinematics_hz)) / kinematics_hz
        return _differentiate(interpolate(smooth.time, smooth.values, time[:-1]), kinematics_hz)

    reached = {"angle": simulate_null(angles, round(NOISE_S * kinematics_hz), NOISE_WALKS)}
    if any(channel.quantity == "emg" for channel in channels):
        reached["emg"] = simulate_null(emg, round(NOISE_S * rate_hz), NOISE_WALKS)
    return {channel.name: reached["emg" if channel.quantity == "emg" else "angle"] for channel in channels}


def make_filter_null(walk: Walk, filters: Filters) -> dict[str, float]:
    """R2 that noise reaches through the filters of one walk at its own rates; whether EMG is raw is seen from it."""
    emg = walk.trial.streams.get("emg")
    emg_hz = emg.rate_hz if emg is not None and is_raw(emg) else None
    return filter_null(walk.state.channels, filters, walk.state.rate_hz, emg_hz)


def _differentiate(values: Values, rate_hz: float) -> tuple[Values, Values, Values]:
    derivatives = (values, derivative(values, rate_hz, 1), derivative(values, rate_hz, 2))
    known = np.isfinite(np.hstack(derivatives)).all(axis=1)
    x, xdot, xddot = (order[known] for order in derivatives)
    return x, xdot, xddot


def _recording(noise: Values, rate_hz: float, unit: str) -> Recording:
    quantity = "emg" if unit == "V" else "angle"
    channels = tuple(Channel(f"noise_{k}", quantity, unit) for k in range(noise.shape[1]))
    return Recording(np.arange(len(noise)) / rate_hz, noise, channels)


def find_raw_emg(trial: Trial, states: Sequence[Recording]) -> Recording | None:
    """Raw EMG of a trial, of the channels whose envelopes cycles are cut of; None where the file has envelopes."""
    if "emg" not in trial.streams or not is_raw(trial.stream("emg")):
        return None
    raw = trial.stream("emg")
    names = [name for state in states for name in state.names if name in raw.names]
    return raw.selected(names) if names else None


def on_one_base(trial: Trial, rate_hz: float, keys: tuple[str, ...] | None = None) -> Recording:
    """Bring streams to one time base without folding what is faster into what is slower.

    A stream that is faster than `rate_hz` is low-passed at 0.4 times that rate; raw EMG becomes its envelope (40 Hz
    high-pass, rectified, 10 Hz low-pass), since nothing of the raw signal would be left.

    returns: the span that all streams cover; filter edges and bridged gaps are marked suspect

    >>> from gaitdisc.cohort.cohort import the_twelve, make_walks
    >>> on_one_base(make_walks(the_twelve()[0], 5.0).trials["nominal"], 100.0).rate_hz
    100.0
    """
    ready = {key: trial.stream(key) for key in (keys or tuple(trial.streams))}
    for key, recording in ready.items():
        if recording.rate_hz > rate_hz * (1 + 1e-6):
            raw = key == "emg" and is_raw(recording)
            slow = SHARE_OF_RATE * rate_hz
            ready[key] = envelopes(recording) if raw else low_pass(without_spikes(recording), slow)
    return Trial(trial.name, ready, trial.events, (), trial.subject, trial.condition).on_one_base(rate_hz)


@dataclass(frozen=True, eq=False)
class ReadWalk:
    """A trial before it is filtered."""

    trial: Trial  # with the angles that its study requests, and moments where they could be computed
    body_weight_n: float | None = None  # of the person [N]; None where neither the study nor a file states a mass
    # why no angles were computed of the trial's markers; empty where it has angles, or no markers
    without_angles: str = ""

    def processed(self, study: Study) -> Walk:
        """Filtered walk, cut into strides, under the settings of a study."""
        if self.without_angles:
            raise ChannelError(
                "for the models, joint angles must be in the files or computed from markers and a static trial",
                f"{self.trial.name} has markers but no angles: {self.without_angles}",
                'Add the standing trial with condition = "static", or the file with the angles.',
            )
        return processed(self.trial, study, self.body_weight_n)


@dataclass(eq=False)
class StudyWalks:
    """The walks of one participant; the static trial of a session is read once, at its first walk."""

    study: Study
    participant: Participant
    read: Read
    _standing: dict[str, Standing] = field(default_factory=dict, init=False)

    def read_walk(self, planned: PlannedTrial) -> ReadWalk:
        """Trial of the study, with angles and moments from its markers where the study requests them."""
        trial = self.read(planned)
        session = planned.session or ""
        if session not in self._standing:
            self._standing[session] = find_standing(self.study, self.participant, session, self.read)
        standing = self._standing[session]
        computed = standing.computed(planned, trial).trial
        findings = standing.findings(computed, "kinematics" in computed.streams)
        ready = replace(computed, findings=(*computed.findings, *findings))
        why = ""
        if "kinematics" not in ready.streams and "markers" in ready.streams:
            why = next((finding.what for finding in ready.findings if finding.kind == "no angles"), standing.unread)
            if self.study.kinematics and self.study.kinematics.angles == "file":
                why = 'the study selects the angles of the file (angles = "file" in [kinematics])'
        return ReadWalk(ready, standing.body_weight_n(planned), why)
