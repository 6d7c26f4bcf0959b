"""A person's cycles read beside a reference: light, what stands out, scores, consistency."""

from __future__ import annotations

from collections.abc import Sequence

from gaitdisc.clinic.consistency import multiple_correlation
from gaitdisc.clinic.deviation_index import deviation_index
from gaitdisc.clinic.like_controls import like_controls, like_published
from gaitdisc.clinic.outstanding import outstanding
from gaitdisc.clinic.profile import profile_of
from gaitdisc.clinic.reference import bands, spatiotemporal_limits
from gaitdisc.results import PooledCycles, Refusal
from gaitdisc.results.clinical_reading import ClinicalReading
from gaitdisc.results.clinical_reference import ClinicalReference
from gaitdisc.results.leg_curves import FEET, LegCurves, legs_of

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
    why = "" if controls else NO_REFERENCE if reference is None else _not_so(reference, pooled.condition)
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


def light_of(pooled: PooledCycles, legs: dict[str, LegCurves]) -> tuple[str, tuple[str, ...]]:
    """Red where nothing is reported, amber where it rests on little or something is spoiled, else green."""
    if not legs:
        return "red", tuple(refusal.reason for refusal in pooled.refusals) or (NO_CYCLE,)
    reasons = []
    few = [f"{pooled.counted(side)} {SIDES[side]}" for side in FEET if pooled.counted(side) < FEW]
    if few:
        reasons.append(f"few cycles: {', '.join(few)}")
    if pooled.refusals:
        reasons.append(f"trials left out: {len(_trials(pooled.refusals))}")
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


def _trials(refusals: Sequence[Refusal]) -> list[str]:
    return list(dict.fromkeys(refusal.condition for refusal in refusals))


def _not_so(reference: ClinicalReference, condition: str) -> str:
    return f"nobody of the reference walked {condition!r}; it has {', '.join(map(repr, reference.legs))}"
