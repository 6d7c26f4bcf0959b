"""Movement analysis profile and gait profile score (Baker et al. 2009), and the gait deviation index.

The index (Schwartz and Rozumalski 2008) has features of the laboratory's own controls.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence

import numpy as np
from numpy.typing import NDArray

from gaitdisc.clinic.reference import bands
from gaitdisc.results.clinical_reading import Band, Profile, Score
from gaitdisc.results.clinical_reference import ReferenceLeg
from gaitdisc.results.clinical_variables import PELVIS, PROFILE
from gaitdisc.results.leg_curves import FEET, TURNED_DEG, LegCurves

FEATURES = 15
FEWEST_PEOPLE = 30  # twice the features; below it directions are those of single people
FEWEST = 2  # people without whom the reference has no spread of its own


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


def profile_of(
    legs: Mapping[str, LegCurves], reference: Sequence[ReferenceLeg], published: Mapping[str, Band] | None = None
) -> tuple[Profile | None, str]:
    """Profile of a person beside a reference, or why there is none.

    The score of a leg is over nine curves; the one of both is over fifteen: nine of the left leg, six of the right,
    those of the pelvis once, as in the paper.

    Source: Baker R, McGinley JL, Schwartz MH et al. 2009, The Gait Profile Score and Movement Analysis Profile.
    """
    turned = max((leg.turned_deg for leg in legs.values()), default=0.0)
    if turned > TURNED_DEG:
        return None, (
            f"the pelvis turns by {turned:.0f} deg in a cycle: its rotation and the foot's progression, two of the "
            f"nine curves, are about a straight line of walking"
        )
    known = published or bands(reference)
    lacking = [name for name in PROFILE if name not in known]
    if lacking:
        return None, f"the reference lacks {', '.join(lacking).replace('_', ' ')} of two people or more"
    absent = {side: [name for name in PROFILE if name not in leg.cycles] for side, leg in legs.items()}
    if all(absent.values()) or not legs:
        names = ", ".join(next(iter(absent.values()), PROFILE)).replace("_", " ")
        return None, f"the recording lacks {names}; the score is over nine curves"
    means = {name: known[name].mean for name in PROFILE}
    spread = _own_spread(reference)
    people = max(known[name].people for name in PROFILE)
    variables, whole = {}, {}
    for side, leg in legs.items():
        if absent[side]:
            continue
        each = {name: variable_score(leg.cycles[name], means[name]) for name in PROFILE}
        for name in PROFILE:
            value = float(variable_score(leg.mean(name), means[name]))
            variables[name, side] = _score(value, each[name], spread.get(name), people)
        whole_cycles = len({len(scores) for scores in each.values()}) == 1  # else cycles would not be the same
        single = np.sqrt(np.mean(np.array([*each.values()]) ** 2, axis=0)) if whole_cycles else np.array([])
        whole[side] = _score(
            profile_score([variables[n, side].value for n in PROFILE]), single, spread.get("leg"), people
        )
    both = None
    if set(whole) == set(FEET):
        fifteen = [variables[n, "l"].value for n in PROFILE]
        fifteen += [variables[n, "r"].value for n in PROFILE if n not in PELVIS]
        both = _score(profile_score(fifteen), np.array([]), spread.get("both"), people)
    return Profile(variables, whole, both), ""


def _score(value: float, cycles: NDArray[np.float64], spread: tuple[float, float] | None, people: int) -> Score:
    low, high = (float(cycles.min()), float(cycles.max())) if len(cycles) else (float("nan"), float("nan"))
    return Score(value, low, high, len(cycles), *(spread or (float("nan"), float("nan"))), people)


def _own_spread(reference: Sequence[ReferenceLeg]) -> dict[str, tuple[float, float]]:
    """Mean and standard deviation of the scores of controls, each against all the others."""
    found: dict[str, list[float]] = {}
    whole = [leg for leg in reference if all(name in leg.curves for name in PROFILE)]
    people = list(dict.fromkeys(leg.person for leg in whole))
    if len(people) <= FEWEST:
        return {}
    for person in people:
        others = bands([leg for leg in whole if leg.person != person])
        own: dict[tuple[str, str], float] = {}
        for leg in (one for one in whole if one.person == person):
            for name in PROFILE:
                own[name, leg.side] = float(variable_score(leg.curves[name], others[name].mean))
                found.setdefault(name, []).append(own[name, leg.side])
            found.setdefault("leg", []).append(profile_score([own[name, leg.side] for name in PROFILE]))
        if len(own) == 2 * len(PROFILE):
            pelvis_once = [value for (name, side), value in own.items() if side == "l" or name not in PELVIS]
            found.setdefault("both", []).append(profile_score(pelvis_once))
    return {name: (float(np.mean(each)), float(np.std(each, ddof=1))) for name, each in found.items() if len(each) > 1}


def deviation_index(legs: Mapping[str, LegCurves], reference: Sequence[ReferenceLeg]) -> tuple[dict[str, float], str]:
    """GDI of each leg, 100 as the controls' mean and 10 points a standard deviation; or why there is none.

    Nine curves at every second percent of the cycle; the first fifteen singular vectors of the controls' legs; the
    distance to the controls' mean in these, its natural logarithm scaled by that of the controls. Differs from the
    paper, whose features are of 6,702 legs of patients and controls: these are of the laboratory's own controls.

    Source: Schwartz MH, Rozumalski A 2008, The Gait Deviation Index: a new comprehensive index of gait pathology.
    """
    whole = [leg for leg in reference if all(name in leg.curves for name in PROFILE)]
    people = len({leg.person for leg in whole})
    if people < FEWEST_PEOPLE:
        return (
            {},
            f"its {FEATURES} features need {FEWEST_PEOPLE} controls with all nine curves; the reference has {people}",
        )
    controls = np.array([_gait_vector(leg.curves) for leg in whole])
    features = np.linalg.svd(controls, full_matrices=False)[2][:FEATURES]
    middle = (controls @ features.T).mean(axis=0)
    own = np.log(np.linalg.norm(controls @ features.T - middle, axis=1))
    found = {}
    for side, leg in legs.items():
        if all(name in leg.cycles for name in PROFILE):
            vector = _gait_vector({name: leg.mean(name) for name in PROFILE})
            raw = np.log(np.linalg.norm(vector @ features.T - middle))
            found[side] = float(100 - 10 * (raw - own.mean()) / own.std(ddof=1))
    return found, "" if found else "the recording lacks one of its nine curves"


def _gait_vector(curves: Mapping[str, NDArray[np.float64]]) -> NDArray[np.float64]:
    return np.concatenate([curves[name][::2] for name in PROFILE])
