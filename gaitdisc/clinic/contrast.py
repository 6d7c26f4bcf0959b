"""Two sessions or conditions of one person: where over the cycle each leg's curves differ, and whether that matters."""

from __future__ import annotations

from collections.abc import Mapping

import numpy as np

from gaitdisc.errors import ComparisonError
from gaitdisc.results.clinical_reading import ClinicalReading, Contrast, DifferingSpan
from gaitdisc.results.clinical_variables import BY_NAME, KINEMATICS
from gaitdisc.results.leg_curves import FEET, LegCurves
from gaitdisc.statistics.cluster_test import PermutationPlan, two_sample_test

ALPHA = 0.05 / len(FEET)  # both legs are tested
MATTERS = {"deg": 5.0, "N m/kg": 0.1, "W/kg": 0.5}  # degrees: McGinley et al. 2009
PLAN = PermutationPlan(alpha=ALPHA)


def contrast_of(first: ClinicalReading, second: ClinicalReading) -> Contrast:
    """Compare the cycles of two readings leg by leg; second minus first."""
    spans: list[DifferingSpan] = []
    untested: dict[str, str] = {}
    tested: dict[str, int] = {}
    for side in FEET:
        if side not in first.legs or side not in second.legs:
            untested[side] = "one of the two has no cycle of this leg"
            continue
        try:
            found, tested[side] = _spans(first.legs[side], second.legs[side])
            spans += found
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
            "a test needs an angle that all cycles of both have", "found none", "Record the same angles in both."
        )
    sets: Mapping[str, np.ndarray] = {
        word: np.stack([leg.cycles[name] for name in names], axis=2) for word, leg in (("a", first), ("b", second))
    }
    tested = two_sample_test(sets["a"], sets["b"], PLAN)
    apart = sets["b"].mean(axis=0) - sets["a"].mean(axis=0)
    found = []
    for cluster in tested.clusters:
        own = apart[cluster.first : cluster.last + 1, cluster.channel]
        largest = float(own[np.argmax(np.abs(own))])
        name = names[cluster.channel]
        matters = abs(largest) >= MATTERS[BY_NAME[name].unit]
        found.append(DifferingSpan(name, first.side, cluster.first, cluster.last, largest, cluster.p, matters))
    return found, len(names)
