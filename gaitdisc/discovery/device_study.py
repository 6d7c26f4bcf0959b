"""What a device does, from a laboratory's own files: walks of a person, to the discovery at a joint."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field, replace
from functools import cached_property, partial

import numpy as np
import pandas as pd

from gaitdisc.discovery.candidate import Candidate
from gaitdisc.discovery.changed_moment import NORMAL_95, Changed, find_change, foot_mass
from gaitdisc.discovery.effect_words import estimate_text, spoken
from gaitdisc.discovery.joint_and_trials import as_walk, changes, nominal_moment, weighed
from gaitdisc.discovery.result import Discovery, Estimate, FoundEffect
from gaitdisc.errors import ChannelError, SchemaError
from gaitdisc.ingest.c3d import C3DReader
from gaitdisc.ingest.public_words import PublicWords, list_words, of_trial
from gaitdisc.ingest.study import Participant, Study
from gaitdisc.ingest.trial_sets import not_compared
from gaitdisc.kinetics.newton_euler import GRAVITY
from gaitdisc.models.ridge import fit_ridge
from gaitdisc.processing.joint_record import JointRecord, joint_record
from gaitdisc.processing.muscle_moment import JOINTS, MuscleMoment, drives, fit_moment
from gaitdisc.processing.process import ReadWalk, StudyWalks
from gaitdisc.processing.processed_walks import public_trial
from gaitdisc.recording import Finding, Samples, Trial

LEAST_R2 = 0.7  # two strides of a published walk have -2.4 and 0.70, 36 s of the embedded cohort 0.96
HARMONICS = 8  # of the plain regression of what is left
AGREES = 1.25  # times what is left of Nominal strides; 0.97 to 1.12 in four made people where nothing was hidden
APART = 0.02  # of a number, from which on the answer says that the written model has another
FOOT_SHOWS_AT = ("knee_angle", "hip_flexion")
# the strongest muscles of the hip, and their channels; without them a spring of 80 N m/rad came out as 119 and 125
DEEP = {"gluteus maximus": ("gmax",), "iliopsoas": ("ilio", "psoas")}
LEAST_FOOT_KG = 0.3  # three made people show up to 0.2 kg at these joints where there is none
COLUMNS = ("effect", "place", "number", "unit", "people", "of", "mean", "low", "high", "who")
NOTHING = "nothing named"


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

    @property
    def both_walks_model(self) -> MuscleMoment:
        """The moment model with gains of both walks where a change was fitted beside them, else of the Nominal walk."""
        return self.changed.model if self.changed else self.model

    @cached_property
    def agrees(self) -> bool:
        """Whether the device walk bears out no change and is followed as Nominal strides left out of the fit are."""
        walk = as_walk(self.device)
        left = walk.moment - self.model.net(walk.driven)
        kept = np.isfinite(left) & (walk.stride >= 0)
        return self.changed is None and float(np.sqrt(np.mean(left[kept] ** 2))) < AGREES * self.model.left_nm

    def weighed(self, candidate: Candidate) -> bool:
        """Whether an explanation is possible: the change that both walks bear out, or all where there is none."""
        if self.agrees:
            return False
        if self.changed is None or not weighed(candidate):
            return weighed(candidate)
        change = self.changed.change
        same = (candidate.name, candidate.place) == (change.name, change.place)
        return same and (not change.piece or candidate.pieces[0].startswith(change.piece))

    @property
    def findings(self) -> tuple[Finding, ...]:
        """Of both files, and of the calibration."""
        what, per_kg = "not estimated: no marker shows the foot", self.device.per_kg
        if per_kg.size:  # which mass at the foot would be as large as what the moment model leaves
            least = self.model.left_nm / float(np.nanstd(per_kg))
            what = f"at the {JOINTS[self.device.joint]}, {least:.1f} kg at the foot would have the size of the residual"
        mass = Finding("note", "added mass", self.device.subject, what, "")
        own = (*self.nominal.findings, *self.device.findings, self._calibration(), mass)
        return (*own, self._together(self.changed)) if self.changed else own

    def _together(self, found: Changed) -> Finding:
        what = (
            f"the gains are fitted to both walks together with {spoken(found.change.name)} at {found.change.place}, "
            f"which removes {100 * found.closed:.0f} % of the squared error on held-out device strides"
        )
        if found.rival:
            rival = f"{spoken(found.rival.name)} at {found.rival.place}"
            what += f"; with the next best, {rival}, the error of the fit is {found.rival_leaves:.2f} times as large"
        return Finding("note", "moment model", self.nominal.subject, what, "")

    def _calibration(self) -> Finding:
        model, word = self.model, JOINTS[self.nominal.joint]
        late_ms = 1000 * (model.form.delay_s + model.form.lag_s)
        driven = drives(self.nominal)
        unseen = np.nanstd(model.others(driven)[np.isfinite(self.nominal.moment)])
        what = (
            f"the residual of the {word}'s moment model is {model.left_nm:.1f} N m of {model.before_nm:.1f} N m on "
            f"held-out Nominal strides (R2 {model.r2:.2f}); EMG acts {late_ms:.0f} ms "
            f"later; {unseen:.1f} N m come from muscles without an electrode"
        )
        return Finding("note", "moment model", self.nominal.subject, what, "")

    def with_model_error(self, found: Discovery) -> Discovery:
        """Return what was found with the number of both walks, whose interval holds the error of the moment model."""
        if self.agrees:
            said = "The Nominal moment model predicts the device walk as well as held-out Nominal strides: "
            return replace(found, verdict="no_gap", effects=(), sentence=f"{said}it shows no missing effect.")
        if self.changed is None:
            return replace(found, sentence=found.sentence + self._doubt(found))
        change, effects, sentence = self.changed.change, list(found.effects), found.sentence
        same = [(one.name, one.place) == (change.name, change.place) for one in effects]
        if True in same and change.number in (first := effects[same.index(True)]).estimates:
            old = first.estimates[change.number]
            half = float(np.hypot((old.high - old.low) / 2, NORMAL_95 * self.changed.spread))
            new = Estimate(self.changed.value, self.changed.value - half, self.changed.value + half, old.unit)
            effects[same.index(True)] = replace(first, estimates={**first.estimates, change.number: new})
            sentence = sentence.replace(estimate_text(old), estimate_text(new))
            if abs(old.value - new.value) > APART * abs(new.value):
                sentence += f" The written model has {old.value:.3g} {old.unit}, fitted with the other parameters."
        return replace(found, effects=tuple(effects), sentence=sentence + self._doubt(found))

    def _doubt(self, found: Discovery) -> str:
        """Say that the size of an effect is not to be trusted where a joint's strongest muscles have no electrode."""
        if not found.effects or self.nominal.joint != "hip_flexion":
            return ""
        seen = {name.split("_")[1] for name in self.nominal.muscles}
        unseen = [said for said, short in DEEP.items() if not seen & set(short)]
        which = " and ".join(unseen)
        return f" Its size is unreliable: the hip's {which} has no electrode." if unseen else ""


@dataclass(frozen=True, eq=False)
class PersonWalks:
    """Walks of a participant: each is read once, and the Nominal one calibrates a joint once for all others."""

    study: Study
    participant: Participant
    _reader: C3DReader = field(default_factory=C3DReader, init=False)
    _read: dict[str, ReadWalk] = field(default_factory=dict, init=False)
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
        if lacking := not_compared(against(self.study, condition), self.participant):
            needed = f"both walks of {self.participant.id} are required"
            raise SchemaError(needed, lacking.removesuffix("."), "Name one trial of each condition.")
        nominal, device = (self._record(word, joint) for word in (self.study.conditions.nominal, condition))
        if joint not in self._models:
            self._models[joint] = nominal_moment(nominal)
        return DeviceWalks(nominal, device, self._models[joint])

    def _record(self, condition: str, joint: str) -> JointRecord:
        planned = self.participant.trials_of(condition)[0]
        if condition not in self._read:
            with self._reader:
                self._read[condition] = self._walks.read_walk(planned)
        read = self._read[condition]
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
    found = {}
    for joint, one in walks.items():
        if one.device.per_kg.size and one.model.r2 >= LEAST_R2:
            found[joint] = foot_mass(one.model, as_walk(one.nominal), as_walk(one.device), one.device.per_kg)
    if set(found) != set(FOOT_SHOWS_AT):
        return None
    (value, spread), (beside, its_spread) = (found[joint] for joint in FOOT_SHOWS_AT)
    half = NORMAL_95 * spread
    named = beside > its_spread and value > max(LEAST_FOOT_KG, half)
    return Estimate(value, value - half, value + half, "kg") if named else None


def with_foot_mass(found: Discovery, walks: PersonWalks, condition: str) -> Discovery:
    """Return what was found at the ankle where nothing is missing there, with a mass that knee and hip show."""
    try:
        mass = weigh_foot({joint: walks.at(condition, joint) for joint in FOOT_SHOWS_AT})
    except ChannelError:  # files that know the ankle alone
        return found
    if mass is None:
        return found
    said = (
        f"added_foot_mass is {estimate_text(mass)}, estimated at the knee and supported by the hip; the ankle is "
        "insensitive to it."
    )
    effect = FoundEffect("parameter", "added_foot_mass", "wrong_parameter", "", {"value": mass})
    return replace(found, verdict="wrong_parameter", effects=(effect,), sentence=said)


def check_kinetics(trial: Trial) -> None:
    """Refuse a walk without EMG, without moments, or whose forces do not carry the body."""
    wrong = [one for one in trial.findings if one.kind == "force balance" and one.severity == "warning"]
    if wrong:
        raise SchemaError(
            "moments need ground forces that balance the body weight within 12 %",
            f"{trial.name}: {wrong[0].what}",
            "Correct mass_kg in the study file, or the scale of the plates. Otherwise an effect would be named after "
            "this error.",
        )
    per_kg = [one for one in trial.findings if one.kind == "per body mass"]
    if per_kg:
        raise SchemaError(
            "the unit of moments must be the one that is stated, N m",
            f"{trial.name}: {per_kg[0].channel} {per_kg[0].what}",
            "Write their unit as N m/kg in [channels], or multiply them by the body mass.",
        )
    for key, word, mend in (
        ("emg", "EMG", "Add the file with the EMG, or name its channels in [channels]."),
        ("moments", "joint moments", "Add force plates, a static trial and mass_kg, or a .sto of moments."),
    ):
        if key not in trial.streams:
            why = next((f": {one.what}" for one in trial.findings if one.kind == "no moments"), "")
            raise NoMomentsError(
                f"naming the effect of a device at a joint needs {word} in both walks",
                f"{trial.name} has no {word}{why if key == 'moments' else ''}",
                mend,
            )


def check_calibrated(model: MuscleMoment, nominal: JointRecord) -> None:
    """Refuse a moment model that says too little of the Nominal walk: what it leaves is not the device's."""
    if model.r2 >= LEAST_R2:
        return
    raise SchemaError(
        f"the moment model must explain at least {100 * LEAST_R2:.0f} % of the variance of held-out Nominal strides "
        "before a device is named",
        f"the {JOINTS[nominal.joint]} of {nominal.subject} has R2 {model.r2:.2f}, with {nominal.stride.max() + 1} "
        "strides",
        "Record more strides, add muscles that span the joint, or check that EMG and forces share a clock.",
    )


class NoMomentsError(ChannelError):
    """A walk lacks EMG or moments; its motion can still be compared."""


def beside(walks: DeviceWalks, found: Discovery) -> dict[str, float]:
    """Root mean square error of the net moment on the held-out strides, model by model [N m].

    Nominal with the named effect is that of the discovery. Augmented adds a plain regression of what
    is left (angle, rate, their squares and product, each muscle's moment, harmonics of the stride); Exo is the moment
    model fitted to the device walk itself. Both learn from all strides of the device walk that are not held out.
    """
    device, model = walks.device, walks.model
    at = found.runs.time[np.isfinite(found.runs.time)]
    held = np.isin(device.stride, np.unique(device.stride[np.isin(np.round(device.time, 4), np.round(at, 4))]))
    held &= device.stride >= 0
    known = np.isfinite(device.moment) & np.isfinite(device.phase) & np.isfinite(device.rate)
    learned = known & ~held
    driven = drives(device)
    nominal = model.net(driven)
    angle, rate, phase = (np.nan_to_num(each) for each in (device.angle, device.rate, device.phase))
    seen = (angle, rate, angle**2, rate**2, angle * rate, *model.by_muscle(driven).T, 100 * phase)
    library = np.column_stack(seen)  # the last, percent stride, brings its harmonics
    names = (*map(str, range(library.shape[1] - 1)), "phi")
    samples = Samples(library, (device.moment - nominal)[:, None], names, ("left",), device.time, library[:, -1])
    augmented = nominal + fit_ridge(samples.rows(learned), HARMONICS)(library)[:, 0]
    blocks = np.where(learned, device.stride * 4 // (int(device.stride.max()) + 1), -1)
    exo_model = fit_moment(driven, np.where(learned, device.moment, np.nan), blocks, model.form)
    exo = exo_model.net(driven)
    own = known & held
    _, after, _ = found.held_out.channels["net_moment"]
    sizes: dict[str, float] = {}
    for name, one in (("Nominal", nominal), ("Augmented (plain regression)", augmented), ("Exo", exo)):
        sizes[name] = float(np.sqrt(np.mean((device.moment - one)[own] ** 2)))
        if name == "Nominal":
            sizes["Nominal + named effect"] = after if found.effects else sizes[name]
    return sizes


def over_people(found: Mapping[str, Discovery]) -> pd.DataFrame:
    """A row a number of each effect: in how many people it was named, mean, Student's 95 % interval (n > 1), who."""
    own: dict[tuple[str, str, str, str], dict[str, float]] = {}
    for person, one in found.items():
        for effect in one.effects:
            for number, each in effect.estimates.items():
                own.setdefault((effect.name, effect.place, number, each.unit), {})[person] = each.value
    rows: list[tuple[object, ...]] = []
    for key, each in own.items():
        largest = sorted(each.items(), key=lambda one: -abs(one[1]))
        who = ", ".join(f"{person} {value:.3g}" for person, value in largest)
        rows.append((*key, len(each), len(found), *_mean(list(each.values())), who))
    without = [person for person, one in found.items() if not one.effects]
    if without:
        rows.append((NOTHING, "", "", "", len(without), len(found), *[float("nan")] * 3, ", ".join(without)))
    table = pd.DataFrame(rows, columns=pd.Index(COLUMNS))
    return table.sort_values("people", ascending=False, kind="stable", ignore_index=True)


def over_conditions(found: Mapping[str, Mapping[str, Discovery]]) -> pd.DataFrame:
    """Rows of `over_people` for each condition, which a first column names where a study has several.

    found: person -> condition -> answer
    """
    people: dict[str, dict[str, Discovery]] = {}
    for person, answers in found.items():
        for word, one in answers.items():
            people.setdefault(word, {})[person] = one
    if not any(one.conditions for answers in found.values() for one in answers.values()):
        return over_people(next(iter(people.values()), {}))
    tables = {word: over_people(own) for word, own in people.items()}
    return pd.concat(tables, names=["condition"]).reset_index(0).reset_index(drop=True)


def lines(table: pd.DataFrame) -> list[str]:
    """Each row of `over_conditions` as a line of text."""
    said = []
    for row in table.to_dict("records"):
        what = f"{row['condition']}: " if "condition" in row else ""
        what += f"{row['effect']} at {row['place']}, {row['number']}" if row["place"] else row["effect"]
        mean = f", mean {row['mean']:.3g}" if row["place"] else ""
        if np.isfinite(row["low"]):
            mean += f" (95 % {row['low']:.3g} to {row['high']:.3g})"
        said.append(f"{what}: {row['people']} of {row['of']}{mean} {row['unit']}".rstrip() + f": {row['who']}")
    return said


def _mean(values: list[float]) -> tuple[float, float, float]:
    from scipy.stats import t

    mean = float(np.mean(values))
    if len(values) < 2:
        return mean, float("nan"), float("nan")
    half = float(t.ppf(0.975, len(values) - 1) * np.std(values, ddof=1) / np.sqrt(len(values)))
    return mean, mean - half, mean + half
