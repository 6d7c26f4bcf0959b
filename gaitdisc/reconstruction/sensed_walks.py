"""The walks of a study as sensing needs them: sensors and what is reconstructed from them, filtered, on one rate."""

from collections.abc import Sequence
from dataclasses import dataclass, replace
from functools import partial

import numpy as np

from gaitdisc.channel import Channel, check_word
from gaitdisc.errors import ChannelError, GaitdiscError, SamplingError, UnitError
from gaitdisc.ingest.c3d import C3DReader
from gaitdisc.ingest.public_words import PublicWords, list_words, of_trial
from gaitdisc.ingest.study import Models, Participant, Study
from gaitdisc.ingest.trial_sets import is_walk
from gaitdisc.processing.contact_choice import choose_contacts
from gaitdisc.processing.process import ReadWalk, StudyWalks, is_raw
from gaitdisc.processing.processed_walks import public_trial
from gaitdisc.processing.walk_pair import FORCE_HZ
from gaitdisc.recording import Finding, Recording, Strides, Trial
from gaitdisc.recording.arrays import Values, finite_values
from gaitdisc.recording.recording import join_recordings
from gaitdisc.recording.strides import interpolate
from gaitdisc.saved.provenance import Refusal
from gaitdisc.signals.butterworth import low_pass
from gaitdisc.signals.emg import emg_findings, envelopes
from gaitdisc.signals.strides import cut_strides

EDGE_S = 0.3  # where a zero-lag filter lacks one side
PELVIS = tuple(f"pelvis_{word}" for word in ("tilt", "list", "rotation", "tx", "ty", "tz"))
LEG = ("hip_flexion", "hip_adduction", "hip_rotation", "knee_angle", "ankle_angle")
# the 18 of section 5.3.3
WHOLE_STATE = (*PELVIS, "lumbar_extension", "lumbar_bending", *(f"{joint}_{side}" for side in "rl" for joint in LEG))
STATES = "states"
TARGETS = {
    "emg": ("emg", ("emg",)),
    "forces": ("forces", ("force", "vertical_force")),
    "moments": ("moments", ("moment",)),
}  # word -> stream of a trial, and its quantities
SENSED = ("kinematics", "markers")  # streams that hold sensors
STILL = {"deg": 1e-3, "m": 1e-3}  # a channel that varies less was locked
STILL_OTHERWISE = 1e-9


@dataclass(frozen=True, eq=False)
class SensedWalk:
    """One filtered walk."""

    recording: Recording
    phi: Values  # (time,) [% stride], of the study's side


@dataclass(frozen=True, eq=False)
class SensedWalks:
    """The walks of all participants, of the same channels at the same rate."""

    people: dict[str, tuple[SensedWalk, ...]]  # pseudonym -> walks; those without any are not among them
    channels: tuple[Channel, ...]  # of every recording, in order: the states, then sensors that are none
    refusals: tuple[Refusal, ...]
    findings: tuple[Finding, ...]  # states that are left out, and what was seen in the recordings
    files: dict[str, str]  # what each file is called -> SHA-256

    @property
    def rate_hz(self) -> float:
        """Samples a second of every recording."""
        return next(iter(self.people.values()))[0].recording.rate_hz

    def named(self, names: Sequence[str]) -> tuple[Channel, ...]:
        """Return channels by their names, in the order of the names."""
        by_name = {channel.name: channel for channel in self.channels}
        return tuple(by_name[name] for name in names)


def read_walks(study: Study, sensors: Sequence[str], condition: str = "", targets: str = STATES) -> SensedWalks:
    """Read and process every walk of a study for reconstruction.

    sensors: channels of the kinematics that are read; they may be others than the 18 states
    condition: a word of the study's conditions; both where it is empty
    """
    check_word(targets, (STATES, *TARGETS), "the targets")
    walks: dict[str, list[SensedWalk]] = {}
    refusals, findings, files = [], [], {}
    with C3DReader() as reader:
        for person in study.participants:
            if person.excluded:
                refusals.append(Refusal(person.id, "", f"excluded in the study: {person.excluded}"))
                continue
            public = list_words(study, person, sensors)
            for read in _walks(study, person, condition, reader, public, refusals):
                trial = read.trial
                try:
                    walk, seen = _sense(read, study, sensors, targets)
                except GaitdiscError as error:
                    reason = f"{trial.name}: {public.error(error)}"
                    refusals.append(Refusal(person.id, trial.condition, reason))
                    continue
                walks.setdefault(person.id, []).append(walk)
                findings += map(public.finding, seen)
                files |= {s.source.file: s.source.sha256 for s in trial.streams.values() if s.source.sha256}
    if not walks:
        raise ChannelError(
            "at least one walk must be usable for the reconstruction",
            f"all walks are refused. The first: {refusals[0].reason}" if refusals else "the study has no walks",
            "Correct what the message names, or choose other sensors.",
        )
    every = [walk for person_walks in walks.values() for walk in person_walks]
    _refuse_units(every)
    channels, left_out = _moving(every, sensors)
    names = [channel.name for channel in channels]
    people = {
        name: tuple(replace(walk, recording=walk.recording.selected(names)) for walk in person_walks)
        for name, person_walks in walks.items()
    }
    _refuse_rates(people)
    return SensedWalks(people, channels, tuple(refusals), (*left_out, *findings), files)


def _walks(
    study: Study, person: Participant, condition: str, reader: C3DReader, public: PublicWords, refusals: list[Refusal]
) -> list[ReadWalk]:
    usable = []
    streams = [stream for stream, _ in TARGETS.values()]
    study_walks = StudyWalks(study, person, partial(public_trial, study, person, public, reader))
    for planned in person.trials:
        if not is_walk(study, planned) or (condition and planned.condition != condition):
            continue
        try:
            read = study_walks.read_walk(planned)
            trial = of_trial(public, person, planned).keep_known_channels(read.trial, streams)
            usable.append(replace(read, trial=trial))
        except GaitdiscError as error:
            refusals.append(Refusal(person.id, planned.condition, str(public.error(error))))
    return usable


def _sense(read: ReadWalk, study: Study, sensors: Sequence[str], targets: str) -> tuple[SensedWalk, list[Finding]]:
    trial = read.trial
    if targets != STATES:
        both, strides, seen = target_walk(trial, study, sensors, targets)
        inner = both.between(both.time[0] + EDGE_S, both.time[-1] - EDGE_S)
        return SensedWalk(inner, strides.phi(inner.time)), seen
    kinematics = trial.stream("kinematics")
    for name in sensors:
        kinematics.index(name)  # refuses a sensor that was not recorded, and names the nearest
    selected = dict.fromkeys([*(name for name in WHOLE_STATE if name in kinematics.names), *sensors])
    legs = [f"{joint}_{side}" for joint in ("hip_flexion", "knee_angle") for side in "rl"]
    needed = tuple(dict.fromkeys([*selected, *(name for name in legs if name in kinematics.names)]))
    walk = read.processed(study.model_copy(update={"models": Models().model_copy(update={"angles": needed})}))
    state = walk.state.selected(list(selected))
    inner = state.between(state.time[0] + EDGE_S, state.time[-1] - EDGE_S)
    phi = walk.strides[walk.side].phi(inner.time)
    return SensedWalk(inner, phi), [finding for finding in walk.findings if finding.severity != "note"]


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
    check_word(targets, (STATES, *TARGETS), "the targets")
    filters = study.filters
    there = [key for key in SENSED if key in trial.streams] or [SENSED[0]]
    stream = next((key for key in there if set(sensors) <= set(trial.stream(key).names)), there[0])
    read = trial.stream(stream).selected(sensors)  # refuses, and names the nearest
    read = low_pass(read, filters.kinematics_hz, filters.order, filters.gap_s)
    target, findings = _find_targets(trial, study, targets)
    choice = choose_contacts(trial, study.strides.detector, study.walking_direction)
    side = study.strides.side if study.strides.side in choice.contacts else next(iter(choice.contacts))
    strides = cut_strides(choice.contacts[side], None, study.strides.min_s, study.strides.max_s)
    values = interpolate(target.time, target.values, read.time)
    if not np.isfinite(values).any():
        raise SamplingError(
            f"trial {trial.name}: {targets} and sensors must overlap in time",
            f"sensors last from {read.time[0]:.2f} to {read.time[-1]:.2f} s, "
            f"{targets} from {target.time[0]:.2f} to {target.time[-1]:.2f} s",
            "Check that the files belong to the same trial and clock.",
        )
    both = join_recordings(read, replace(target, time=read.time, values=values, suspect=None))
    return replace(both, suspect=None, subject=trial.subject, condition=trial.condition), strides, findings


def _find_targets(trial: Trial, study: Study, targets: str) -> tuple[Recording, list[Finding]]:
    key, quantities = TARGETS[targets]
    recording = trial.stream(key).selected_by(lambda channel: channel.quantity in quantities)
    filters = study.filters
    dead: dict[str, Finding] = {}
    if key == "emg" and is_raw(recording):
        dead = {finding.channel: finding for finding in emg_findings(recording) if finding.severity == "refused"}
        recording = recording.selected([name for name in recording.names if name not in dead])
    if not recording.names:
        raise ChannelError(
            f"trial {trial.name} must have {targets}",
            f"none is usable: {', '.join(dead)}" if dead else f"it has no {' or '.join(quantities)}",
            "Exclude the trial, or reconstruct another quantity.",
        )
    findings = [
        Finding("warning", "left out", finding.file, f"{name}: {finding.what}", "this muscle, which is excluded", name)
        for name, finding in dead.items()
    ]
    if key == "emg" and is_raw(recording):
        return envelopes(recording, filters.emg_highpass_hz, filters.emg_lowpass_hz, filters.order), findings
    cutoff_hz = {"emg": filters.emg_lowpass_hz, "forces": FORCE_HZ}.get(key, filters.kinematics_hz)
    return low_pass(recording, cutoff_hz, filters.order, filters.gap_s), findings


def _moving(walks: Sequence[SensedWalk], sensors: Sequence[str]) -> tuple[tuple[Channel, ...], list[Finding]]:
    """Channels that every walk has and that move in every walk; a sensor that does not is refused."""
    first, moving, findings = walks[0].recording, [], []
    for channel in first.channels:
        lacking = [w.recording for w in walks if channel.name not in w.recording.names]
        least = STILL.get(channel.unit, STILL_OTHERWISE)
        still = [w.recording for w in walks if w.recording not in lacking and _still(w.recording[channel.name], least)]
        if not lacking and not still:
            moving.append(channel)
            continue
        why = f"does not vary in {len(still)}" if still else f"is missing in {len(lacking)}"
        what = f"{channel.name} {why} of {len(walks)} walks"
        if channel.name in sensors:
            raise ChannelError("a sensor must exist and vary in every walk", what, "Choose another sensor.")
        findings.append(Finding("note", "left out", "the study", what, "this state, which is left out", channel.name))
    return tuple(moving), findings


def _still(values: Values, least: float) -> bool:
    known = finite_values(values)
    return not len(known) or float(np.std(known)) < least


def _refuse_units(walks: Sequence[SensedWalk]) -> None:
    first: dict[str, tuple[str, str]] = {}
    for walk in walks:
        file = walk.recording.source.file or walk.recording.subject
        for channel in walk.recording.channels:
            unit, where = first.setdefault(channel.name, (channel.unit, file))
            if unit != channel.unit:
                raise UnitError(
                    f"{channel.name} must have the same unit in all walks",
                    f"{where} has it in {unit!r}, {file} in {channel.unit!r}",
                    "State the unit in the study's [channels], or exclude the walks with one of the units.",
                )


def _refuse_rates(people: dict[str, tuple[SensedWalk, ...]]) -> None:
    rates = {walk.recording.rate_hz: name for name, person_walks in people.items() for walk in person_walks}
    if len(rates) > 1:
        (rate_hz, first), (other_hz, second) = list(rates.items())[:2]
        raise SamplingError(
            "all walks must have the same sampling rate for reconstruction",
            f"{first} was recorded at {rate_hz:g} Hz, {second} at {other_hz:g} Hz",
            "Resample the kinematics to one rate.",
        )
