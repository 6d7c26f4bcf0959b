"""Gait deviation index (Schwartz and Rozumalski 2008), with features of the laboratory's own controls."""

from __future__ import annotations

from collections.abc import Mapping, Sequence

import numpy as np
from numpy.typing import NDArray

from gaitdisc.results.clinical_reference import ReferenceLeg
from gaitdisc.results.clinical_variables import PROFILE
from gaitdisc.results.leg_curves import LegCurves

FEATURES = 15
FEWEST_PEOPLE = 30  # twice the features; below it directions are those of single people


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
