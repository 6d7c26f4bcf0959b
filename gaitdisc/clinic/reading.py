"""A person's cycles read beside a reference: light, what stands out, scores, consistency."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from gaitdisc.clinic.like_controls import like_controls, like_published
from gaitdisc.clinic.profile import deviation_index, profile_of
from gaitdisc.clinic.reference import bands, spatiotemporal_limits
from gaitdisc.clinic.rules import outstanding
from gaitdisc.results.clinical_reading import ClinicalReading
from gaitdisc.results.clinical_reference import ClinicalReference
from gaitdisc.results.leg_curves import FEET, LegCurves, legs_of
from gaitdisc.results.pooled_cycles import PooledCycles

FEW = 3  # cycles of a leg below which a mean is that of single steps
NO_REFERENCE = "there is no reference: gaitdisc reference makes one of the laboratory's own controls"
NO_CYCLE = "no cycle is kept"
NO_LEGS = "a published reference has means and spreads, no single legs to take limits from"
SIDES = {"l": "left", "r": "right"}


def read_beside(pooled: PooledCycles, reference: ClinicalReference | None) -> ClinicalReading:
    """Read the cycles of one person, session and condition beside the controls who walked so."""
    legs = legs_of(pooled)
    if reference is not None and reference.published and legs:
        return _beside_published(pooled, legs, reference)
    controls = reference.of(pooled.condition) if reference else ()
    why = "" if controls else NO_REFERENCE
    if reference is not None and not controls:
        there = ", ".join(map(repr, reference.legs))
        why = f"nobody of the reference walked {pooled.condition!r}; it has {there}"
    why = why if legs else NO_CYCLE
    like = like_controls(controls, tuple(legs.values()), pooled.leg_m, pooled.age_years)
    numbers, silent = ((), why) if why else outstanding(legs, like.curves, of_values=like.values)
    profile, no_profile = (None, why) if why else profile_of(legs, like.curves)
    index, no_index = ({}, why) if why else deviation_index(legs, controls)
    light, reasons = light_of(pooled, legs)
    return ClinicalReading(
        pooled,
        legs,
        light,
        reasons,
        numbers,
        silent,
        profile,
        no_profile,
        index,
        no_index,
        consistency_of(legs),
        bands(like.curves),
        spatiotemporal_limits(like.values),
        () if why else like.words,
    )


def _beside_published(
    pooled: PooledCycles, legs: dict[str, LegCurves], reference: ClinicalReference
) -> ClinicalReading:
    """Reading beside means and spreads alone: bands and scores, no limits."""
    group, words = like_published(reference.published, tuple(legs.values()), pooled.leg_m)
    profile, no_profile = profile_of(legs, (), group.bands)
    known, lights = (profile, no_profile, {}, NO_LEGS), light_of(pooled, legs)
    shown = (consistency_of(legs), group.bands, {}, (f"Published: {reference.title}.", words))
    return ClinicalReading(pooled, legs, *lights, (), NO_LEGS, *known, *shown)


def consistency_of(legs: dict[str, LegCurves]) -> dict[tuple[str, str], float]:
    """Coefficient of multiple correlation of every variable and leg."""
    return {
        (name, side): multiple_correlation(curves) for side, leg in legs.items() for name, curves in leg.cycles.items()
    }


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
    whole = float(((curves - curves.mean()) ** 2).sum()) / (points * cycles - 1)
    if whole == 0.0 or within > whole:
        return float("nan")
    return float(np.sqrt(1.0 - within / whole))


def light_of(pooled: PooledCycles, legs: dict[str, LegCurves]) -> tuple[str, tuple[str, ...]]:
    """Red where nothing is reported, amber where it rests on little or something is spoiled, else green."""
    if not legs:
        return "red", tuple(refusal.reason for refusal in pooled.refusals) or (NO_CYCLE,)
    reasons = []
    few = [f"{pooled.counted(side)} {SIDES[side]}" for side in FEET if pooled.counted(side) < FEW]
    if few:
        reasons.append(f"few cycles: {', '.join(few)}")
    if pooled.refusals:
        reasons.append(f"trials left out: {len({refusal.condition for refusal in pooled.refusals})}")
    lost = list(dict.fromkeys(one.channel for one in pooled.findings if one.severity == "refused" and one.channel))
    muscles = [name for name in lost if name.startswith("emg_")]
    others = [name for name in lost if name not in muscles]
    if muscles:
        reasons.append(f"EMG left out: {len(muscles)} channels" if len(muscles) > 1 else "EMG left out: 1 channel")
    if others:
        reasons.append(f"channels left out: {', '.join(others)}")
    kinds = list(dict.fromkeys(one.kind for one in pooled.findings if one.severity == "warning"))
    if kinds:
        reasons.append(f"warnings: {', '.join(kinds)}")
    return ("amber" if reasons else "green"), tuple(reasons)
