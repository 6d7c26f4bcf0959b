"""What a device does, from a laboratory's own files: both walks of a person, read and compared at a joint."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field, replace
from functools import cached_property, partial

import numpy as np

from gaitdisc.discovery.candidate import Candidate
from gaitdisc.discovery.changed_moment import NORMAL_95, Changed, find_change, foot_mass
from gaitdisc.discovery.joint_and_trials import FEWEST_STRIDES, as_walk, changes, nominal_moment, weighed
from gaitdisc.discovery.result import Estimate
from gaitdisc.errors import ChannelError, GaitdiscError, SchemaError, StrideError
from gaitdisc.ingest.c3d import C3DReader
from gaitdisc.ingest.public_words import PublicWords, list_words, of_trial
from gaitdisc.ingest.study import Participant, PlannedTrial, Study
from gaitdisc.ingest.trial_sets import not_compared
from gaitdisc.kinetics.newton_euler import GRAVITY
from gaitdisc.processing.joint_record import JointRecord, join_trials, joint_record
from gaitdisc.processing.muscle_moment import JOINTS, MuscleMoment
from gaitdisc.processing.process import ReadWalk, StudyWalks
from gaitdisc.processing.processed_walks import public_trial
from gaitdisc.recording import Finding, Trial
from gaitdisc.words import counted

LEAST_R2 = 0.7  # two strides of a published walk have -2.4 and 0.70, 36 s of the embedded cohort 0.96
AGREES = 1.25  # times what is left of Nominal strides; 0.97 to 1.12 in four made people where nothing was hidden
FOOT_SHOWS_AT = ("knee_angle", "hip_flexion")
MEND = (
    f"Record at least {FEWEST_STRIDES} strides in each condition, in one trial or several, and set the second "
    "condition as device in [conditions]. From fewer, `gaitdisc run` pools the cycles; `gaitdisc report STUDY "
    "--person P --before A --after B` compares two sessions or conditions."
)
LEAST_FOOT_KG = 0.3  # three made people show up to 0.2 kg at these joints where there is none


@dataclass(frozen=True, eq=False)
class DeviceWalks:
    """One joint of both walks of a person, and the moment model that the Nominal walk calibrates."""

    nominal: JointRecord
    device: JointRecord
    model: MuscleMoment

    @cached_property
    def changed(self) -> Changed | None:
        """What the strides of both walks together say that changed; None where nothing is borne out."""
        return find_change(self.model, as_walk(self.nominal), as_walk(self.device), changes(self.device))

    @cached_property
    def agrees(self) -> bool:
        """Whether the device walk bears out no change and is followed as Nominal strides left out of the fit are."""
        walk = as_walk(self.device)
        residual = walk.moment - self.model.net(walk.driven)
        usable = np.isfinite(residual) & (walk.stride >= 0)
        return self.changed is None and float(np.sqrt(np.mean(residual[usable] ** 2))) < AGREES * self.model.left_nm

    def weighed(self, candidate: Candidate) -> bool:
        """Whether an explanation is possible: the change that both walks bear out, or all where there is none."""
        if self.agrees or not weighed(candidate):
            return False
        if self.changed is None:
            return True
        change = self.changed.change
        same = (candidate.name, candidate.place) == (change.name, change.place)
        return same and (not change.piece or candidate.pieces[0].startswith(change.piece))


@dataclass(frozen=True, eq=False)
class PersonWalks:
    """Walks of a participant: each is read once, and the Nominal one calibrates a joint once for all others."""

    study: Study
    participant: Participant
    _reader: C3DReader = field(default_factory=C3DReader, init=False)
    _read: dict[PlannedTrial, ReadWalk] = field(default_factory=dict, init=False)
    _models: dict[str, MuscleMoment] = field(default_factory=dict, init=False)

    @cached_property
    def _words(self) -> PublicWords:
        return list_words(self.study, self.participant)

    @cached_property
    def _walks(self) -> StudyWalks:
        public = partial(public_trial, self.study, self.participant, self._words, self._reader)
        return StudyWalks(self.study, self.participant, public)

    def calibrated(self, condition: str, joint: str = "ankle_angle") -> DeviceWalks:
        """Return one joint of the Nominal walk and another; a walk that lacks EMG or moments is refused by its name."""
        if joint not in JOINTS:
            raise SchemaError(f"the joint must be one of {', '.join(JOINTS)}", f"found {joint!r}", "Correct --joint.")
        walks = self.at(condition, joint)
        check_calibrated(walks.model, walks.nominal)
        return walks

    def at(self, condition: str, joint: str) -> DeviceWalks:
        """Return one joint of the Nominal walk and another, whatever the moment model explains."""
        if lacking := not_compared(against(self.study, condition), self.participant, pooled=True):
            needed = f"both walks of {self.participant.id} are required"
            raise SchemaError(needed, lacking.removesuffix("."), MEND)
        nominal, device = (self._record(word, joint) for word in (self.study.conditions.nominal, condition))
        if joint not in self._models:
            self._models[joint] = nominal_moment(nominal)
        return DeviceWalks(nominal, device, self._models[joint])

    def _record(self, condition: str, joint: str) -> JointRecord:
        """Return one joint in the walk of a condition, or in its short trials one after another."""
        trials = [planned for planned in self.participant.trials_of(condition) if not planned.leave_out]
        records, faults = [], {}
        with self._reader:  # one process for all trials
            for planned in trials:
                try:
                    records.append(self._trial_record(planned, joint))
                except GaitdiscError as error:
                    faults[self.participant.trial_name(planned)] = error
        if read := [self._read[planned].trial for planned in trials if planned in self._read]:
            check_length(read, self.study.strides.min_s)
        if not records:
            raise next(iter(faults.values()))
        spoils = "this trial, which is excluded"
        excluded = [
            Finding("warning", "excluded trial", name, str(fault).rstrip("."), spoils) for name, fault in faults.items()
        ]
        record = join_trials(records)
        return replace(record, findings=(*record.findings, *excluded))

    def _trial_record(self, planned: PlannedTrial, joint: str) -> JointRecord:
        if planned not in self._read:
            self._read[planned] = self._walks.read_walk(planned)
        read = self._read[planned]
        check_kinetics(read.trial)
        mass_kg = None if read.body_weight_n is None else read.body_weight_n / GRAVITY
        public = of_trial(self._words, self.participant, planned)
        record = public.of(partial(joint_record, read.trial, self.study, joint, mass_kg))
        return replace(record, subject=self.participant.id)


def against(study: Study, condition: str) -> Study:
    """Return the study that compares this condition with the reference, if it compares a device at all."""
    if study.conditions.device is None:
        return study
    conditions = study.conditions.model_copy(update={"device": condition})
    return study.model_copy(update={"conditions": conditions}).placed(study.folder)


def weigh_foot(walks: Mapping[str, DeviceWalks]) -> Estimate | None:
    """Return the mass at the foot that the knee shows and the hip bears out [kg]; None where they show none.

    At the hip it comes out too small: the two strongest muscles, which take part in carrying it, have no electrode.
    """
    pairs = [walks[joint] for joint in FOOT_SHOWS_AT if joint in walks]
    masses = [
        foot_mass(pair.model, as_walk(pair.nominal), as_walk(pair.device), pair.device.per_kg)
        for pair in pairs
        if pair.device.per_kg.size and pair.model.r2 >= LEAST_R2
    ]
    if len(masses) < len(FOOT_SHOWS_AT):
        return None
    (knee, knee_spread), (hip, hip_spread) = masses
    half = NORMAL_95 * knee_spread
    named = hip > hip_spread and knee > max(LEAST_FOOT_KG, half)
    return Estimate(knee, knee - half, knee + half, "kg") if named else None


def check_length(trials: Sequence[Trial], shortest_s: float) -> None:
    """Refuse walks too short for the strides of a discovery, before faults whose mend would not help."""
    clocks = [trial.stream("kinematics").time for trial in trials]
    if (lasts_s := float(sum(time[-1] - time[0] for time in clocks))) < FEWEST_STRIDES * shortest_s:
        needed = f"to name the effect of a device, a condition must have at least {FEWEST_STRIDES} strides"
        raise StrideError(needed, f"{trials[0].name}: {counted(len(trials), 'trial')}, {lasts_s:.1f} s in all", MEND)


def check_kinetics(trial: Trial) -> None:
    """Refuse a walk without EMG, without moments, or whose forces do not carry the body."""
    wrong = [finding for finding in trial.findings if finding.kind == "force balance" and finding.severity == "warning"]
    if wrong:
        raise SchemaError(
            "the ground forces must balance the body weight within 12 %",
            f"{trial.name}: {wrong[0].what}",
            "Correct mass_kg in the study file, or the scale of the plates. Otherwise the imbalance would be named as "
            "an effect.",
        )
    per_kg = [finding for finding in trial.findings if finding.kind == "per body mass"]
    if per_kg:
        raise SchemaError(
            "moments must have the stated unit, N m",
            f"{trial.name}: {per_kg[0].channel} {per_kg[0].what}",
            "Write their unit as N m/kg in [channels], or multiply them by the body mass.",
        )
    for key, word, mend in (
        ("emg", "EMG", "Add the file with the EMG, or name the EMG channels in [channels]."),
        ("moments", "joint moments", "Add force plates, a static trial and mass_kg, or a .sto file of moments."),
    ):
        if key not in trial.streams:
            why = next((f": {finding.what}" for finding in trial.findings if finding.kind == "no moments"), "")
            raise NoMomentsError(
                f"to name the effect of a device at a joint, both walks must have {word}",
                f"{trial.name} has no {word}{why if key == 'moments' else ''}",
                mend,
            )


def check_calibrated(model: MuscleMoment, nominal: JointRecord) -> None:
    """Refuse a moment model that says too little of the Nominal walk: what it leaves is not the device's."""
    if model.r2 < LEAST_R2:
        strides = nominal.stride.max() + 1
        raise SchemaError(
            f"the moment model must explain at least {100 * LEAST_R2:.0f} % of the variance of held-out Nominal "
            "strides before an effect of the device is named",
            f"the {JOINTS[nominal.joint]} model of {nominal.subject} has R² {model.r2:.2f}, with {strides} strides",
            "Record more strides, add muscles that span the joint, or check that EMG and forces share a clock.",
        )


class NoMomentsError(ChannelError):
    """A walk lacks EMG or moments; its motion can still be compared."""
