"""A reference of controls: mean cycles of their legs, and bands and limits over them."""

from __future__ import annotations

from collections.abc import Mapping, Sequence

import numpy as np
from numpy.typing import NDArray
from scipy.stats import t as student

from gaitdisc.errors import SchemaError
from gaitdisc.recording.arrays import mean_where_known
from gaitdisc.results.clinical_reference import Band, ClinicalReference, Limits, ReferenceLeg
from gaitdisc.results.leg_curves import legs_of
from gaitdisc.results.pooled_cycles import PooledCycles
from gaitdisc.results.provenance import Provenance

FEWEST = 5  # people below whom no limit is drawn
ALPHA = 0.05  # chance that a healthy person's page says anything
SETTINGS = ("filters", "kinematics", "strides")


def reference_of(cycles: Sequence[PooledCycles], title: str, provenance: Provenance) -> ClinicalReference:
    """Reference of everybody in a run, by condition; of several sessions of a person the first counts."""
    numbers: dict[str, int] = {}
    seen: set[tuple[str, str]] = set()
    legs: dict[str, list[ReferenceLeg]] = {}
    for pooled in cycles:
        found = legs_of(pooled)
        if not found or (pooled.subject, pooled.condition) in seen:
            continue
        seen.add((pooled.subject, pooled.condition))
        number = numbers.setdefault(pooled.subject, len(numbers) + 1)
        for leg in found.values():
            curves = {name: leg.mean(name) for name in leg.cycles}
            values = {name: float(each.mean()) for name, each in leg.values.items()}
            own = (leg.count, leg.stance_percent, curves, values, pooled.leg_m, pooled.age_years)
            legs.setdefault(pooled.condition, []).append(ReferenceLeg(number, leg.side, *own))
    if not legs:
        raise SchemaError(
            "a reference needs kept cycles of controls",
            f"found none in {len(cycles)} sessions and conditions",
            "Look at “Left out” on the page of the run.",
        )
    kept = {word: tuple(own) for word, own in legs.items()}
    settings = {name: provenance.settings[name] for name in SETTINGS if name in provenance.settings}
    return ClinicalReference(title, kept, settings, provenance.versions, provenance.created)


def bands(legs: Sequence[ReferenceLeg]) -> dict[str, Band]:
    """Mean and standard deviation over legs of every variable that two people or more have."""
    found = {}
    for name in dict.fromkeys(name for leg in legs for name in leg.curves):
        own = [leg for leg in legs if name in leg.curves]
        people = len({leg.person for leg in own})
        if people >= 2:
            each = np.array([leg.curves[name] for leg in own])
            mean, counts = mean_where_known(each), np.isfinite(each).sum(axis=0)
            spread = np.sqrt(mean_where_known((each - mean) ** 2) * counts / np.maximum(counts - 1, 1))
            found[name] = Band(mean, np.where(counts > 1, spread, np.nan), people)
    return found


def limits_of(values: NDArray[np.float64], people: int, tests: int = 1) -> Limits:
    """Limits within which one more healthy leg lies, all of so many tests together, with probability 1 - ALPHA.

    Prediction limits of a normal distribution whose mean and spread are themselves estimated; legs of one person are
    alike, so that people count as degrees of freedom. Bonferroni's correction for the tests.

    >>> limits_of(np.array([58.0, 60.0, 62.0, 60.0]), 4).mean
    60.0
    """
    mean, sd = float(values.mean()), float(values.std(ddof=1)) if len(values) > 1 else float("nan")
    if people < FEWEST:
        return Limits(float("-inf"), float("inf"), mean, sd, people)
    reach = float(student.ppf(1 - ALPHA / (2 * tests), people - 1)) * sd * np.sqrt(1 + 1 / people)
    return Limits(mean - reach, mean + reach, mean, sd, people)


def spatiotemporal_limits(legs: Sequence[ReferenceLeg]) -> Mapping[str, Limits]:
    """Mean and spread of each spatiotemporal value over the legs of a reference."""
    found = {}
    for name in dict.fromkeys(name for leg in legs for name in leg.values):
        own = [leg for leg in legs if name in leg.values]
        found[name] = limits_of(np.array([leg.values[name] for leg in own]), len({leg.person for leg in own}))
    return found
