"""A person's cycles read beside a reference or another session: light, what stands out, profile, scores."""

from collections.abc import Mapping, Sequence
from functools import partial

import numpy as np
from numpy.typing import NDArray

from gaitdisc.clinic.clinical_reference import (
    FEW,
    ClinicalReading,
    ClinicalReference,
    Contrast,
    DifferingSpan,
    Profile,
    ReferenceLeg,
    Score,
)
from gaitdisc.clinic.like_controls import like_controls, like_published, mean_speed
from gaitdisc.clinic.reference import bands, spatiotemporal_limits
from gaitdisc.clinic.rules import outstanding
from gaitdisc.errors import ComparisonError
from gaitdisc.processing.leg_curves import BY_NAME, FEET, KINEMATICS, PELVIS, PROFILE, TURNED_DEG, LegCurves, make_legs
from gaitdisc.processing.pooled_cycles import PooledCycles
from gaitdisc.recording import Finding
from gaitdisc.report.curve_panels import Band
from gaitdisc.statistics.cluster_test import PermutationPlan, two_sample_test
from gaitdisc.words import SIDE_WORDS, label

NO_REFERENCE = "there is no reference; `gaitdisc reference` makes one from the laboratory's own controls"
NO_CYCLE = "no cycle is kept"
NO_LEGS = "limits are computed from single legs, which a published reference does not contain"
FEATURES = 15
FEWEST_PEOPLE = 30  # twice the features; below it directions are those of single people
FEWEST = 2  # people without whom the reference has no spread of its own
ALPHA = 0.05 / len(FEET)  # both legs are tested
MATTERS = {"deg": 5.0, "N m/kg": 0.1, "W/kg": 0.5}  # degrees: McGinley et al. 2009
FEWEST_CYCLES = 6  # of each of two that are compared: with fewer no result can be significant
PLAN = PermutationPlan(alpha=ALPHA)


def read_beside(pooled: PooledCycles, reference: ClinicalReference | None) -> ClinicalReading:
    """Read the cycles of one person, session and condition beside the controls who walked so."""
    legs = make_legs(pooled)
    light, reasons = choose_light(pooled, legs)
    consistency = {
        (name, side): multiple_correlation(curves) for side, leg in legs.items() for name, curves in leg.cycles.items()
    }
    reading = partial(ClinicalReading, pooled=pooled, legs=legs, light=light, reasons=reasons, consistency=consistency)
    if reference is not None and reference.published and legs:  # means and spreads alone: bands and scores, no limits
        group, words = like_published(reference.published, tuple(legs.values()), pooled.leg_m)
        profile, no_profile = find_profile(legs, (), group.bands)
        beside = (f"Published: {reference.title}.", words)
        published = partial(reading, silent=NO_LEGS, no_index=NO_LEGS)
        return published(profile=profile, no_profile=no_profile, bands=group.bands, beside=beside)
    controls = reference.of(pooled.condition) if reference else ()
    why = "" if controls else NO_REFERENCE
    if reference is not None and not controls:
        there = ", ".join(map(repr, reference.legs))
        why = f"the reference has no controls in the condition {pooled.condition!r}; its conditions are {there}"
    why = why if legs else NO_CYCLE
    person_legs = tuple(legs.values())
    like = like_controls(controls, person_legs, pooled.leg_m, pooled.age_years)
    profile, no_profile = (None, why) if why else find_profile(legs, like.group)
    numbers, silent = ((), why) if why else outstanding(legs, like.curves, None, like.values, profile)
    index, no_index = ({}, why) if why else deviation_index(legs, controls)
    return reading(
        numbers=numbers,
        silent=silent,
        profile=profile,
        no_profile=no_profile,
        deviation_index=index,
        no_index=no_index,
        bands=bands(like.curves, mean_speed(person_legs)),
        spatiotemporal=spatiotemporal_limits(like.values),
        beside=() if why else like.words,
        nearest=like.nearest,
    )


def multiple_correlation(curves: NDArray[np.float64]) -> float:
    """Adjusted coefficient of multiple correlation of cycles of one session; NaN where it is not defined.

    1 less the ratio of the variance about the mean curve to the variance about the grand mean, its root; not defined
    for one cycle, nor where cycles differ more from their mean curve than the curve does from its own mean.

    curves (cycle, phase): on even points
    Source: Kadaba MP, Ramakrishnan HK, Wootten ME et al. 1989, Repeatability of kinematic, kinetic, and
        electromyographic data.

    >>> round(multiple_correlation(np.array([[0.0, 2.0, 4.0], [1.0, 3.0, 5.0]])), 4)
    0.9258
    """
    cycles, points = curves.shape
    if cycles < 2:
        return float("nan")
    within = float(((curves - curves.mean(axis=0)) ** 2).sum()) / (points * (cycles - 1))
    total = float(((curves - curves.mean()) ** 2).sum()) / (points * cycles - 1)
    if total == 0.0 or within > total:
        return float("nan")
    return float(np.sqrt(1.0 - within / total))


def choose_light(pooled: PooledCycles, legs: dict[str, LegCurves]) -> tuple[str, tuple[str, ...]]:
    """Red where nothing is reported, amber where something can be done about it, each with what; else green."""
    if not legs:
        return "red", tuple(refusal.reason for refusal in pooled.refusals) or (NO_CYCLE,)
    reasons = []
    few = [f"{SIDE_WORDS[side]} leg {pooled.counted(side)}" for side in FEET if pooled.counted(side) < FEW]
    if few:
        gone = len({refusal.condition for refusal in pooled.refusals})
        words = f" ({gone} {'trial is' if gone == 1 else 'trials are'} left out)" if gone else ""
        reasons.append(f"few cycles: {', '.join(few)}{words}; record until each leg has {FEW} cycles")
    lost: dict[str, list[Finding]] = {}
    for finding in pooled.findings:
        if finding.severity == "refused" and finding.channel:
            lost.setdefault(finding.channel, []).append(finding)
    # lost in every trial: never plugged in, which is no fault
    partly = [name for name, findings in lost.items() if len({finding.file for finding in findings}) < pooled.trials]
    if loose := [name for name in partly if name.startswith("emg_")]:
        muscles = "; ".join(label(name).removeprefix("EMG ") for name in loose)
        reasons.append(f"EMG is missing in some trials ({muscles}): fasten the electrodes")
    others = [(name, findings[0]) for name, findings in lost.items() if not name.startswith("emg_")]
    reasons += [f"{label(name)} is left out: {_remedy(first)}" for name, first in others]
    kinds = {finding.kind: finding for finding in reversed(pooled.findings) if finding.severity == "warning"}
    reasons += [f"{kind}: {_remedy(finding)}" for kind, finding in reversed(kinds.items())]
    return ("amber" if reasons else "green"), tuple(reasons)


def _remedy(finding: Finding) -> str:
    """What to do: what a finding ends with, or where to look; of angles that are not there, why."""
    if finding.spoils.startswith("angles from "):
        return finding.what
    _, there, remedy = finding.spoils.rpartition("; ")
    where = f" of {label(finding.channel)}" if finding.channel else ""
    return remedy if there else f"look at the curves{where} before you use {finding.spoils or 'them'}"


def variable_score(curves: NDArray[np.float64], mean: NDArray[np.float64]) -> NDArray[np.float64]:
    """Root mean square difference of curves (..., phase) to the reference's mean.

    >>> float(variable_score(np.array([3.0, -3.0, 3.0]), np.zeros(3)))
    3.0
    """
    return np.sqrt(np.mean((curves - mean) ** 2, axis=-1))


def profile_score(scores: Sequence[float]) -> float:
    """Root mean square of variable scores.

    >>> round(profile_score([3.0, 4.0]), 3)
    3.536
    """
    return float(np.sqrt(np.mean(np.square(scores))))


def find_profile(
    legs: Mapping[str, LegCurves], reference: Sequence[ReferenceLeg], published: Mapping[str, Band] | None = None
) -> tuple[Profile | None, str]:
    """Profile of a person beside a reference, or why there is none.

    The score of a leg is over nine curves; the one of both is over fifteen: nine of the left leg, six of the right,
    those of the pelvis once, as in the paper.

    Source: Baker R, McGinley JL, Schwartz MH et al. 2009, The Gait Profile Score and Movement Analysis Profile.
    """
    turned = max((leg.turned_deg for leg in legs.values()), default=0.0)
    if turned > TURNED_DEG:
        return None, f"the pelvis turns by {turned:.0f} deg, but the angles of pelvis and foot assume a straight path"
    known = published or bands(reference)
    lacking = [name for name in PROFILE if name not in known]
    if lacking:
        return None, f"fewer than two people of the reference have curves of {', '.join(lacking).replace('_', ' ')}"
    absent = {side: [name for name in PROFILE if name not in leg.cycles] for side, leg in legs.items()}
    if all(absent.values()) or not legs:
        names = ", ".join(next(iter(absent.values()), PROFILE)).replace("_", " ")
        return None, f"the recording has no {names}; the score requires all nine curves"
    means = {name: known[name].mean for name in PROFILE}
    controls = _own_scores(reference)
    people = max(known[name].people for name in PROFILE)
    variables, leg_scores = {}, {}
    for side, leg in legs.items():
        if absent[side]:
            continue
        cycle_scores = {name: variable_score(leg.cycles[name], means[name]) for name in PROFILE}
        for name in PROFILE:
            value = float(variable_score(leg.mean(name), means[name]))
            variables[name, side] = _score(value, cycle_scores[name], controls.get(name, ()), people)
        whole_cycles = len({len(scores) for scores in cycle_scores.values()}) == 1  # else cycles would not be the same
        single = np.sqrt(np.mean(np.array([*cycle_scores.values()]) ** 2, axis=0)) if whole_cycles else np.array([])
        leg_scores[side] = _score(
            profile_score([variables[n, side].value for n in PROFILE]), single, controls.get("leg", ()), people
        )
    both = None
    if set(leg_scores) == set(FEET):
        fifteen = [variables[n, "l"].value for n in PROFILE]
        fifteen += [variables[n, "r"].value for n in PROFILE if n not in PELVIS]
        both = _score(profile_score(fifteen), np.array([]), controls.get("both", ()), people)
    return Profile(variables, leg_scores, both), ""


def _score(value: float, cycles: NDArray[np.float64], controls: Sequence[float], people: int) -> Score:
    low, high = (float(cycles.min()), float(cycles.max())) if len(cycles) else (float("nan"), float("nan"))
    known = len(controls) > 1
    mean, sd = (float(np.mean(controls)), float(np.std(controls, ddof=1))) if known else (float("nan"), float("nan"))
    return Score(value, low, high, len(cycles), reference_mean=mean, reference_sd=sd, people=people)


def _own_scores(reference: Sequence[ReferenceLeg]) -> dict[str, list[float]]:
    """Scores of controls, each against all the others."""
    scores: dict[str, list[float]] = {}
    complete = [leg for leg in reference if all(name in leg.curves for name in PROFILE)]
    people = list(dict.fromkeys(leg.person for leg in complete))
    if len(people) <= FEWEST:
        return {}
    for person in people:
        others = bands([leg for leg in complete if leg.person != person])
        variables: dict[tuple[str, str], float] = {}
        for leg in (leg for leg in complete if leg.person == person):
            for name in PROFILE:
                variables[name, leg.side] = float(variable_score(leg.curves[name], others[name].mean))
                scores.setdefault(name, []).append(variables[name, leg.side])
            scores.setdefault("leg", []).append(profile_score([variables[name, leg.side] for name in PROFILE]))
        if len(variables) == 2 * len(PROFILE):
            pelvis_once = [value for (name, side), value in variables.items() if side == "l" or name not in PELVIS]
            scores.setdefault("both", []).append(profile_score(pelvis_once))
    return scores


def deviation_index(legs: Mapping[str, LegCurves], reference: Sequence[ReferenceLeg]) -> tuple[dict[str, float], str]:
    """GDI of each leg, 100 as the controls' mean and 10 points a standard deviation; or why there is none.

    Nine curves at every second percent of the cycle; the first fifteen singular vectors of the controls' legs; the
    distance to the controls' mean in these, its natural logarithm scaled by that of the controls. Differs from the
    paper, whose features are of 6,702 legs of patients and controls: these are of the laboratory's own controls.

    Source: Schwartz MH, Rozumalski A 2008, The Gait Deviation Index: a new comprehensive index of gait pathology.
    """
    complete = [leg for leg in reference if all(name in leg.curves for name in PROFILE)]
    people = len({leg.person for leg in complete})
    if people < FEWEST_PEOPLE:
        return (
            {},
            f"its {FEATURES} features need {FEWEST_PEOPLE} controls with all nine curves; the reference has {people}",
        )

    def vector_of(curves: Mapping[str, NDArray[np.float64]]) -> NDArray[np.float64]:
        return np.concatenate([curves[name][::2] for name in PROFILE])

    controls = np.array([vector_of(leg.curves) for leg in complete])
    features = np.linalg.svd(controls, full_matrices=False)[2][:FEATURES]
    middle = (controls @ features.T).mean(axis=0)
    distances = np.log(np.linalg.norm(controls @ features.T - middle, axis=1))
    index = {}
    for side, leg in legs.items():
        if all(name in leg.cycles for name in PROFILE):
            vector = vector_of({name: leg.mean(name) for name in PROFILE})
            raw = np.log(np.linalg.norm(vector @ features.T - middle))
            index[side] = float(100 - 10 * (raw - distances.mean()) / distances.std(ddof=1))
    return index, "" if index else "no leg has all nine curves that the index requires"


def contrast(first: ClinicalReading, second: ClinicalReading) -> Contrast:
    """Compare the cycles of two readings leg by leg; second minus first."""
    spans: list[DifferingSpan] = []
    untested: dict[str, str] = {}
    tested: dict[str, int] = {}
    for side in FEET:
        if side not in first.legs or side not in second.legs:
            untested[side] = "one of the two walks has no cycle of this leg."
            continue
        counts = [reading.legs[side].count for reading in (first, second)]
        if min(counts) < FEWEST_CYCLES:
            untested[side] = f"a test needs {FEWEST_CYCLES} cycles of each walk; there are {counts[0]} and {counts[1]}."
            continue
        try:
            leg_spans, tested[side] = _spans(first.legs[side], second.legs[side])
            spans += leg_spans
        except ComparisonError as error:
            untested[side] = str(error)
    return Contrast(first, second, tuple(spans), untested, tested)


def _spans(first: LegCurves, second: LegCurves) -> tuple[list[DifferingSpan], int]:
    names = [
        name
        for name in first.cycles
        if name in second.cycles
        and BY_NAME[name].kind == KINEMATICS
        and len(first.cycles[name]) == first.count
        and len(second.cycles[name]) == second.count
    ]
    if not names:
        raise ComparisonError(
            "an angle must be known in every cycle of both walks", "found none", "Record the same angles in both walks."
        )
    before, after = (np.stack([leg.cycles[name] for name in names], axis=2) for leg in (first, second))
    tested = two_sample_test(before, after, PLAN)
    difference = after.mean(axis=0) - before.mean(axis=0)
    spans = []
    for cluster in tested.clusters:
        cluster_difference = difference[cluster.first : cluster.last + 1, cluster.channel]
        largest = float(cluster_difference[np.argmax(np.abs(cluster_difference))])
        name = names[cluster.channel]
        matters = abs(largest) >= MATTERS[BY_NAME[name].unit]
        spans.append(DifferingSpan(name, first.side, cluster.first, cluster.last, largest, cluster.p, matters=matters))
    return spans, len(names)
