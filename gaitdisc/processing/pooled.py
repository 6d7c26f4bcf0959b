"""Cycles of one participant pooled over trials: read, cut, corrected, checked and counted together."""

import hashlib
import tempfile
from collections import Counter
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from pathlib import Path

import numpy as np
import pandas as pd

from gaitdisc.channel import Channel, other_side, vocabulary
from gaitdisc.errors import GaitdiscError, StrideError
from gaitdisc.ingest.study import Participant, PlannedTrial, Study
from gaitdisc.ingest.trial_sets import TrialSet, trial_sets
from gaitdisc.kinematics.exchanged_labels import UNFIT
from gaitdisc.kinetics.plate_steps import PlateStep
from gaitdisc.processing.contact_choice import SEEN_LATE, offset_finding
from gaitdisc.processing.pooled_cycles import CYCLE_COLUMNS, PooledCycles, choose_typical
from gaitdisc.processing.process import find_raw_emg, knees_and_hips, quality_findings
from gaitdisc.processing.side_checks import side_findings
from gaitdisc.processing.standing import Read, Standing, find_standing
from gaitdisc.processing.step_events import StepEvents, over_ground, step_events, walking_part
from gaitdisc.processing.trial_cycles import (
    HeelPaths,
    Loadings,
    Places,
    cut_cycles,
    cycle_channels,
    find_places,
    heel_paths,
    is_kinetic,
    plate_loadings,
    with_gaps,
    without_stated,
)
from gaitdisc.recording import PERCENT, Cycle, Finding, Recording, Strides, Trial
from gaitdisc.recording.arrays import Values
from gaitdisc.saved.provenance import Refusal
from gaitdisc.signals.contacts import find_rise
from gaitdisc.signals.sides import verify_sides
from gaitdisc.signals.strides import LEAST_COVERAGE, duration_reasons, verify_walking

SAMPLES = ("gap", "jump")  # kinds of findings about samples alone
DOUBTED = ("plate step", "swapped plates")  # findings whose spans no kinetics are shown of
KINETIC = ("moment", "power", "force", "vertical_force")  # quantities that need a plate under the foot
# kind of event and detector -> how much later the ground places each that both see [s], of all trials of a session
Later = Mapping[tuple[str, str], Values]


@dataclass(frozen=True, eq=False)
class Shelved:
    """A recording that is needed later, on disk or, where that has no room, in memory."""

    kept: Recording  # with its samples, or with one sample where these are on disk
    file: Path | None = None  # where the samples lie

    def recording(self) -> Recording:
        """Return the recording with its samples."""
        if self.file is None:
            return self.kept
        with np.load(self.file, allow_pickle=False) as held:
            return replace(self.kept, **{name: held[name] for name in ("time", "values", "suspect")})


def put_away(recording: Recording, folder: Path) -> Shelved:
    """Put the samples of a recording into a file of a folder."""
    samples = {name: getattr(recording, name) for name in ("time", "values", "suspect")}
    try:
        with tempfile.NamedTemporaryFile(suffix=".npz", dir=folder, delete=False) as file:
            np.savez(file, **samples)
    except OSError:  # no room on disk
        return Shelved(recording)
    first = {name: values[:1].copy() for name, values in samples.items()}
    return Shelved(replace(recording, **first), Path(file.name))


@dataclass(frozen=True, eq=False)
class _Pooled:
    """A trial that is pooled: what is kept of it, and its cycles once they are cut."""

    planned: PlannedTrial
    number: int
    steps: StepEvents
    over_ground: bool
    plates: Loadings
    feet: HeelPaths | None
    legs: Recording | None
    states: tuple[Shelved, ...]
    findings: tuple[Finding, ...]
    files: dict[str, str]
    raw_emg: Shelved | None
    plate_steps: tuple[PlateStep, ...] | None = None  # where moments were computed from markers
    cycles: Sequence[Cycle] = ()
    places: Sequence[Places] = ()  # of the feet, one a cycle
    unknown: Sequence[Finding] = ()  # cycles that the study leaves out and that are not there

    @property
    def kept(self) -> list[Cycle]:
        """Cycles that nothing speaks against."""
        return [cycle for cycle in self.cycles if not cycle.reason]

    @property
    def shown_findings(self) -> list[Finding]:
        """Findings of the trial; a person who enters or leaves the measured volume spoils no kept cycle."""
        outside = "nothing: before the first kept cycle of the leg or after its last"
        return [
            replace(finding, severity="note", spoils=outside) if self._spoils_none(finding) else finding
            for finding in self.findings
        ]

    def _spoils_none(self, finding: Finding) -> bool:
        known = vocabulary().by_name.get(finding.channel)
        if not self.over_ground or finding.kind not in SAMPLES or known is None or not finding.spans:
            return False
        cycles = [cycle for cycle in self.kept if known.side in ("", cycle.side)]
        first = min((cycle.start for cycle in cycles), default=0.0)
        last = max((cycle.end for cycle in cycles), default=np.inf)
        return all(span.end <= first or span.start >= last for span in finding.spans)


def pool_cycles(study: Study, participant: Participant, read: Read) -> tuple[PooledCycles, ...]:
    """Cycles of a participant by session and condition, pooled over trials.

    A trial that cannot be read or used is left out with its reason, the others go on. Where a plate or an event of the
    file sees a step that markers or angles see too, these are moved by the median difference of all such steps of the
    participant's session. Those without a kept cycle say why in `refusals`.
    """
    sets = trial_sets(study, participant)
    pooled: list[PooledCycles] = []
    prints: dict[str, PlannedTrial] = {}  # of the samples of each trial that was read
    for session in dict.fromkeys(trials.session for trials in sets):
        standing = find_standing(study, participant, session, read)
        of_session = [trials for trials in sets if trials.session == session]
        with tempfile.TemporaryDirectory(prefix="gaitdisc_", ignore_cleanup_errors=True) as folder:
            ready = [(trials, *_read_trials(standing, trials, read, Path(folder), prints)) for trials in of_session]
            times: dict[tuple[str, str], list[Values]] = {}
            for trial in (trial for _, seen, _ in ready for trial in seen):
                for kind, detector in (("contacts", trial.steps.detector), ("foot_offs", trial.steps.off_detector)):
                    times.setdefault((kind, detector), []).append(trial.steps.later_s(kind))
            later = {key: np.concatenate(delays) for key, delays in times.items()}
            pooled += [_pool(standing, trials, seen, lost, later) for trials, seen, lost in ready]
    return tuple(pooled)


def _read_trials(
    standing: Standing, trials: TrialSet, read: Read, folder: Path, prints: dict[str, PlannedTrial]
) -> tuple[list[_Pooled], list[Refusal]]:
    """What each trial of a set shows, and why others are lost."""
    participant = standing.participant
    seen, lost = [], []
    for number, planned in enumerate(trials.trials, 1):
        try:
            trial = read(planned)
            digest = hashlib.sha256()  # equal for two files of one recording, whatever their headers and formats
            for key in sorted(trial.streams):
                digest.update(trial.stream(key).values.tobytes())
            twin = prints.setdefault(digest.hexdigest(), planned)
            if twin is not planned:
                raise StrideError(
                    "a recording must belong to only one session and condition",
                    f"its samples are identical to those of {participant.trial_name(twin)}",
                    "Remove one of the two trials.",
                )
            seen.append(_show_trial(standing, planned, number, trial, folder))
        except GaitdiscError as error:
            where = participant.trial_name(planned).removeprefix(participant.id).strip()
            lost.append(Refusal(participant.id, where, str(error)))
    return seen, lost


def _show_trial(standing: Standing, planned: PlannedTrial, number: int, read: Trial, folder: Path) -> _Pooled:
    """What a trial shows; its samples are not kept but for those that cycles are cut of, and these on disk."""
    study = standing.study
    computed = standing.computed(planned, walking_part(read))
    trial, plate_steps = computed.trial, computed.steps
    weight_n = standing.body_weight_n(planned)
    steps = step_events(trial, study.strides.detector, study.walking_direction, weight_n)
    outside = study.strides.ground == "overground" or (study.strides.ground == "auto" and over_ground(trial))
    legs, states, lost = cycle_channels(trial, study.filters, computed.from_markers)
    strides = {}  # between the contacts as they were seen, without what is too short, too long, or is two
    for side, times in steps.contacts.items():
        lengths = np.diff(times)
        plausible = (lengths >= study.strides.min_s) & (lengths <= study.strides.max_s)
        plausible &= np.diff(np.searchsorted(steps.contacts.get(other_side(side), ()), times)) <= 1
        if plausible.any():
            strides[side] = Strides(times[:-1][plausible], times[1:][plausible], side, steps.detector)
    _verify(trial, strides, outside)
    sides = side_findings(trial, strides, standing.weighed_n or weight_n)
    if plate_steps is not None:  # whose findings say so already
        sides = [finding for finding in sides if finding.kind != "plate step"]
    known = {}
    for key in {"kinematics", "emg", "forces"} & set(trial.streams):  # channels of the vocabulary are looked at
        names = [name for name in trial.stream(key).names if key == "forces" or name in vocabulary().by_name]
        known |= {key: trial.stream(key).selected(names)} if names else {}
    quality = quality_findings(replace(trial, streams=known))
    findings = (*trial.findings, *steps.findings, *quality, *sides, *lost)
    findings += standing.findings(trial, legs is not None)
    files = {s.source.file: s.source.sha256 for s in trial.streams.values() if s.source.sha256}
    plates = plate_loadings(trial, find_rise(weight_n))
    exchanged = any(finding.kind == "exchanged heels" for finding in steps.findings)
    feet = None if exchanged else heel_paths(trial, study.walking_direction)
    shelved = tuple(put_away(state, folder) for state in states)
    raw_emg = put_away(raw, folder) if (raw := find_raw_emg(trial, states)) is not None else None
    return _Pooled(planned, number, steps, outside, plates, feet, legs, shelved, findings, files, raw_emg, plate_steps)


def _verify(trial: Trial, strides_of: Mapping[str, Strides], outside: bool) -> None:
    """Refuse swapped sides; on a treadmill, and where angles alone show the steps, what is no walking."""
    if "kinematics" not in trial.streams:
        return
    legs = knees_and_hips(trial)
    for side, strides in strides_of.items():
        if not outside or strides.detector == "angles":
            verify_walking(legs, strides, 1, LEAST_COVERAGE if strides.detector == "angles" and not outside else 0.0)
        if f"knee_angle_{side}" in legs.names:
            verify_sides(legs, strides)


def _offset_s(later: Later, kind: str, detector: str) -> float | None:
    times = later.get((kind, detector), ())
    return float(np.median(times)) if len(times) else None


def _pool(
    standing: Standing, trials: TrialSet, seen: Sequence[_Pooled], lost: Sequence[Refusal], later: Later
) -> PooledCycles:
    study, participant = standing.study, standing.participant
    cut = [_cut(standing, trial, later) for trial in seen]
    # durations are checked over all trials together
    durations = np.array([cycle.duration_s for trial in cut for cycle in trial.cycles])
    reasons = iter(duration_reasons(durations, study.strides.min_s, study.strides.max_s))
    cut = [
        replace(trial, cycles=[replace(cycle, reason=next(reasons) or cycle.reason) for cycle in trial.cycles])
        for trial in cut
    ]
    outside = bool(seen) and all(trial.over_ground for trial in seen)
    too_few = _too_few(standing, trials, cut, outside)
    rows = [
        _row(trial.number, cycle, place, too_few)
        for trial in cut
        for cycle, place in zip(trial.cycles, trial.places, strict=True)
    ]
    channels, curves = ((), np.empty((0, len(PERCENT), 0))) if too_few else _curves(cut)
    late = next((trial.steps.detector for trial in seen if trial.steps.detector in SEEN_LATE), "")
    off_late = next((trial.steps.off_detector for trial in seen), "")
    offset_s, steps = _offset_s(later, "contacts", late), len(later.get(("contacts", late), ()))
    findings = [finding for trial in cut for finding in trial.shown_findings]
    findings += [finding for trial in cut for finding in trial.unknown]
    if late:
        by = "the difference at one step" if steps == 1 else f"the median difference at {steps} steps"
        by += " recorded by a plate or marked by an event"
        findings.append(offset_finding(trials.where, late, offset_s, by, "phase and stance by 3 to 5 % of the cycle"))
    refusals = [*lost, *([Refusal(participant.id, trials.where, too_few)] if too_few and (seen or not lost) else [])]
    return PooledCycles(
        subject=participant.id,
        group=participant.group,
        session=trials.session,
        condition=trials.condition,
        trials=len(seen),
        detectors=dict(sorted(Counter(trial.steps.detector for trial in seen).items())),
        contact_offset_s=offset_s,
        foot_off_offset_s=_offset_s(later, "foot_offs", off_late),
        offset_steps=steps,
        over_ground=outside,
        channels=channels,
        curves=curves,
        cycles=pd.DataFrame(rows, columns=pd.Index(CYCLE_COLUMNS)),
        findings=tuple(findings),
        refusals=tuple(refusals),
        files={file: sha for trial in seen for file, sha in trial.files.items()},
        leg_m=next((leg_m for trial in seen if (leg_m := standing.leg_m(trial.planned)) is not None), None),
        age_years=participant.age_years,
        raw_emg={} if too_few else _raw_emg(cut, channels, curves),
    )


def can_pool(pooled: Sequence[PooledCycles]) -> bool:
    """Whether pooled cycles stand in for a comparison that was refused: all walks are over ground, and give cycles."""
    return bool(pooled) and all(cycles.over_ground and len(cycles.kept) for cycles in pooled)


def _cut(standing: Standing, seen: _Pooled, later: Later) -> _Pooled:
    treadmill, participant = standing.study.treadmill, standing.participant
    belt = seen.planned.speed_m_per_s or (treadmill.speed_m_per_s if treadmill else 0.0)
    contact_s = _offset_s(later, "contacts", seen.steps.detector) or 0.0
    off_s = _offset_s(later, "foot_offs", seen.steps.off_detector) or 0.0
    cycles = cut_cycles(seen.steps.corrected("contacts", contact_s), seen.steps.corrected("foot_offs", off_s))
    doubted = [span for finding in seen.findings if finding.kind in DOUBTED for span in finding.spans]
    cycles = [replace(c, kinetic=is_kinetic(c, seen.plates, seen.plate_steps, doubted)) for c in cycles]
    places = [find_places(cycle, seen.feet, 0.0 if seen.over_ground else belt) for cycle in cycles]
    cycles = with_gaps(cycles, seen.legs)
    cycles, unknown = without_stated(cycles, seen.planned.leave_out_cycles, participant.trial_name(seen.planned))
    return replace(seen, cycles=cycles, places=places, unknown=unknown)


def _too_few(standing: Standing, trials: TrialSet, cut: Sequence[_Pooled], outside: bool) -> str:
    """Why the cycles that are left do not do, and which labels spoiled those that are not; empty where they do."""
    quality = standing.study.quality
    n_kept = Counter(cycle.side for trial in cut for cycle in trial.kept)
    needed, key = (quality.min_cycles, "min_cycles") if outside else (quality.min_strides, "min_strides")
    if max(n_kept.values(), default=0) >= needed:
        return ""
    reasons = [cycle.reason for trial in cut for cycle in trial.cycles if cycle.reason]
    first = f"; {len(reasons)} excluded, the first: {reasons[0]}" if reasons else ""
    causes = [
        f"; from {start:.2f} to {end:.2f} s {finding.what}"
        for trial in cut
        for finding in trial.findings
        if finding.kind in UNFIT
        for start, end in finding.spans
        if any(cycle.reason and start < cycle.end and cycle.start < end for cycle in trial.cycles)
    ]
    counts = ", ".join(f"{n_kept[side]} of side {side}" for side in "rl")
    have = "1 trial has" if len(trials.trials) == 1 else f"{len(trials.trials)} trials have"
    who = " ".join((standing.participant.id, trials.where))
    where = "over ground" if outside else "on a treadmill"
    error = StrideError(
        f"{who}: the number of cycles of a foot {where}, pooled over trials, must be at least {needed}",
        f"{have} {counts}{first}{''.join(causes[:1])}",
        f"{'Correct the labels, add' if causes else 'Add'} trials, or lower {key} in [quality].",
    )
    return str(error)


def _row(number: int, cycle: Cycle, place: Places, too_few: str) -> tuple[object, ...]:
    stance = cycle.stance_percent
    single = 100.0 * (cycle.opposite_contact - cycle.opposite_off) / cycle.duration_s
    return (
        number, cycle.side, cycle.start, cycle.foot_off, cycle.opposite_off, cycle.opposite_contact, cycle.end,
        *cycle.contacts_by, cycle.foot_off_by, cycle.kinetic, not (cycle.reason or too_few),
        cycle.reason or ("too few cycles" if too_few else ""), cycle.duration_s, place.step_s,
        120.0 / cycle.duration_s, stance, 100.0 - stance, single, cycle.double_support_percent, place.stride_m,
        place.step_m, place.width_m, place.stride_m / cycle.duration_s,
    )  # fmt: skip


def _curves(cut: Sequence[_Pooled]) -> tuple[tuple[Channel, ...], Values]:
    """Kept cycles of all trials on 101 points; a channel that a trial lacks is missing in its cycles."""
    by_name: dict[str, Channel] = {}
    for shelved in (shelved for trial in cut for shelved in trial.states):
        for channel in shelved.kept.channels:
            by_name.setdefault(channel.name, channel)
    names = list(by_name)
    curves = np.full((sum(len(trial.kept) for trial in cut), len(PERCENT), len(names)), np.nan)
    row = 0
    for trial in cut:
        for shelved in trial.states:  # the first unit counts
            chosen = shelved.recording().selected_by(lambda channel: channel.unit == by_name[channel.name].unit)
            columns = [names.index(name) for name in chosen.names]
            for place, cycle in enumerate(trial.kept, row):
                ends = np.array([cycle.start]), np.array([cycle.end])
                values = Strides(*ends, cycle.side, trial.steps.detector).normalised(chosen)[0]
                bare = [not cycle.kinetic and channel.quantity in KINETIC for channel in chosen.channels]
                values[:, bare] = np.nan
                curves[place][:, columns] = values
        row += len(trial.kept)
    return tuple(by_name.values()), curves


def _raw_emg(cut: Sequence[_Pooled], channels: Sequence[Channel], curves: Values) -> dict[str, Values]:
    """Raw EMG of each leg's most typical cycle (sample, channel of that leg), from contact to contact."""
    cycles = [(trial.raw_emg, cycle) for trial in cut for cycle in trial.kept]
    sides, typical = pd.DataFrame({"side": [cycle.side for _, cycle in cycles]}), {}
    for side in "lr":
        row = choose_typical(curves, sides, channels, side)
        shelved, cycle = cycles[row] if row is not None else (None, None)
        if shelved is None or cycle is None:
            continue
        raw = shelved.recording()
        names = [channel.name for channel in channels if channel.quantity == "emg" and channel.side == side]
        if set(names) <= set(raw.names):
            first, last = np.searchsorted(raw.time, (cycle.start, cycle.end))
            typical[side] = raw.selected(names).values[first : last + 1]
    return typical
