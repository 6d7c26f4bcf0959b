"""What a device does, from a laboratory's own files: a study, to the answer in each condition and over people."""

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
        prefix = f"{word}: " if word and len(words) > 1 else ""
        labelled = replace(request, progress=lambda step, prefix=prefix: request.progress(f"{prefix}{step}"))
        labelled.progress(f"comparing both walks of {participant} with the Nominal model")
        try:
            answers[word] = _discover_condition(walks, word, labelled, joint)
        except GaitdiscError as error:
            errors[word] = error
    if not answers:
        raise errors[words[0]]
    if len(words) == 1:
        return answers
    seen = {word: answer.public for word, (answer, _) in answers.items()}
    rows = [
        ConditionAnswer(word, str(errors[word])) if word in errors
        else ConditionAnswer(word, seen[word].sentence, seen[word].verdict, seen[word].effects, seen[word].beside)
        for word in words
    ]  # fmt: skip
    return {word: (replace(answer, conditions=tuple(rows)), model) for word, (answer, model) in answers.items()}


def _discover_condition(
    walks: PersonWalks, condition: str, request: Request, joint: str
) -> tuple[Discovery, Simulation]:
    """Find what the Nominal moment model lacks in another walk of a participant.

    Where a walk lacks EMG or moments, only the motion of both is compared, and the sentence says so.
    """
    study, person, progress = walks.study, walks.participant, request.progress
    called = list_words(study, person).files
    others = {*study.conditions.words} - {study.conditions.nominal, condition}
    recorded = [file for trial in person.trials if trial.condition not in others for file in trial.files]
    files = {study.path_of(file): called[Path(file).name] for file in recorded}
    try:
        pair = walks.calibrated(condition, joint)
    except NoMomentsError as lacking:
        progress("comparing only the motion of both walks")
        motion = nominal_and_trials(against(study, condition), person.id, joint)
        request = replace(request, possible=lambda effect: effect.kind != "observation")  # both have the same sensors
        answer, augmented = find_missing(*motion, request, files)
        why = f"{lacking.needed[:1].upper()}{lacking.needed[1:]}, but {lacking.found}"
        how = "only the motion of both walks was compared, which gives no moment of the device"
        return replace(answer, sentence=f"{why}: {how}. {answer.sentence}"), augmented
    muscles = pair.changed.model if pair.changed else pair.model
    model = joint_model(pair.device, muscles)
    data = cut_walk_trials(pair.device, muscles, model)
    if study.conditions.others:
        model = replace(model, title=f"{model.title}, {condition}")
    answer, augmented = find_missing(model, data, replace(request, possible=pair.weighed), files)
    answer, augmented = with_model_error(answer, pair), model if pair.agrees else augmented
    errors = beside(pair, answer)
    if joint == "ankle_angle" and not answer.effects:
        progress("estimating a mass added to the foot from the moments of the knee and hip")
        answer = with_foot_mass(answer, walks, condition)
    if answer.provenance is not None:
        answer = replace(answer, provenance=replace(answer.provenance, section=DEVICE))
    return replace(answer, findings=(*device_findings(pair), *answer.findings), beside=errors), augmented


def with_model_error(answer: Discovery, walks: DeviceWalks) -> Discovery:
    """Return what was found with the number of both walks, whose interval holds the error of the moment model."""
    if walks.agrees:
        agreement = "The Nominal moment model predicts the device walk as well as held-out Nominal strides: "
        return replace(answer, verdict="no_gap", effects=(), sentence=f"{agreement}no effect is missing.")
    if walks.changed is not None:
        answer = _with_number(answer, walks.changed)
    if not answer.effects or walks.nominal.joint != "hip_flexion":
        return answer
    electrodes = {name.split("_")[1] for name in walks.nominal.muscles}
    unseen = " and ".join(muscle for muscle, channels in DEEP.items() if not electrodes & set(channels))
    doubt = f" The size of the effect is unreliable: no electrode records the {unseen} of the hip." if unseen else ""
    return replace(answer, sentence=answer.sentence + doubt)


def _with_number(answer: Discovery, changed: Changed) -> Discovery:
    """Return what was found with the number of the change, if the search names it too."""
    change = changed.change
    effect = next((named for named in answer.effects if (named.name, named.place) == (change.name, change.place)), None)
    if effect is None or change.number not in effect.estimates:
        return answer
    old = effect.estimates[change.number]
    half = float(np.hypot((old.high - old.low) / 2, NORMAL_95 * changed.spread))
    new = Estimate(changed.value, changed.value - half, changed.value + half, old.unit)
    mended = replace(effect, estimates={**effect.estimates, change.number: new})
    text = answer.sentence.replace(estimate_text(old), estimate_text(new))
    if abs(old.value - new.value) > APART * abs(new.value):
        number = f"{old.value:.3g} {old.unit}".removesuffix(" 1")
        text += f" In augmented.toml, this number is {number}, fitted together with the other parameters."
    return replace(answer, effects=tuple(mended if item is effect else item for item in answer.effects), sentence=text)


def with_foot_mass(answer: Discovery, walks: PersonWalks, condition: str) -> Discovery:
    """Return what was found at the ankle where nothing is missing there, with a mass that knee and hip show."""
    try:
        mass = weigh_foot({joint: walks.at(condition, joint) for joint in FOOT_SHOWS_AT})
    except ChannelError:  # files that know the ankle alone
        return answer
    if mass is None:
        return answer
    sentence = (
        f"The mass added to the foot is {estimate_text(mass)}, estimated from the knee moment and supported by the hip "
        "moment; the ankle moment is insensitive to it."
    )
    effect = FoundEffect("parameter", "added_foot_mass", "wrong_parameter", "", {"value": mass})
    return replace(answer, verdict="wrong_parameter", effects=(effect,), sentence=sentence)


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


def beside(walks: DeviceWalks, answer: Discovery) -> dict[str, float]:
    """Return the root mean square error of the net moment on the held-out strides, model by model [N m].

    Nominal with the named effect is that of the discovery. Augmented adds a plain regression of what is left (angle,
    rate, their squares and product, each muscle's moment, harmonics of the stride); Exo is the moment model fitted to
    the device walk itself. Both learn from all strides of the device walk that are not held out.
    """
    device, model = walks.device, walks.model
    at = answer.runs.time[np.isfinite(answer.runs.time)]
    held = np.isin(device.stride, np.unique(device.stride[np.isin(np.round(device.time, 4), np.round(at, 4))]))
    held &= device.stride >= 0
    known = np.isfinite(device.moment) & np.isfinite(device.phase) & np.isfinite(device.rate)
    learned = known & ~held
    driven = drives(device)
    nominal = model.net(driven)
    angle, rate, phase = (np.nan_to_num(signal) for signal in (device.angle, device.rate, device.phase))
    muscles = model.by_muscle(driven)  # percent stride, the last column, brings its harmonics
    library = np.column_stack((angle, rate, angle**2, rate**2, angle * rate, *muscles.T, 100 * phase))
    names = (*map(str, range(library.shape[1] - 1)), "phi")
    samples = Samples(library, (device.moment - nominal)[:, None], names, ("left",), device.time, library[:, -1])
    augmented = nominal + fit_ridge(samples.rows(learned), HARMONICS)(library)[:, 0]
    blocks = np.where(learned, device.stride * 4 // (int(device.stride.max()) + 1), -1)
    exo = fit_moment(driven, np.where(learned, device.moment, np.nan), blocks, model.form).net(driven)

    def error(predicted: Values) -> float:
        return float(np.sqrt(np.mean((device.moment - predicted)[known & held] ** 2)))

    _, after, _ = answer.held_out.channels["net_moment"]
    return {
        "Nominal": error(nominal),
        "Nominal + named effect": after if answer.effects else error(nominal),
        "Augmented (plain regression)": error(augmented),
        "Exo": error(exo),
    }


def over_people(answers: Mapping[str, Discovery]) -> pd.DataFrame:
    """A row a number of each effect: in how many people it was named, mean, Student's 95 % interval (n > 1), who."""
    from scipy.stats import t

    numbers = [
        (effect.name, effect.place, number, estimate.unit, person, estimate.value)
        for person, answer in answers.items()
        for effect in answer.effects
        for number, estimate in effect.estimates.items()
    ]
    rows: list[tuple[object, ...]] = []
    values = pd.DataFrame(numbers, columns=pd.Index((*NUMBER, "person", "value")))
    for key, group in values.groupby(list(NUMBER), sort=False):
        largest = group.sort_values("value", key=lambda value: -abs(value), kind="stable")
        who = ", ".join(largest["person"] + largest["value"].map(" {:.3g}".format))
        mean, half = group["value"].mean(), float(t.ppf(0.975, len(group) - 1) * group["value"].sem())
        rows.append((*key, len(group), len(answers), mean, mean - half, mean + half, who))
    without = [person for person, answer in answers.items() if not answer.effects]
    if without:
        rows.append((NOTHING, "", "", "", len(without), len(answers), *[float("nan")] * 3, ", ".join(without)))
    table = pd.DataFrame(rows, columns=pd.Index(COLUMNS))
    return table.sort_values("people", ascending=False, kind="stable", ignore_index=True)


def over_conditions(by_person: Mapping[str, Mapping[str, Discovery]]) -> pd.DataFrame:
    """Rows of `over_people` for each condition (person -> condition -> answer), named in a first column if several."""
    tables = {
        word: over_people({person: answers[word] for person, answers in by_person.items() if word in answers})
        for word in dict.fromkeys(word for answers in by_person.values() for word in answers)
    }
    if not any(answer.conditions for answers in by_person.values() for answer in answers.values()):
        return next(iter(tables.values()), over_people({}))
    return pd.concat(tables, names=["condition"]).reset_index(0).reset_index(drop=True)


def lines(table: pd.DataFrame) -> list[str]:
    """Each row of `over_conditions` as a line of text."""
    texts = []
    for row in table.to_dict("records"):
        label = f"{row['condition']}: " if "condition" in row else ""
        label += f"{row['effect']} at {row['place']}, {row['number']}" if row["place"] else row["effect"]
        mean = f", mean {row['mean']:.3g} {row['unit']}".rstrip() if row["place"] else ""
        if np.isfinite(row["low"]):
            mean += f" (95 % CI {row['low']:.3g} to {row['high']:.3g})"
        texts.append(f"{label}: {row['people']} of {row['of']}{mean}: {row['who']}")
    return texts
