"""What a device does, from a laboratory's own files: a study, to the answer in each condition and over people."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import replace
from pathlib import Path

import numpy as np
import pandas as pd

from gaitdisc.discovery.catalogue import ALL, Request
from gaitdisc.discovery.changed_moment import NORMAL_95, Changed
from gaitdisc.discovery.device_study import FOOT_SHOWS_AT, DeviceWalks, NoMomentsError, PersonWalks, against, weigh_foot
from gaitdisc.discovery.discover_files import find_missing
from gaitdisc.discovery.effect_words import estimate_text, spoken
from gaitdisc.discovery.joint_and_trials import cut_walk_trials, joint_model, nominal_and_trials
from gaitdisc.discovery.result import DEVICE, ConditionAnswer, Discovery, Estimate, FoundEffect
from gaitdisc.errors import ChannelError, GaitdiscError
from gaitdisc.ingest.public_words import list_words
from gaitdisc.ingest.study_file import load_study
from gaitdisc.models.ridge import fit_ridge
from gaitdisc.processing.muscle_moment import JOINTS, drives, fit_moment
from gaitdisc.recording import Finding, Samples
from gaitdisc.recording.arrays import Values
from gaitdisc.simulation.simulation import Simulation

HARMONICS = 8  # of the plain regression of what is left
APART = 0.02  # of a number, from which on the answer says that the written model has another
# the strongest muscles of the hip, and their channels; without them a spring of 80 N m/rad came out as 119 and 125
DEEP = {"gluteus maximus": ("gmax",), "iliopsoas": ("ilio", "psoas")}
NUMBER = ("effect", "place", "number", "unit")
COLUMNS = (*NUMBER, "people", "of", "mean", "low", "high", "who")
NOTHING = "nothing named"


def discover_study(
    study: Path, participant: str, request: Request = ALL, joint: str = "ankle_angle"
) -> dict[str, tuple[Discovery, Simulation]]:
    """Find what the device does at a participant's joint in each further condition of a study.

    A condition that cannot be answered costs no other: all say why. The error is raised where none can be.

    returns condition -> the answer, and the Nominal model with what was found in it
    """
    read = load_study(study)
    person = read.participant(participant)
    words = (read.conditions.device or "", *read.conditions.others)
    answers: dict[str, tuple[Discovery, Simulation]] = {}
    errors: dict[str, GaitdiscError] = {}
    walks = PersonWalks(read, person)
    for word in words:
        of = f"{word}: " if word and len(words) > 1 else ""
        own = replace(request, progress=lambda step, of=of: request.progress(f"{of}{step}"))
        own.progress(f"comparing both walks of {participant} with the Nominal model")
        try:
            answers[word] = _discover_condition(walks, word, own, joint)
        except GaitdiscError as error:
            errors[word] = error
    if not answers:
        raise errors[words[0]]
    if len(words) == 1:
        return answers
    seen = {word: one.public for word, (one, _) in answers.items()}
    rows = [
        ConditionAnswer(word, str(errors[word])) if word in errors
        else ConditionAnswer(word, seen[word].sentence, seen[word].verdict, seen[word].effects, seen[word].beside)
        for word in words
    ]  # fmt: skip
    return {word: (replace(one, conditions=tuple(rows)), model) for word, (one, model) in answers.items()}


def _discover_condition(
    walks: PersonWalks, condition: str, request: Request, joint: str
) -> tuple[Discovery, Simulation]:
    """Find what the Nominal moment model lacks in another walk of a participant.

    Where a walk lacks EMG or moments, only the motion of both is compared, and the sentence says so.
    """
    study, person, progress = walks.study, walks.participant, request.progress
    called = list_words(study, person).files
    others = {*study.conditions.words} - {study.conditions.nominal, condition}
    own = [file for trial in person.trials if trial.condition not in others for file in trial.files]
    files = {study.path_of(file): called[Path(file).name] for file in own}
    try:
        both = walks.calibrated(condition, joint)
    except NoMomentsError as lacking:
        progress("comparing only the motion of both walks")
        motion = nominal_and_trials(against(study, condition), person.id, joint)
        request = replace(request, possible=lambda one: one.kind != "observation")  # both walks have the same sensors
        found, augmented = find_missing(*motion, request, files)
        why = f"{lacking.needed[:1].upper()}{lacking.needed[1:]}, but {lacking.found}"
        how = "only the motion of both walks was compared, which gives no moment of the device"
        return replace(found, sentence=f"{why}: {how}. {found.sentence}"), augmented
    muscles = both.changed.model if both.changed else both.model
    model = joint_model(both.device, muscles)
    data = cut_walk_trials(both.device, muscles, model)
    if study.conditions.others:
        model = replace(model, title=f"{model.title}, {condition}")
    found, augmented = find_missing(model, data, replace(request, possible=both.weighed), files)
    found, augmented = with_model_error(found, both), model if both.agrees else augmented
    errors = beside(both, found)
    if joint == "ankle_angle" and not found.effects:
        progress("estimating a mass added to the foot from the moments of the knee and hip")
        found = with_foot_mass(found, walks, condition)
    if found.provenance is not None:
        found = replace(found, provenance=replace(found.provenance, section=DEVICE))
    return replace(found, findings=(*device_findings(both), *found.findings), beside=errors), augmented


def with_model_error(found: Discovery, walks: DeviceWalks) -> Discovery:
    """Return what was found with the number of both walks, whose interval holds the error of the moment model."""
    if walks.agrees:
        said = "The Nominal moment model predicts the device walk as well as held-out Nominal strides: "
        return replace(found, verdict="no_gap", effects=(), sentence=f"{said}no effect is missing.")
    if walks.changed is not None:
        found = _with_number(found, walks.changed)
    if not found.effects or walks.nominal.joint != "hip_flexion":
        return found
    electrodes = {name.split("_")[1] for name in walks.nominal.muscles}
    unseen = " and ".join(muscle for muscle, channels in DEEP.items() if not electrodes & set(channels))
    doubt = f" The size of the effect is unreliable: no electrode records the {unseen} of the hip." if unseen else ""
    return replace(found, sentence=found.sentence + doubt)


def _with_number(found: Discovery, changed: Changed) -> Discovery:
    """Return what was found with the number of the change, if the search names it too."""
    change = changed.change
    effect = next((one for one in found.effects if (one.name, one.place) == (change.name, change.place)), None)
    if effect is None or change.number not in effect.estimates:
        return found
    old = effect.estimates[change.number]
    half = float(np.hypot((old.high - old.low) / 2, NORMAL_95 * changed.spread))
    new = Estimate(changed.value, changed.value - half, changed.value + half, old.unit)
    mended = replace(effect, estimates={**effect.estimates, change.number: new})
    sentence = found.sentence.replace(estimate_text(old), estimate_text(new))
    if abs(old.value - new.value) > APART * abs(new.value):
        number = f"{old.value:.3g} {old.unit}".removesuffix(" 1")
        sentence += f" In augmented.toml, this number is {number}, fitted together with the other parameters."
    return replace(found, effects=tuple(mended if one is effect else one for one in found.effects), sentence=sentence)


def with_foot_mass(found: Discovery, walks: PersonWalks, condition: str) -> Discovery:
    """Return what was found at the ankle where nothing is missing there, with a mass that knee and hip show."""
    try:
        mass = weigh_foot({joint: walks.at(condition, joint) for joint in FOOT_SHOWS_AT})
    except ChannelError:  # files that know the ankle alone
        return found
    if mass is None:
        return found
    sentence = (
        f"The mass added to the foot is {estimate_text(mass)}, estimated from the knee moment and supported by the hip "
        "moment; the ankle moment is insensitive to it."
    )
    effect = FoundEffect("parameter", "added_foot_mass", "wrong_parameter", "", {"value": mass})
    return replace(found, verdict="wrong_parameter", effects=(effect,), sentence=sentence)


def device_findings(walks: DeviceWalks) -> tuple[Finding, ...]:
    """Return the findings of both files, and what the moment model is worth."""
    nominal, device, model, joint = walks.nominal, walks.device, walks.model, JOINTS[walks.nominal.joint]
    late_ms = 1000 * (model.form.delay_s + model.form.lag_s)
    unseen = np.nanstd(model.others(drives(nominal))[np.isfinite(nominal.moment)])
    calibration = (
        f"the {joint} moment model leaves a residual of {model.left_nm:.1f} N m (rms) on held-out Nominal strides, in "
        f"which the moment varies by {model.before_nm:.1f} N m (R² {model.r2:.2f}). The EMG acts {late_ms:.0f} ms "
        f"later than recorded. Muscles without an electrode produce {unseen:.1f} N m"
    )
    mass = "the mass added to the foot is not estimated, because no marker shows the foot"
    if device.per_kg.size:  # which mass at the foot would be as large as what the moment model leaves
        least = model.left_nm / float(np.nanstd(device.per_kg))
        mass = f"an added mass of {least:.1f} kg at the foot would change the {joint} moment by as much as the residual"
    findings = [
        *nominal.findings,
        *device.findings,
        Finding("note", "moment model", nominal.subject, calibration, ""),
        Finding("note", "added mass", device.subject, mass, ""),
    ]
    if changed := walks.changed:
        both = (
            f"the muscle gains are fitted to both walks together with the {spoken(changed.change.name)} at "
            f"{changed.change.place}, which removes {100 * changed.closed:.0f} % of the squared error on held-out "
            "device strides"
        )
        if rival := changed.rival:
            both += f"; with the next best effect, the {spoken(rival.name)} at {rival.place}, "
            both += f"the error of the fit is {changed.rival_leaves:.2f} times as large"
        findings.append(Finding("note", "moment model", nominal.subject, both, ""))
    return tuple(findings)


def beside(walks: DeviceWalks, found: Discovery) -> dict[str, float]:
    """Return the root mean square error of the net moment on the held-out strides, model by model [N m].

    Nominal with the named effect is that of the discovery. Augmented adds a plain regression of what is left (angle,
    rate, their squares and product, each muscle's moment, harmonics of the stride); Exo is the moment model fitted to
    the device walk itself. Both learn from all strides of the device walk that are not held out.
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
    muscles = model.by_muscle(driven)  # percent stride, the last column, brings its harmonics
    library = np.column_stack((angle, rate, angle**2, rate**2, angle * rate, *muscles.T, 100 * phase))
    names = (*map(str, range(library.shape[1] - 1)), "phi")
    samples = Samples(library, (device.moment - nominal)[:, None], names, ("left",), device.time, library[:, -1])
    augmented = nominal + fit_ridge(samples.rows(learned), HARMONICS)(library)[:, 0]
    blocks = np.where(learned, device.stride * 4 // (int(device.stride.max()) + 1), -1)
    exo = fit_moment(driven, np.where(learned, device.moment, np.nan), blocks, model.form).net(driven)

    def error(predicted: Values) -> float:
        return float(np.sqrt(np.mean((device.moment - predicted)[known & held] ** 2)))

    _, after, _ = found.held_out.channels["net_moment"]
    return {
        "Nominal": error(nominal),
        "Nominal + named effect": after if found.effects else error(nominal),
        "Augmented (plain regression)": error(augmented),
        "Exo": error(exo),
    }


def over_people(found: Mapping[str, Discovery]) -> pd.DataFrame:
    """A row a number of each effect: in how many people it was named, mean, Student's 95 % interval (n > 1), who."""
    from scipy.stats import t

    numbers = [
        (effect.name, effect.place, number, each.unit, person, each.value)
        for person, answer in found.items()
        for effect in answer.effects
        for number, each in effect.estimates.items()
    ]
    rows: list[tuple[object, ...]] = []
    values = pd.DataFrame(numbers, columns=pd.Index((*NUMBER, "person", "value")))
    for key, own in values.groupby(list(NUMBER), sort=False):
        largest = own.sort_values("value", key=lambda value: -abs(value), kind="stable")
        who = ", ".join(largest["person"] + largest["value"].map(" {:.3g}".format))
        mean, half = own["value"].mean(), float(t.ppf(0.975, len(own) - 1) * own["value"].sem())
        rows.append((*key, len(own), len(found), mean, mean - half, mean + half, who))
    without = [person for person, answer in found.items() if not answer.effects]
    if without:
        rows.append((NOTHING, "", "", "", len(without), len(found), *[float("nan")] * 3, ", ".join(without)))
    table = pd.DataFrame(rows, columns=pd.Index(COLUMNS))
    return table.sort_values("people", ascending=False, kind="stable", ignore_index=True)


def over_conditions(found: Mapping[str, Mapping[str, Discovery]]) -> pd.DataFrame:
    """Rows of `over_people` for each condition (person -> condition -> answer), named in a first column if several."""
    tables = {
        word: over_people({person: answers[word] for person, answers in found.items() if word in answers})
        for word in dict.fromkeys(word for answers in found.values() for word in answers)
    }
    if not any(answer.conditions for answers in found.values() for answer in answers.values()):
        return next(iter(tables.values()), over_people({}))
    return pd.concat(tables, names=["condition"]).reset_index(0).reset_index(drop=True)


def lines(table: pd.DataFrame) -> list[str]:
    """Each row of `over_conditions` as a line of text."""
    said = []
    for row in table.to_dict("records"):
        what = f"{row['condition']}: " if "condition" in row else ""
        what += f"{row['effect']} at {row['place']}, {row['number']}" if row["place"] else row["effect"]
        mean = f", mean {row['mean']:.3g} {row['unit']}".rstrip() if row["place"] else ""
        if np.isfinite(row["low"]):
            mean += f" (95 % CI {row['low']:.3g} to {row['high']:.3g})"
        said.append(f"{what}: {row['people']} of {row['of']}{mean}: {row['who']}")
    return said
